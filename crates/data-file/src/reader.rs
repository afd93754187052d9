//! Reads RON into a tree in which every key and value knows its place.
//!
//! The `ron` crate gives places for what it cannot read, but not for the values that it has read, and most
//! errors of a pipeline are in values that read well. It also stops at the first error; this reader goes on.
//! Other crates read their own files with it: see [`parse`].

mod fields;
mod lexer;
mod tree;

pub use fields::read_as;
pub use fields::{Fields, Reader, parse};
pub use lexer::skip_blanks;
pub use tree::{Field, Form, Node, Number, Word};
