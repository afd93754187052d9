//! Settings, and linking of what passes record.

mod contents;
mod declared;
mod facts;
mod modules;
mod pass_types;
mod settings;
mod user_shaders;
