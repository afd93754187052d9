//! The source of scene descriptions.

use data_file::Files;
use std::path::PathBuf;

/// Access to the scene descriptions, by paths relative to the scenes' folder (`cornell-box.ron`).
pub trait SceneFiles: Files {
    /// Returns the folder on disk to which the paths of geometry files in descriptions are relative. The
    /// default is the working folder.
    fn folder(&self) -> PathBuf {
        PathBuf::new()
    }
}
