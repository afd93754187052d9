//! Atlases, the interfaces, settings, and linking of what passes record.

mod atlas;
mod interfaces;
mod modules;
mod pass_types;
mod settings;
