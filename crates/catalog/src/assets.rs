//! Files by their path from the root of the tree: on disk first, then those embedded in the program.

use data_file::read_text;
use frame_graph::Source;
use frame_graph::resolve;
use pass::Files;
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, PoisonError, RwLock};

/// The source of pipelines, shaders and scenes. Clones share the texts of [`Assets::set_open`].
#[derive(Clone, Debug)]
pub struct Assets {
    root: Option<PathBuf>,
    embedded: BTreeMap<Cow<'static, str>, &'static str>,
    open: Arc<RwLock<BTreeMap<PathBuf, Arc<str>>>>,
    read: Arc<AtomicU64>,
}

impl Assets {
    /// Creates assets with a folder on disk, whose files take precedence over the embedded ones; `None` for embedded
    /// files alone.
    pub fn new(root: Option<PathBuf>) -> Assets {
        let mut assets =
            Assets { root, embedded: BTreeMap::new(), open: Arc::default(), read: Arc::default() };
        assets.embed("", crate::EMBEDDED);
        assets
    }

    /// Lays a text over the file at a path, which need not be there: what an editor has and has not saved. `None` takes it
    /// away again.
    pub fn set_open(&self, path: &Path, text: Option<&str>) {
        let mut open = self.open.write().unwrap_or_else(PoisonError::into_inner);
        match text {
            Some(text) => open.insert(place(path), text.into()),
            None => open.remove(&place(path)),
        };
    }

    /// Returns the text that lies over the file at a path.
    fn open_text(&self, path: &Path) -> Option<Arc<str>> {
        let open = self.open.read().unwrap_or_else(PoisonError::into_inner);
        if open.is_empty() { None } else { open.get(&place(path)).cloned() }
    }

    /// Reads a text from disk, or the one that lies over it.
    ///
    /// # Errors
    /// As [`read_text`].
    pub fn read(&self, path: &Path) -> io::Result<String> {
        let text = match self.open_text(path) {
            Some(text) => text.to_string(),
            None => read_text(path)?,
        };
        self.read.fetch_add(text.len() as u64, Ordering::Relaxed);
        Ok(text)
    }

    /// Returns how many bytes were read from disk, or of texts that lie over it: the work of an answer follows from these.
    pub fn bytes_read(&self) -> u64 {
        self.read.load(Ordering::Relaxed)
    }

    /// Adds embedded files, as path from the root of the tree and text: for a crate outside the tree that adds interfaces or
    /// pipelines. They take precedence over files of the tree with the same path.
    pub fn with_files(mut self, files: impl IntoIterator<Item = (&'static str, &'static str)>) -> Assets {
        self.embedded.extend(files.into_iter().map(|(path, text)| (path.into(), text)));
        self
    }

    /// Adds embedded files of a folder where there are none of the same paths.
    pub(crate) fn embed(&mut self, folder: &str, files: Files) {
        for (path, text) in files {
            let path = if folder.is_empty() { (*path).into() } else { format!("{folder}/{path}").into() };
            self.embedded.entry(path).or_insert(text);
        }
    }

    /// Returns the folder on disk.
    pub fn root(&self) -> Option<&Path> {
        self.root.as_deref()
    }

    /// Returns the nearest folder, from `start` upwards, that looks like a tree of Lightloom: it holds `pipelines/` and
    /// `shaders/`, or `passes/`.
    pub fn find_root(start: &Path) -> Option<PathBuf> {
        let is_root = |folder: &Path| {
            folder.join("pipelines").is_dir()
                && (folder.join("shaders").is_dir() || folder.join("passes").is_dir())
        };
        start.ancestors().find(|folder| is_root(folder)).map(Path::to_path_buf)
    }

    /// Returns the folder on disk as the only one, for [`resolve::Files::roots`].
    fn roots(&self) -> Vec<PathBuf> {
        self.root.iter().cloned().collect()
    }

    /// Returns the text of a file; `None` where there is none. Paths that leave the root are not followed, absolute
    /// ones and those from the working folder are read as they stand when `root` has no such file. Whoever found a path
    /// in a file asks [`may_name`](data_file::paths::may_name) first.
    pub fn text(&self, path: &str) -> Option<String> {
        let on_disk = self
            .root
            .as_ref()
            .filter(|_| is_below_root(path))
            .and_then(|root| self.read(&root.join(path)).ok());
        on_disk
            .or_else(|| self.embedded.get(path).map(|text| (*text).to_owned()))
            .or_else(|| self.read(Path::new(path)).ok())
    }

    /// Returns whether there is a file at a path, where [`Assets::text`] looks for it.
    pub fn has(&self, path: &str) -> bool {
        let is_file = |path: &Path| path.is_file() || self.open_text(path).is_some();
        let in_root =
            self.root.as_ref().filter(|_| is_below_root(path)).is_some_and(|root| is_file(&root.join(path)));
        in_root || self.embedded.contains_key(path) || is_file(Path::new(path))
    }

