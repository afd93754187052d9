//! The catalog: the one ordered list of passes, from which the command line, the documentation and the checks
//! derive; and the files that the program carries with it.

mod assets;
mod listing;
mod pass_types;
mod reference;
mod sort;

pub use assets::{Assets, PipelineFiles, SceneAssets, ShaderAssets};
pub use listing::Named;
pub use pass_types::Catalog;
pub use reference::{Port, SharedFile};
pub use sort::Sort;

include!(concat!(env!("OUT_DIR"), "/catalog.rs"));
