//! Which files a file may name.
//!
//! Pipelines, shaders, scenes, models and studies are passed on and tried out by people who have not read them, so none of
//! them names files all over the disk: a file may name those of its own folder, of the working folder, and of the roots
//! that the user gave, with all that is below. What the user names on the command line is not asked about. A link
//! inside that leads elsewhere was made by the user.

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
    let linked = LazyCell::new(|| path.canonicalize().ok());
    let inside = |folder: &Path| {
        let Some(folder) = plain(folder) else { return false };
        let same = |path: &PathBuf| folder.canonicalize().is_ok_and(|folder| path.starts_with(folder));
        path.starts_with(&folder) || linked.as_ref().is_some_and(same)
    };
    let own = plain(by).and_then(|by| Some(by.parent()?.to_owned()));
    own.is_some_and(|own| inside(&own)) || inside(Path::new(".")) || roots.iter().any(|root| inside(root))
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