    /// Returns the text that is embedded in the program for a path from the root.
    pub fn embedded(&self, path: &str) -> Option<&'static str> {
        self.embedded.get(path).copied()
    }

    /// Paths of all files below a folder of the root, embedded or on disk, with that extension; sorted.
    pub fn list(&self, folder: &str, extension: &str) -> Vec<String> {
        let prefix = format!("{folder}/");
        let wanted = |path: &str| path.starts_with(&prefix) && path.ends_with(&format!(".{extension}"));
        let mut found: BTreeSet<String> =
            self.embedded.keys().filter(|path| wanted(path)).map(|path| path.to_string()).collect();
        if let Some(root) = &self.root {
            let mut open = vec![root.join(folder)];
            while let Some(entry) = open.pop() {
                if entry.is_dir() {
                    open.extend(
                        std::fs::read_dir(&entry)
                            .into_iter()
                            .flatten()
                            .flatten()
                            .map(|e| e.path())
                            .filter(|path| !path.ends_with("target")),
                    );
                } else if let Ok(relative) = entry.strip_prefix(root) {
                    let relative = relative.to_string_lossy().replace('\\', "/");
                    if wanted(&relative) {
                        found.insert(relative);
                    }
                }
            }
        }
        found.into_iter().collect()
    }
}

/// Returns the one path of a file, through whatever links and from whatever folder it is named.
fn place(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        let folder = path.parent().and_then(|folder| folder.canonicalize().ok());
        folder.zip(path.file_name()).map_or(path.clone(), |(folder, name)| folder.join(name))
    })
}

/// Whether a path from the root leads to what is in it.
fn is_below_root(path: &str) -> bool {
    !path.is_empty() && !Path::new(path).is_absolute() && !path.split('/').any(|part| part == "..")
}

/// Pipelines by the name that users give: `ism-invtm`, `ism-invtm.ron`, `parts/x.ron`, or a path.
#[derive(Clone, Debug)]
pub struct PipelineFiles(pub Assets);

impl resolve::Files for PipelineFiles {
    fn read(&self, path: &str) -> Option<Arc<Source>> {
        let named = if path.ends_with(".ron") { path.to_owned() } else { format!("{path}.ron") };
        [format!("pipelines/{named}"), named].into_iter().find_map(|name| {
            let text = self.0.text(&name)?;
            Some(Arc::new(Source { name, text }))
        })
    }

    fn at(&self, path: &str) -> Option<Arc<Source>> {
        let with_ending =
            (!path.ends_with(".ron") && !path.ends_with(".wgsl")).then(|| format!("{path}.ron"));
        let mut names = [Some(path.to_owned()), with_ending].into_iter().flatten();
        names.find_map(|name| self.0.text(&name).map(|text| Arc::new(Source { name, text })))
    }

    fn list(&self) -> Vec<String> {
        let strip = |path: String| path.trim_start_matches("pipelines/").to_owned();
        self.0.list("pipelines", "ron").into_iter().map(strip).collect()
    }

    fn roots(&self) -> Vec<PathBuf> {
        self.0.roots()
    }
}

/// WGSL by path from the root: `shaders/camera.wgsl`, `passes/gather/gather.wgsl`.
#[derive(Clone, Debug)]
pub struct ShaderAssets(pub Assets);

impl resolve::Files for ShaderAssets {
    fn read(&self, path: &str) -> Option<Arc<Source>> {
        let text = self.0.text(path).filter(|_| path.ends_with(".wgsl"))?;
        Some(Arc::new(Source { name: path.to_owned(), text }))
    }

    fn list(&self) -> Vec<String> {
        ["shaders", "crates/interfaces", "passes", "pipelines"]
            .map(|folder| self.0.list(folder, "wgsl"))
            .concat()
    }

    fn elsewhere(&self) -> Option<&'static str> {
        Some("the working folder")
    }

    fn roots(&self) -> Vec<PathBuf> {
        self.0.roots()
    }
}

/// Scene descriptions by name: `cornell-box.ron`.
#[derive(Clone, Debug)]
pub struct SceneAssets(pub Assets);

impl resolve::Files for SceneAssets {
    fn read(&self, path: &str) -> Option<Arc<Source>> {
        let name = format!("scenes/{path}");
        let text = self.0.text(&name)?;
        Some(Arc::new(Source { name, text }))
    }

    fn list(&self) -> Vec<String> {
        self.0
            .list("scenes", "ron")
            .into_iter()
            .map(|path| path.trim_start_matches("scenes/").to_owned())
            .collect()
    }

    fn roots(&self) -> Vec<PathBuf> {
        self.0.roots()
    }
}

impl scene::SceneFiles for SceneAssets {
    fn folder(&self) -> PathBuf {
        self.0.root().map_or_else(PathBuf::new, |root| root.join("scenes"))
    }

    fn on_disk(&self, path: &Path) -> io::Result<String> {
        self.0.read(path)
    }
}
