//! Errors of the renderer.

use executor::ExecutorError;
use frame_graph::Diagnostics;
use scene::SceneError;

/// An error of the renderer.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The pipeline or a shader is wrong.
    #[error("{0}")]
    Pipeline(#[from] Diagnostics),
    /// The scene cannot be loaded.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The GPU or the driver reported an error.
    #[error(transparent)]
    Gpu(#[from] ExecutorError),
    /// The pipeline has no output of that name.
    #[error("the pipeline `{pipeline}` has no output `{output}`; {has}")]
    NoOutput {
        /// The pipeline.
        pipeline: String,
        /// The requested name.
        output: String,
        /// The nearest output, or all that the pipeline has.
        has: String,
    },
    /// The resource cannot be shown as a picture.
    #[error("`{resource}` is {what}, which is no picture")]
    NoPicture {
        /// `pass.port`
        resource: String,
        /// Its description.
        what: String,
    },
    /// The output `progress` is no buffer of a `struct Progress`.
    #[error(
        "the output `progress` is `{resource}`, of {bytes} bytes; expected 16: struct Progress of crates/interfaces/progress"
    )]
    NoProgress {
        /// `pass.port`
        resource: String,
        /// Its size.
        bytes: usize,
    },
    /// No pipeline is set.
    #[error("no pipeline is set")]
    NoPipeline,
}
