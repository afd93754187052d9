//! Looks up the path at which a file is to be.

use std::fs::{self, Permissions};
use std::io;
use std::path::{Path, PathBuf};

/// The greatest number of links that are followed: that of Linux.
const LINKS: u32 = 40;

/// The content of a path at which a file is to be, with the path beyond all links.
#[derive(Debug)]
pub(crate) enum Target {
    /// Nothing.
    New(PathBuf),
    /// A file, with its permissions.
    File(PathBuf, Permissions),
    /// A device, a pipe or a socket.
    Device(PathBuf),
}

/// Looks up a path.
///
/// # Errors
/// It is a folder or a read-only file, or links lead in a circle. Errors of its folder are left to whoever makes a file in it.
pub(crate) fn of(path: &Path) -> io::Result<Target> {
    let mut path = path.to_owned();
    for _ in 0..LINKS {
        let Ok(found) = fs::symlink_metadata(&path) else { return Ok(Target::New(path)) };
        if found.is_dir() {
            return Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a folder"));
        }
        if found.is_file() {
            return match found.permissions() {
                permissions if permissions.readonly() => {
                    Err(io::Error::new(io::ErrorKind::PermissionDenied, "the file is read-only"))
                }
                permissions => Ok(Target::File(path, permissions)),
            };
        }
        if !found.is_symlink() {
            return Ok(Target::Device(path));
        }
        let Ok(target) = fs::read_link(&path) else { return Ok(Target::Device(path)) };
        // Links of the system to what a process has open, such as `/dev/stdout`, name no path that could be made.
        path = match path.canonicalize() {
            Ok(real) => real,
            Err(_) if fs::metadata(&path).is_ok() => return Ok(Target::Device(path)),
            Err(_) => path.parent().unwrap_or(Path::new("")).join(target),
        };
    }
    Err(io::Error::other("links lead in a circle"))
}
