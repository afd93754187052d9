//! Chores of the tree, each a command of `cargo xtask`.

pub mod bless;
pub mod cargo;
pub mod demo;
pub mod docs;
pub mod gpu;
pub mod mutate_shaders;
pub mod new_pass;
pub mod optional;
pub mod packages;
pub mod release;
pub mod semver;
pub mod test;
pub mod test_programs;
pub mod tidy;
pub mod tree;
