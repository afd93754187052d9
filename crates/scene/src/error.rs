//! The errors of loading and saving a scene.

use std::io;
use std::path::PathBuf;

use data_file::Diagnostics;

/// The reason why a scene could not be loaded or saved.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// There is no scene or file with this name.
    #[error("there is no scene `{spec}`{}", did_you_mean(.nearest.as_deref(), .known))]
    NotFound {
        /// The requested name or path.
        spec: String,
        /// The most similar name of a scene, if there is one.
        nearest: Option<String>,
        /// The names of scenes; empty where a glTF file was requested.
        known: Vec<String>,
    },
    /// The file exists, but cannot be read.
    #[error("{}: cannot be read: {error}", .path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        error: io::Error,
    },
    /// The file cannot be written; it is as it was.
    #[error("{}: cannot be written: {error}", .path.display())]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        error: io::Error,
    },
    /// The scene description has errors, each with file, line and column.
    #[error("{0}")]
    Description(#[from] Diagnostics),
    /// The glTF file has an error.
    #[error("{}: {place}: {problem}", .file.display())]
    Gltf {
        /// The file.
        file: PathBuf,
        /// The node, mesh, primitive, accessor, or other part.
        place: String,
        /// The problem, and what was expected.
        problem: String,
    },
    /// There is nothing to render. Only the built-in `empty` is allowed to be empty.
    #[error("{file}: the scene has no triangles; an empty scene is available as the built-in `empty`{}", stated(.repairs))]
    Empty {
        /// The file or scene.
        file: String,
        /// Repairs and omissions, as possible causes.
        repairs: Vec<String>,
    },
    /// The scene is larger than a GPU can address.
    #[error("{file}: {problem}")]
    TooLarge {
        /// The file or scene.
        file: String,
        /// The size and its limit.
        problem: String,
    },
}

fn did_you_mean(nearest: Option<&str>, known: &[String]) -> String {
    let nearest = nearest.map_or(String::new(), |name| format!("; did you mean `{name}`?"));
    if known.is_empty() { nearest } else { format!("{nearest} (there are: {})", known.join(", ")) }
}

fn stated(repairs: &[String]) -> String {
    if repairs.is_empty() { String::new() } else { format!(" ({})", repairs.join("; ")) }
}
