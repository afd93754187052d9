//! Reads data files in RON into types that serde derives, with the place of every value, and reports what is wrong with
//! them.
//!
//! Pipelines, scenes and studies are read by [`grammar`], and their errors have one form: a stable code (see
//! [`codes`](mod@codes)), the file, line and column, the text with a caret, what was expected, and the nearest known name.
//! The types of each grammar are in the crate that owns the files.

pub mod codes;
pub mod diagnostic;
mod excerpt;
mod files;
pub mod grammar;
pub mod paths;
pub mod value;

pub use codes::Code;
pub use diagnostic::{
    Diagnostic, Diagnostics, Label, Place, Severity, Source, Sources, Span, nearest, nearest_of_few, visible,
};
pub use files::{Files, MAX_TEXT, read_text, read_text_bytes, why_unreadable};
/// A name of a pass, a port, an interface or a member: text that is cheap to copy.
pub use smol_str::SmolStr as Name;
pub use value::{LightSource, Misfit, Setting, Settings, Traits, Value, ValueType};
