//! Progress of a result that takes several frames.

use pass::{Content, Extent, Interface, Member, PassTypeError, ResourceDesc, Struct, UseContext};

/// The struct, for interfaces that have it as a member.
pub const PROGRESS: Struct = Struct::new("crates/interfaces/progress/progress.wgsl", "Progress");

/// The interface `Progress`.
pub const INTERFACE: Interface = Interface::new(
    "Progress",
    "How far a result is that is made in several frames: a pipeline that outputs one as `progress` has each of its \
     frames repeated until it is done.",
    &[Member::required("", Content::Struct(PROGRESS), "steps so far, and whether more are wanted")],
)
.with_folder("crates/interfaces/progress");

wgsl_structs::wgsl! {
    "progress/progress.wgsl" {
        pub struct Progress;
    }
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
