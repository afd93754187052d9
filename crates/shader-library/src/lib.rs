//! Loads WGSL from files, without a GPU: composes imports and variants, validates and reflects with naga, and reports
//! each error on the user's own line. This crate's README describes what is added to WGSL.
//!
//! ```text
//! Request ─compose─▶ text + line map ─naga─▶ module, bindings by name ─reflect─▶ Shader { ShaderInterface }
//! ```
//!
//! [`Library::load`] executes all stages and keeps the result; [`Watcher`] reports which files changed, and
//! [`Library::invalidate`] which requests they affect.

mod attributes;
pub mod codes;
mod compile;
mod compose;
mod composed;
pub mod decode;
mod directive;
mod doc_reader;
mod exact;
mod extent;
mod files;
mod interface;
mod layout;
mod library;
mod line_map;
mod port;
mod reflect;
mod scan;
mod settings;
mod shader;
mod thread_order;
mod watch;

pub use attributes::{
    Amount, Attributes, EntryAttributes, GlobalAttributes, KEYS as ATTRIBUTES, ThreadCount,
};
pub use composed::{AUTO, Outline, ShaderOption};
pub use directive::Define;
pub use exact::{DeclaredExact, ExactForm};
pub use files::{DiskFiles, MemoryFiles, Overlay, ShaderFiles, files_under};
pub use interface::{
    Access, Dimension, Entry, Global, GlobalKind, Location, Sample, ShaderInterface, Stage, TypeLayout,
};
pub use layout::{MemberLayout, StructLayout, WriteError, write_struct};
pub use library::{FileInfo, Library, MAX_VARIANTS, Request};
pub use port::{Argument, DeclaredPort, FormulaText};
pub use scan::{Item, declaration, declared, items};
pub use settings::setting_name;
pub use shader::Shader;
pub use watch::{WatchError, Watcher};

/// Re-export of naga, in the version of this crate's types.
pub use naga;
