//! What a pass was requested to produce, and what it produced.

use crate::progress::word;

/// The struct Counters of shaders/counters.wgsl.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counters {
    /// How many were requested.
    pub requested: u32,
    /// How many were produced.
    pub produced: u32,
}

impl Counters {
    /// The interface of ports that hold counters.
    pub const INTERFACE: &str = "Counters";

    /// Reads counters from the bytes of the buffer; `None` where there are too few.
    pub fn from_bytes(bytes: &[u8]) -> Option<Counters> {
        Some(Counters { requested: word(bytes, 0)?, produced: word(bytes, 1)? })
    }
}
