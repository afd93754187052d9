//! What there is where a file is to be.

use std::fs::{self, Permissions};
use std::io;
use std::path::{Path, PathBuf};

/// How many links are followed, as many as Linux does.
const LINKS: u32 = 40;

/// What there is where a file is to be, with its path beyond all links.
#[derive(Debug)]
pub(crate) enum Place {
    /// Nothing.
    New(PathBuf),
    /// A file, with its permissions.
    File(PathBuf, Permissions),
    /// A device, a pipe or a socket.
    Device(PathBuf),
}

/// Finds what there is at a path.
///
/// # Errors
/// Where it is a folder or a read-only file, and where links lead in a circle. What is wrong with the folder is left to be
/// told by whoever makes a file in it.
pub(crate) fn of(path: &Path) -> io::Result<Place> {
    let mut path = path.to_owned();
    for _ in 0..LINKS {
        let Ok(found) = fs::symlink_metadata(&path) else { return Ok(Place::New(path)) };
        if found.is_dir() {
            return Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a folder"));
        }
        if found.is_file() {
            return match found.permissions() {
                permissions if permissions.readonly() => {
                    Err(io::Error::new(io::ErrorKind::PermissionDenied, "the file is read-only"))
                }
                permissions => Ok(Place::File(path, permissions)),
            };
        }
        if !found.is_symlink() {
            return Ok(Place::Device(path));
        }
        let Ok(target) = fs::read_link(&path) else { return Ok(Place::Device(path)) };
        // Links of the system to what a process has open, such as `/dev/stdout`, name no path that could be made.
        path = match path.canonicalize() {
            Ok(real) => real,
            Err(_) if fs::metadata(&path).is_ok() => return Ok(Place::Device(path)),
            Err(_) => path.parent().unwrap_or(Path::new("")).join(target),
        };
    }
    Err(io::Error::other("links lead in a circle"))
}
