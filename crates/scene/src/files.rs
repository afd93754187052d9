//! Where scene descriptions come from.

use std::path::PathBuf;
use std::sync::Arc;

use data_file::Source;

/// The scene descriptions there are: embedded in a program, on disk, or both.
pub trait SceneFiles {
    /// The file at `path`, relative to the scenes' folder (`cornell-box.ron`); `None` where there is none.
    fn read(&self, path: &str) -> Option<Arc<Source>>;

    /// The paths of all scene files: for lists, and for errors that offer the nearest.
    fn list(&self) -> Vec<String>;

    /// The folder on disk from which the geometry files that descriptions name are looked for. The working
    /// folder unless overridden.
    fn folder(&self) -> PathBuf {
        PathBuf::new()
    }
}
