//! A language server for pipelines, scenes, studies and their WGSL.
//!
//! It is a layer over the front end, without a GPU: what names mean is found by `frame-graph`, `catalog` and
//! `shader-library`, and what is wrong by the check that the caller gives. Files that are open in the editor lie over
//! those on disk ([`catalog::Assets::set_open`]). Questions are answered by one thread; another checks the open files.

mod completion;
mod diagnostics;
mod info;
mod offer;
mod pipelines;
mod server;
mod studies;
mod text;
mod wgsl;
mod workspace;

pub use server::{begin, serve};
pub use wgsl::check as check_wgsl;
pub use workspace::Language;

use data_file::Diagnostic;

/// Returns all that is wrong with the file of a name.
pub type Check = dyn Fn(&str, Language) -> Vec<Diagnostic> + Send + Sync;
