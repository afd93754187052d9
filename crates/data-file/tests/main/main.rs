//! The crate as those who read files with it see it.

mod codes;
mod extremes;
mod paths;
mod settings;
mod terminal;
