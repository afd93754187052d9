//! Which files a file may name.
//!
//! Pipelines, shaders, scenes, models and studies are passed on and tried out by people who have not read them, so none of
//! them names files all over the disk: a file may name those of its own folder, of the working folder, and of the roots
//! that the user gave, with all that is below. What the user names on the command line is not asked about. A
//! symbolic link is what it leads to: a folder that was passed on may hold links, too.
//!
//! A name in a file means the file of that name in the folder of the file that names it; where there is none, that of a
//! root, such as a built-in pipeline. A path with `./` or `../` in it means what is there from the folder of the file, and
//! nothing else. So a folder of files can be handed on.

use std::cell::LazyCell;
use std::path::{Component, Path, PathBuf, absolute};

/// What is said of a path for which [`may_name`] is false, behind the path.
pub const OUTSIDE: &str = "is neither in the folder of the file that names it, nor in the working folder, nor in the \
                           tree; run Lightloom from a folder around both, or give one with `--root`";

/// Returns whether the file at `by` may name the file at `path`: whether that is in the folder of `by`, in the working
/// folder, or in one of `roots`. Paths that are not absolute are from the working folder.
pub fn may_name(by: &Path, path: &Path, roots: &[PathBuf]) -> bool {
    let Some(path) = plain(path) else { return false };
    // A folder can have two names, such as `/var` and `/private/var`: what is the same file is inside under either.
    let real = LazyCell::new(|| path.canonicalize().ok());
    let inside = |folder: &Path| {
        let Some(folder) = plain(folder) else { return false };
        match &*real {
            Some(real) => folder.canonicalize().is_ok_and(|folder| real.starts_with(folder)),
            // Nothing is there.
            None => path.starts_with(&folder),
        }
    };
    let own = plain(by).and_then(|by| Some(by.parent()?.to_owned()));
    own.is_some_and(|own| inside(&own)) || inside(Path::new(".")) || roots.iter().any(|root| inside(root))
}

/// Returns whether there is a symbolic link at a path, from the working folder.
pub fn is_link(path: &str) -> bool {
    Path::new(path).is_symlink()
}

/// Returns the path of the file that the file at `by` means by `path`, from its own folder: `pipelines/a.ron` means
/// `pipelines/parts/b.ron` by `parts/b.ron`. `None` for a path from the root of the disk.
pub fn beside(by: &str, path: &str) -> Option<String> {
    if Path::new(path).is_absolute() || path.starts_with('/') {
        return None;
    }
    let folder = by.rsplit_once('/').map_or("", |(folder, _)| if folder.is_empty() { "/" } else { folder });
    let mut parts: Vec<&str> = Vec::new();
    let mut above = false;
    for part in folder.split('/').chain(path.split('/')).filter(|part| !matches!(*part, "" | ".")) {
        match part {
            ".." if parts.last().is_some_and(|last| *last != "..") => {
                parts.pop();
            }
            ".." => {
                above = true;
                parts.push(part);
            }
            part => parts.push(part),
        }
    }
    let joined = parts.join("/");
    if folder.starts_with('/') {
        return Some(format!("/{joined}"));
    }
    // Shaders are found by paths that do not begin above the working folder.
    if above { Some(plain(Path::new(&joined))?.to_string_lossy().replace('\\', "/")) } else { Some(joined) }
}

/// Returns whether a path says itself that it is from the folder of the file that names it: with `./` or `../`.
pub fn is_from_own_folder(path: &str) -> bool {
    path.split('/').any(|part| matches!(part, "." | ".."))
}

/// Returns a path from the root of the disk, without `.` and `..`; `None` where there is no working folder.
fn plain(path: &Path) -> Option<PathBuf> {
    let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
    let mut plain = PathBuf::new();
    for component in absolute(path).ok()?.components() {
        match component {
            Component::CurDir => {}
            // Above the root is the root.
            Component::ParentDir => {
                plain.pop();
            }
            other => plain.push(other),
        }
    }
    Some(plain)
}
