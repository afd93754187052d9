//! Where WGSL comes from: folders on disk, texts in memory, and one laid over the other.

use data_file::{Files, Source, read_text_bytes};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// A source of files that may be read from several threads; anything that is [`Files`] and can be shared is one.
///
/// Paths are relative to a root, with `/` between folders: `passes/gather/gather.wgsl`.
pub trait ShaderFiles: Files + Send + Sync {}

impl<T: Files + Send + Sync + ?Sized> ShaderFiles for T {}

/// Texts in memory, replaced as one likes: what is embedded in a program, or edited in an editor.
#[derive(Debug, Default)]
pub struct MemoryFiles(Mutex<BTreeMap<String, Arc<Source>>>);

impl MemoryFiles {
    /// Creates the files of these paths and texts.
    pub fn new<P: Into<String>, T: Into<String>>(files: impl IntoIterator<Item = (P, T)>) -> Self {
        let memory = MemoryFiles::default();
        for (path, text) in files {
            memory.set(path, text);
        }
        memory
    }

    /// Adds a file, or replaces its text. [`Library::invalidate`](crate::Library::invalidate) is the caller's.
    pub fn set(&self, path: impl Into<String>, text: impl Into<String>) {
        let name = path.into();
        self.lock().insert(name.clone(), Source::new(name, text));
    }

    /// Takes a file away.
    pub fn remove(&self, path: &str) {
        self.lock().remove(path);
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, BTreeMap<String, Arc<Source>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Files for MemoryFiles {
    fn read(&self, path: &str) -> Option<Arc<Source>> {
        self.lock().get(path).cloned()
    }

    fn list(&self) -> Vec<String> {
        self.lock().keys().cloned().collect()
    }
}

/// Files under a folder. Bytes that are not UTF-8 are shown as the replacement character, so that the error
/// is about the text and not that there is no file.
#[derive(Clone, Debug)]
pub struct DiskFiles {
    root: PathBuf,
}

impl DiskFiles {
    /// Creates the files under `root`.
    pub fn new(root: impl Into<PathBuf>) -> Self {
        DiskFiles { root: root.into() }
    }

    /// Returns the folder.
    pub fn root(&self) -> &Path {
        &self.root
    }
}

impl Files for DiskFiles {
    fn read(&self, path: &str) -> Option<Arc<Source>> {
        let inside = normalise(path).filter(|inside| inside == path && !inside.starts_with('/'))?;
        let bytes = read_text_bytes(&self.root.join(&inside)).ok()?;
        Some(Source::new(inside, String::from_utf8_lossy(&bytes)))
    }

    /// Hidden folders and `target` are left out.
    fn list(&self) -> Vec<String> {
        let mut paths = files_under(&self.root)
            .into_iter()
            .filter_map(|path| {
                let inside = path.strip_prefix(&self.root).ok()?.to_str()?;
                Some(inside.replace('\\', "/"))
            })
            .collect::<Vec<_>>();
        paths.sort();
        paths
    }

    fn roots(&self) -> Vec<PathBuf> {
        vec![self.root.clone()]
    }
}

/// Returns all files under `root`, without hidden folders and `target`, in no order. Links are not followed.
pub fn files_under(root: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    let mut folders = vec![root.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).into_iter().flatten().flatten() {
            let name = entry.file_name();
            let hidden = name.to_string_lossy().starts_with('.') || name == "target";
            match entry.file_type() {
                Ok(kind) if kind.is_dir() && !hidden => folders.push(entry.path()),
                Ok(kind) if kind.is_file() => files.push(entry.path()),
                _ => {}
            }
        }
    }
    files
}

/// Several sources of files; of two files of one path the first source's is read.
pub struct Overlay(pub Vec<Arc<dyn ShaderFiles>>);

impl Files for Overlay {
    fn read(&self, path: &str) -> Option<Arc<Source>> {
        self.0.iter().find_map(|files| files.read(path))
    }

    fn list(&self) -> Vec<String> {
        self.0.iter().flat_map(|files| files.list()).collect::<BTreeSet<_>>().into_iter().collect()
    }

    fn roots(&self) -> Vec<PathBuf> {
        self.0.iter().flat_map(|files| files.roots()).collect()
    }
}

/// `path` without `.` and `..`; `None` where it leads out of the root. An absolute path stays absolute.
pub(crate) fn normalise(path: &str) -> Option<String> {
    let mut parts = Vec::new();
    for part in path.split(['/', '\\']) {
        match part {
            "" | "." => {}
            ".." => {
                parts.pop()?;
            }
            part => parts.push(part),
        }
    }
    let root = if path.starts_with('/') { "/" } else { "" };
    Some(format!("{root}{}", parts.join("/")))
}

/// The path `path` in `folder`, unless it is absolute; `None` where it leads out of the root.
pub(crate) fn join(folder: &str, path: &str) -> Option<String> {
    let joined = if folder.is_empty() || path.starts_with('/') {
        normalise(path)
    } else {
        normalise(&format!("{folder}/{path}"))
    };
    joined.filter(|joined| !joined.is_empty() && joined != "/")
}

/// The folder that holds `path`; empty for the root.
pub(crate) fn folder(path: &str) -> &str {
    path.rsplit_once('/').map_or("", |(folder, _)| folder)
}

#[cfg(test)]
mod tests {
    use super::join;

    #[test]
    fn paths_are_joined_without_leaving_the_root() {
        let cases = [
            ("", "a.wgsl", Some("a.wgsl")),
            ("shaders", "./x/../a.wgsl", Some("shaders/a.wgsl")),
            ("passes/gather", "../splat/a.wgsl", Some("passes/splat/a.wgsl")),
            ("shaders", "../../a.wgsl", None),
            ("shaders", "", Some("shaders")),
            ("", "", None),
            // A file elsewhere on the disk, and one that it imports.
            ("shaders", "/elsewhere/a.wgsl", Some("/elsewhere/a.wgsl")),
            ("/elsewhere", "b.wgsl", Some("/elsewhere/b.wgsl")),
            ("/elsewhere", "../../b.wgsl", None),
            ("", "/", None),
        ];
        for (folder, path, expected) in cases {
            assert_eq!(join(folder, path).as_deref(), expected, "{path} in {folder}");
        }
    }
}
