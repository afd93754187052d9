//! The commands, a module each.

pub(crate) mod bench;
pub(crate) mod blame;
pub(crate) mod cases;
pub(crate) mod check;
pub(crate) mod compare;
pub(crate) mod completions;
pub(crate) mod diff;
pub(crate) mod fmt;
pub(crate) mod graph;
pub(crate) mod interfaces;
pub(crate) mod judge;
pub(crate) mod lists;
pub(crate) mod lsp;
pub(crate) mod new;
pub(crate) mod passes;
pub(crate) mod precision;
pub(crate) mod render;
pub(crate) mod reproduce;
pub(crate) mod rerun;
pub(crate) mod resolve;
pub(crate) mod stress;
pub(crate) mod study;
pub(crate) mod tune;
#[cfg(feature = "window")]
pub(crate) mod view;
