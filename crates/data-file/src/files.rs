//! Where files come from.

use crate::Source;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The longest text that is read, in bytes: a hundred times the longest scene that anyone wrote, and parsed in a second.
pub const MAX_TEXT: usize = 16 << 20;

/// The files of one sort, such as pipelines, scenes or shaders: on disk, embedded in a program, or both.
pub trait Files {
    /// Returns the file at `path`, relative to the folder of its sort; `None` where there is none.
    fn read(&self, path: &str) -> Option<Arc<Source>>;

    /// Returns the file at this very path, from the root or the working folder, whatever its sort; `None` where there is
    /// none. The default looks where [`Files::read`] does.
    fn at(&self, path: &str) -> Option<Arc<Source>> {
        self.read(path)
    }

    /// Returns where files are looked for beside the roots, in words; `None` where nowhere.
    fn elsewhere(&self) -> Option<&'static str> {
        None
    }

    /// Returns the paths of all files: for lists, and for errors that offer the nearest.
    fn list(&self) -> Vec<String>;

    /// Returns the folders on disk in which files may be that a file names, beside its own folder and the working folder;
    /// see [`paths`](crate::paths). There are none where nothing is on disk.
    fn roots(&self) -> Vec<PathBuf> {
        Vec::new()
    }
}

/// Reads a text. Of one longer than [`MAX_TEXT`] it reads no more than shows that it is; its parser then refuses it.
///
/// # Errors
/// Those of the system; and where it is no regular file, or not UTF-8.
pub fn read_text(path: &Path) -> io::Result<String> {
    let bytes = read_text_bytes(path)?;
    if bytes.len() > MAX_TEXT {
        // Its end may be within a character.
        return Ok(String::from_utf8_lossy(&bytes).into_owned());
    }
    String::from_utf8(bytes).map_err(|error| {
        let line = error.as_bytes()[..error.utf8_error().valid_up_to()].split(|byte| *byte == b'\n').count();
        io::Error::new(io::ErrorKind::InvalidData, format!("it is not UTF-8 (line {line})"))
    })
}

/// Returns why a file that is there cannot be read as a text; `None` where it can, or is not there.
pub fn why_unreadable(path: &Path) -> Option<io::Error> {
    read_text(path).err().filter(|error| error.kind() != io::ErrorKind::NotFound)
}

/// Reads the bytes of a text, as [`read_text`] does.
///
/// # Errors
/// Those of the system; and where it is no regular file.
pub fn read_text_bytes(path: &Path) -> io::Result<Vec<u8>> {
    // Before it is opened: a FIFO would wait for its writer.
    if !fs::metadata(path)?.is_file() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "it is no regular file"));
    }
    let mut bytes = Vec::new();
    File::open(path)?.take(MAX_TEXT as u64 + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}
