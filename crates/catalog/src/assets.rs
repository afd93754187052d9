//! Files by their path from the root of the tree: on disk first, then those embedded in the program.

use data_file::read_text;
use frame_graph::Source;
use frame_graph::resolve::Files;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The source of pipelines, shaders and scenes.
#[derive(Clone, Debug)]
pub struct Assets {
    root: Option<PathBuf>,
    embedded: BTreeMap<&'static str, &'static str>,
}

impl Assets {
    /// Creates assets with a folder on disk, whose files take precedence over the embedded ones; `None` for embedded
    /// files alone.
    pub fn new(root: Option<PathBuf>) -> Assets {
        Assets { root, embedded: crate::EMBEDDED.iter().copied().collect() }
    }

    /// Adds embedded files, as path from the root of the tree and text: for a crate outside the tree that adds passes.
    /// They take precedence over files of the tree with the same path.
    pub fn with_files(mut self, files: impl IntoIterator<Item = (&'static str, &'static str)>) -> Assets {
        self.embedded.extend(files);
        self
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

    /// Returns the folder on disk as the only one, for [`Files::roots`].
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
            .and_then(|root| read_text(&root.join(path)).ok());
        on_disk
            .or_else(|| self.embedded.get(path).map(|text| (*text).to_owned()))
            .or_else(|| read_text(Path::new(path)).ok())
    }

    /// Returns whether there is a file at a path, where [`Assets::text`] looks for it.
    pub fn has(&self, path: &str) -> bool {
        let in_root =
            self.root.as_ref().filter(|_| is_below_root(path)).is_some_and(|root| root.join(path).is_file());
        in_root || self.embedded.contains_key(path) || Path::new(path).is_file()
    }

    /// Paths of all files below a folder of the root, embedded or on disk, with that extension; sorted.
    pub fn list(&self, folder: &str, extension: &str) -> Vec<String> {
        let prefix = format!("{folder}/");
        let wanted = |path: &str| path.starts_with(&prefix) && path.ends_with(&format!(".{extension}"));
        let mut found: BTreeSet<String> =
            self.embedded.keys().filter(|path| wanted(path)).map(|path| (*path).to_owned()).collect();
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

/// Whether a path from the root leads to what is in it.
fn is_below_root(path: &str) -> bool {
    !path.is_empty() && !Path::new(path).is_absolute() && !path.split('/').any(|part| part == "..")
}

/// Pipelines by the name that users give: `ism-invtm`, `ism-invtm.ron`, `parts/x.ron`, or a path.
#[derive(Clone, Debug)]
pub struct PipelineFiles(pub Assets);

impl Files for PipelineFiles {
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

impl Files for ShaderAssets {
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

impl Files for SceneAssets {
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
}
