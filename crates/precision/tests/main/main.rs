//! Tests of the interpreter and of measuring; and that each probe of the shaders meets its bound in `f32`.

mod constructs;
mod functions;
mod measuring;
mod probes;

use shader_library::{DiskFiles, Library};
use std::sync::Arc;

/// The shaders of the tree; imports are looked for as the catalog does.
fn library() -> Library {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    let mut roots = vec!["shaders".to_owned()];
    let folders = std::fs::read_dir(format!("{root}/crates/interfaces")).unwrap().flatten();
    let folders = folders.filter(|entry| entry.file_type().is_ok_and(|file| file.is_dir()));
    roots.extend(folders.map(|entry| format!("crates/interfaces/{}", entry.file_name().display())));
    roots.push(String::new());
    Library::new(Arc::new(DiskFiles::new(root))).with_roots(roots)
}
