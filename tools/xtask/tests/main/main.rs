//! Tests of the chores, on trees of a few files.

mod features;
mod mutate_shaders;
mod new_pass;
mod packages;
mod tidy;

use std::path::Path;
use tempfile::TempDir;

/// A tree of these files.
fn tree(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (path, text) in files {
        write(folder.path(), path, text);
    }
    folder
}

fn write(root: &Path, path: &str, text: &str) {
    let path = root.join(path);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, text).unwrap();
}
