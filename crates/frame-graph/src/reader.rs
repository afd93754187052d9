//! Reads RON into a tree in which every key and value knows its place.
//!
//! The `ron` crate gives places for what it cannot read, but not for the values that it has read, and most
//! errors of a pipeline are in values that read well. It also stops at the first error; this reader goes on.

mod lexer;
mod tree;

pub(crate) use tree::{Field, Form, Node, Number, read};
