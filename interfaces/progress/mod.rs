//! Progress of a result that takes several frames.

use bytemuck::{Pod, Zeroable};
use pass::{Content, Extent, Interface, Member, PassTypeError, ResourceDesc, Struct, UseContext};

/// The struct, for interfaces that have it as a member.
pub const PROGRESS: Struct = Struct::new("interfaces/progress/progress.wgsl", "Progress");

/// The interface `Progress`.
pub const INTERFACE: Interface = Interface::new(
    "Progress",
    "How far a result is that is made in several frames: a pipeline that outputs one as `progress` has each of its \
     frames repeated until it is done.",
    &[Member::required("", Content::Struct(PROGRESS), "steps so far, and whether more are wanted")],
)
.with_folder("interfaces/progress");

/// `struct Progress` of progress.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Progress {
    /// Steps so far: samples, iterations, whatever the pass counts.
    pub step: u32,
    /// The greatest number of steps.
    pub steps: u32,
    /// Estimate of the remaining error, by the pass's own measure; 0 until there is one.
    pub error: f32,
    /// 1 when the result has converged and no more steps are needed.
    pub done: u32,
}

impl Progress {
    /// Returns whether the result has converged.
    pub fn is_done(&self) -> bool {
        self.done != 0
    }

    /// Reads the progress from the bytes of a buffer; `None` where their number is not its size.
    pub fn from_bytes(bytes: &[u8]) -> Option<Progress> {
        bytemuck::try_pod_read_unaligned(bytes).ok()
    }
}

/// Describes a buffer of a `struct Progress`.
///
/// # Errors
/// Where progress.wgsl is refused.
pub fn buffer(cx: &UseContext<'_>) -> Result<ResourceDesc<Extent>, PassTypeError> {
    cx.buffer(PROGRESS, 1)
}
