//! Settings, and linking of what passes record.

mod modules;
mod pass_types;
mod settings;
