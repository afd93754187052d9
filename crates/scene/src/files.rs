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

    /// Returns the folders in which files may be that scenes and models name, beside the folder of the file that names
    /// them and the working folder. The default is the folder of the scenes.
    fn roots(&self) -> Vec<PathBuf> {
        vec![self.folder()]
    }
}
