//! The interfaces of the tree against their WGSL.

mod atlas;
mod depth_atlas;
mod structs;
