//! Where files come from.

use crate::Source;
use std::sync::Arc;

/// The files of one sort, such as pipelines, scenes or shaders: on disk, embedded in a program, or both.
pub trait Files {
    /// Returns the file at `path`, relative to the folder of its sort; `None` where there is none.
    fn read(&self, path: &str) -> Option<Arc<Source>>;

    /// Returns the paths of all files: for lists, and for errors that offer the nearest.
    fn list(&self) -> Vec<String>;
}
