//! Reload between frames: files that changed are read again; if they cannot be loaded, the last good plan stays.

use crate::{Compiled, LoadReport, RenderError, Renderer, SharedScene, load_scene};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// The result of a reload.
#[derive(Debug)]
pub enum Reload {
    /// None of the files belongs to the pipeline or the scene.
    Nothing,
    /// The new plan is loaded; the report says what was created again.
    Done(LoadReport),
    /// The new files are wrong: the last good plan stays.
    Failed(RenderError),
}

/// A scene that was loaded again, for all renderers of it.
type Fresh = Option<SharedScene>;

/// Loads files again that have changed, as [`Renderer::reload`] does, in several renderers: a scene that they share is
/// loaded once, and shared again.
pub fn reload_all<'r>(
    renderers: impl IntoIterator<Item = &'r mut Renderer>,
    changed: &BTreeSet<PathBuf>,
) -> Vec<Reload> {
    let mut fresh = None;
    renderers.into_iter().map(|renderer| renderer.reload_with(changed, &mut fresh)).collect()
}

impl Renderer {
    /// Loads files again that have changed, as [`shader_library::Watcher`] reports them; call it between frames.
    pub fn reload(&mut self, changed: &BTreeSet<PathBuf>) -> Reload {
        self.reload_with(changed, &mut None)
    }

    fn reload_with(&mut self, changed: &BTreeSet<PathBuf>, fresh: &mut Fresh) -> Reload {
        let paths: BTreeSet<String> = changed.iter().filter_map(|path| self.asset_path(path)).collect();
        let places: BTreeSet<PathBuf> = changed.iter().map(|path| place(path)).collect();
        let scene_touched = self.scene().files.iter().any(|file| places.contains(&place(file)));
        // Files that a broken scene lacks, or names now, lie beside its other files.
        let folders: BTreeSet<PathBuf> =
            self.scene().files.iter().filter_map(|file| place(file).parent().map(Path::to_owned)).collect();
        let beside = |file: &PathBuf| folders.iter().any(|folder| file.starts_with(folder));
        let scene_touched = scene_touched || (self.scene_stale && places.iter().any(beside));
        self.scene_stale |= scene_touched;
        let Some(loaded) = &self.pipeline else { return Reload::Nothing };
        let stale = self.catalog.shaders().invalidate(&paths.iter().map(String::as_str).collect::<Vec<_>>());
        // A file outside the tree may be named from the working folder, and reported with its whole path.
        let touched = |name: &str| paths.contains(name) || places.contains(&place(&self.on_disk(name)));
        // Another renderer of the same catalog may have notified the library first.
        let shader_touched =
            !stale.is_empty() || loaded.compiled.shader_files().iter().any(|file| touched(file));
        let pipeline_touched = loaded.compiled.resolved.sources().iter().any(|source| touched(&source.name))
            || paths.iter().any(|path| path.ends_with(".ron") && path.starts_with("pipelines/"));
        if !shader_touched && !pipeline_touched && !scene_touched {
            return Reload::Nothing;
        }
        let (name, overrides) = (loaded.name.clone(), loaded.overrides.clone());
        let reloaded =
            if self.scene_stale { self.reload_scene(fresh) } else { self.set_pipeline(&name, &overrides) };
        match reloaded {
            Ok(report) => Reload::Done(report),
            Err(error) => Reload::Failed(error),
        }
    }

    /// Loads the scene again by what it was loaded by, or takes it where another renderer has.
    fn reload_scene(&mut self, fresh: &mut Fresh) -> Result<LoadReport, RenderError> {
        let spec = &self.scene().spec;
        let scene = match fresh.take().filter(|scene| scene.scene().spec == *spec) {
            Some(scene) => scene,
            None => SharedScene::new(self.gpu(), load_scene(&self.catalog, spec)?)?,
        };
        let report = self.set_shared_scene(fresh.insert(scene))?;
        self.scene_stale = false;
        Ok(report)
    }

    /// Returns those of some files that the pipeline or the scene was made from.
    pub fn reads(&self, files: &BTreeSet<PathBuf>) -> BTreeSet<PathBuf> {
        let compiled = self.compiled().into_iter();
        let sources = compiled.clone().flat_map(|compiled| compiled.resolved.sources().iter());
        let shaders = compiled.flat_map(Compiled::shader_files);
        let names = sources.map(|source| source.name.clone()).chain(shaders);
        // Each is looked up once, not for each of the files: a checkout has hundreds.
        let of_pipeline = names.map(|name| place(&self.on_disk(&name)));
        let known: BTreeSet<PathBuf> =
            of_pipeline.chain(self.scene().files.iter().map(|file| place(file))).collect();
        files.iter().filter(|file| known.contains(&place(file))).cloned().collect()
    }

    /// Returns the folders to watch, with all that is in them, for [`Renderer::reload`]: those of the tree that files
    /// come from, and those of further files that take part.
    pub fn watched_folders(&self) -> Vec<PathBuf> {
        let root = self.catalog.assets().root();
        let mut folders: Vec<PathBuf> = root
            .into_iter()
            .flat_map(|root| {
                ["pipelines", "scenes", "shaders", "crates/interfaces", "passes"]
                    .map(|folder| root.join(folder))
            })
            .filter(|folder| folder.is_dir())
            .collect();
        let compiled = self.compiled();
        let pipelines = compiled.into_iter().flat_map(|compiled| compiled.resolved.sources().iter());
        let shaders = compiled.into_iter().flat_map(Compiled::shader_files);
        let files = pipelines.map(|source| source.name.clone()).chain(shaders).map(PathBuf::from);
        for file in files.chain(self.scene().files.iter().cloned()) {
            let file = file.to_str().map_or(file.clone(), |name| self.on_disk(name));
            let folder = match file.parent() {
                Some(folder) if folder.as_os_str().is_empty() => Path::new("."),
                Some(folder) => folder,
                None => continue,
            };
            if file.is_file() && !folders.iter().any(|known| folder.starts_with(known)) {
                folders.push(folder.to_owned());
            }
        }
        folders
    }

    /// The file on disk of this name: from the root of the tree, where it is there, else from the working folder.
    fn on_disk(&self, name: &str) -> PathBuf {
        let root = self.catalog.assets().root();
        root.map(|root| root.join(name)).filter(|file| file.is_file()).unwrap_or_else(|| PathBuf::from(name))
    }

    /// The path by which a file on disk is known, with `/`: from the root of the tree, or from the working folder.
    fn asset_path(&self, path: &Path) -> Option<String> {
        // Systems report whole paths, also where a folder was named from the working folder.
        let whole = place(path);
        let within = |folder: &Path| {
            let inner = folder.canonicalize().ok().and_then(|folder| whole.strip_prefix(folder).ok());
            inner.map(Path::to_owned)
        };
        let named = self.catalog.assets().root().and_then(within).or_else(|| within(Path::new(".")));
        Some(named.as_deref().unwrap_or(path).to_str()?.replace('\\', "/"))
    }
}

/// A path by which a file is the same however it was named, also when it is gone.
fn place(path: &Path) -> PathBuf {
    let folder =
        path.parent().map(|folder| if folder.as_os_str().is_empty() { Path::new(".") } else { folder });
    match (folder.and_then(|folder| folder.canonicalize().ok()), path.file_name()) {
        (Some(folder), Some(name)) => folder.join(name),
        _ => path.to_owned(),
    }
}
