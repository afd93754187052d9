//! Errors of the GPU, with the pass and the bytes concerned.

use frame_graph::{Diagnostics, human_bytes};

/// An error of the executor.
#[derive(Clone, Debug, thiserror::Error)]
pub enum ExecutorError {
    /// No adapter was found.
    #[error(
        "no graphics adapter was found; on Debian or Ubuntu `apt-get install mesa-vulkan-drivers` gives one that runs on the CPU"
    )]
    NoAdapter,
    /// No adapter has the name or index.
    #[error("there is no adapter `{wanted}`; there are: {known}")]
    NoSuchAdapter {
        /// What was asked for.
        wanted: String,
        /// The adapters, with their indices.
        known: String,
    },
    /// The adapter could not create a device.
    #[error("the adapter {adapter} gave no device: {message}")]
    Device {
        /// The adapter's name.
        adapter: String,
        /// Its message.
        message: String,
    },
    /// A resource is larger than the adapter allows.
    #[error("{resource} needs {wanted}, and the adapter allows {allowed} ({limit}){from}")]
    Limit {
        /// `pass.port`
        resource: String,
        /// The requested size.
        wanted: String,
        /// The greatest size allowed.
        allowed: String,
        /// The limit's name in WebGPU.
        limit: &'static str,
        /// The reasons for the size, as a note on lines of its own: facts of the port and settings of the pass. Empty
        /// where nothing is known.
        from: String,
    },
    /// A plan needs more memory than the adapter has.
    #[error("the pipeline needs {}, and the adapter has {}; its largest resource, {largest}, needs {}", human_bytes(*.bytes), human_bytes(*.memory), human_bytes(*.most))]
    Memory {
        /// Bytes of all objects.
        bytes: u64,
        /// Bytes of the adapter.
        memory: u64,
        /// `pass.port` of the largest.
        largest: String,
        /// Its bytes.
        most: u64,
    },
    /// The device has no more memory.
    #[error("out of memory: {resource} needs {bytes} bytes, beside {held} bytes held already")]
    OutOfMemory {
        /// `pass.port`
        resource: String,
        /// Requested bytes.
        bytes: u64,
        /// Bytes held by the executor.
        held: u64,
    },
    /// The driver refused a pipeline or a command.
    #[error("in pass {pass}: {message}")]
    Pass {
        /// Name of the pass.
        pass: String,
        /// The message of the driver.
        message: String,
    },
    /// A shader uses ray queries, and the adapter has none.
    #[error(
        "pass {pass} uses ray queries, which {adapter} does not have; passes that trace rays do without where their setting `rays` is \"bvh\""
    )]
    NoRayQueries {
        /// Name of the pass.
        pass: String,
        /// The adapter's name.
        adapter: String,
    },
    /// A pass draws indirectly, and the adapter does not support a first instance in indirect draws.
    #[error("pass {pass} draws indirectly, for which {adapter} lacks the feature INDIRECT_FIRST_INSTANCE")]
    NoFirstInstance {
        /// Name of the pass.
        pass: String,
        /// The adapter's name.
        adapter: String,
    },
    /// A frame was requested, and no plan is loaded.
    #[error("no plan is loaded")]
    NotLoaded,
    /// A plan could not be loaded, nor could the one before be restored: no plan is loaded any more.
    #[error("{error}; the plan before could not be restored either: {again}; nothing is loaded now")]
    NothingLeft {
        /// Why the plan could not be loaded.
        error: Box<ExecutorError>,
        /// Why the one before could not be restored.
        again: Box<ExecutorError>,
    },
    /// The device is gone.
    #[error("the graphics device is gone: {message}")]
    Lost {
        /// Its message.
        message: String,
    },
    /// A shader or a binding is wrong.
    #[error("{0}")]
    Shader(Diagnostics),
    /// A resource cannot be read back.
    #[error("{resource} cannot be read back: {message}")]
    ReadBack {
        /// `pass.port`
        resource: String,
        /// Why.
        message: String,
    },
}
