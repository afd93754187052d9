//! The crate as its users see it: files in, shaders or errors out.

mod composing;
mod decoding;
mod errors;
mod extremes;
mod layouts;
mod random;
mod reflecting;
mod settings;
mod thread_order;
mod watching;

use shader_library::{Library, MemoryFiles, Request, Shader};
use std::sync::Arc;

/// A library of these files, with imports also from `shaders`.
fn library(files: &[(&str, &str)]) -> Library {
    Library::new(Arc::new(MemoryFiles::new(files.iter().copied()))).with_roots(["", "shaders"])
}

/// The shader of one file without options.
fn shader(text: &str) -> Arc<Shader> {
    library(&[("main.wgsl", text)])
        .load(&Request::new("main.wgsl"))
        .unwrap_or_else(|errors| panic!("{errors}"))
}

/// The errors of one file, as shown.
fn errors_of(files: &[(&str, &str)], request: &Request) -> String {
    library(files).load(request).expect_err("this shader is broken").to_string()
}
