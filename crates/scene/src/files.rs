//! Where scene descriptions come from.

use data_file::Files;
use std::path::PathBuf;

/// The scene descriptions there are, by paths relative to the scenes' folder (`cornell-box.ron`).
pub trait SceneFiles: Files {
    /// The folder on disk from which the geometry files that descriptions name are looked for. The working
    /// folder unless overridden.
    fn folder(&self) -> PathBuf {
        PathBuf::new()
    }
}
