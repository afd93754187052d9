//! The source of scene descriptions.

use data_file::{Files, read_text};
use std::io;
use std::path::{Path, PathBuf};

/// Access to the scene descriptions, by paths relative to the scenes' folder (`cornell-box.ron`).
pub trait SceneFiles: Files {
    /// Returns the folder on disk to which the paths of geometry files in descriptions are relative. The
    /// default is the working folder.
    fn folder(&self) -> PathBuf {
        PathBuf::new()
    }

    /// Reads the description at a path on disk, or what an editor lays over it.
    ///
    /// # Errors
    /// As [`read_text`].
    fn on_disk(&self, path: &Path) -> io::Result<String> {
        read_text(path)
    }
}
