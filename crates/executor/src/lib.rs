//! Runs the plans of the frame graph on wgpu.
//!
//! An [`Executor`] takes a plan whose steps are linked, creates the objects and pipelines that it lacks, and encodes
//! frames. It depends on no pass and on no scene: scene data is bound as [`SceneBinding`]s by name.

mod current;
mod error;
mod fill;
mod format;
mod gpu;
mod object;
mod pipeline;
mod readback;
mod run;
mod step;
mod stored;
mod timing;
mod uniforms;

pub use error::ExecutorError;
pub use format::texture_format;
pub use gpu::{Gpu, describe};
pub use object::{Object, ObjectUsage, SceneBinding};
pub use readback::map as map_buffer;
pub use run::{Executor, FrameOptions, FrameReport, LoadReport};
pub use step::Dispatch;
pub use timing::{Timings, milliseconds};

/// Waits for a future of wgpu's, which are done when they are made on native systems.
pub use pollster::block_on;
/// Re-export of wgpu, in the version of this crate's types.
pub use wgpu;
