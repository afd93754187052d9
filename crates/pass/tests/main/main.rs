//! Atlases, the interfaces, and linking of what passes record.

mod atlas;
mod interfaces;
mod modules;
