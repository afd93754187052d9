//! The interfaces, and linking of what passes record.

mod interfaces;
mod modules;
