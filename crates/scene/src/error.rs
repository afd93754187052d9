//! What can be wrong with a scene.

use std::io;
use std::path::PathBuf;

use frame_graph::Diagnostics;

/// Why a scene could not be loaded.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// There is no such scene or file.
    #[error("there is no scene `{spec}`{}", did_you_mean(.nearest))]
    NotFound {
        /// What was asked for.
        spec: String,
        /// The names of scenes, nearest first; empty where a path was given.
        nearest: Vec<String>,
    },
    /// The file is there, but cannot be read.
    #[error("{}: cannot be read: {error}", .path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
    /// The scene description is wrong; each error has its file, line and column.
    #[error("{0}")]
    Description(#[from] Diagnostics),
    /// The glTF file is wrong.
    #[error("{}: {place}: {problem}", .file.display())]
    Gltf {
        /// The file.
        file: PathBuf,
        /// The node, mesh, primitive, accessor, or other part.
        place: String,
        /// What is wrong there, and what was expected.
        problem: String,
    },
    /// There is nothing to render. Only the built-in `empty` may be so.
    #[error("{file}: the scene has no triangles; an empty scene is available as the built-in `empty`{}", stated(.repairs))]
    Empty {
        /// The file or scene.
        file: String,
        /// What was repaired or left out before it came to this.
        repairs: Vec<String>,
    },
    /// The scene does not fit what a GPU can address.
    #[error("{file}: {problem}")]
    TooLarge {
        /// The file or scene.
        file: String,
        /// What is too large, and the limit.
        problem: String,
    },
}

fn did_you_mean(names: &[String]) -> String {
    match names {
        [] => String::new(),
        [first, ..] => format!("; did you mean `{first}`? (there are: {})", {
            let mut all = names.to_vec();
            all.sort();
            all.join(", ")
        }),
    }
}

fn stated(repairs: &[String]) -> String {
    if repairs.is_empty() { String::new() } else { format!(" ({})", repairs.join("; ")) }
}
