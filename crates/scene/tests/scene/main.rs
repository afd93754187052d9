//! Tests of scenes: what loads, what moves, what is refused and how.

mod broken;
mod built_in;
mod camera_and_light;
mod cloth;
mod common;
mod deformation;
mod dense;
mod description;
mod editing;
mod environment;
mod export;
mod extremes;
mod far;
mod gltf;
mod movement;
mod offline;
mod offline_errors;
mod offline_table;
mod picking;
mod references;
mod sampling;
mod skins;
mod walks;
