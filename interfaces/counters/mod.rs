//! How much a pass was requested to produce, and how much it produced.

use bytemuck::{Pod, Zeroable};
use pass::{Content, Interface, Member, OutputDesc, PassTypeError, Struct, UseContext};

const COUNTERS: Struct = Struct::new("interfaces/counters/counters.wgsl", "Counters");

/// The interface `Counters`.
pub const INTERFACE: Interface = Interface::new(
    "Counters",
    "How much a pass was requested to produce, and how much it produced within its bounds.",
    &[Member::required("", Content::Struct(COUNTERS), "both numbers")],
)
.with_folder("interfaces/counters");

/// `struct Counters` of counters.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct Counters {
    /// How many were requested.
    pub requested: u32,
    /// How many were produced.
    pub produced: u32,
}

impl Counters {
    /// Reads counters from the bytes of the buffer; `None` where there are too few.
    pub fn from_bytes(bytes: &[u8]) -> Option<Counters> {
        bytes.get(..size_of::<Counters>()).map(bytemuck::pod_read_unaligned)
    }
}

/// Describes an output of counters.
///
/// # Errors
/// Where counters.wgsl is refused.
pub fn output(cx: &UseContext<'_>, port: &str) -> Result<OutputDesc, PassTypeError> {
    Ok(OutputDesc::one(port, cx.buffer(COUNTERS, 1)?))
}
