//! What was asked for and could not all be made.

use crate::progress::word;

/// The struct Tally of shaders/tally.wgsl.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tally {
    /// How many were asked for.
    pub asked: u32,
    /// How many were made.
    pub made: u32,
}

impl Tally {
    /// The interface of ports that hold one.
    pub const INTERFACE: &str = "Tally";

    /// Reads it from the bytes of the buffer; `None` where they are too few.
    pub fn from_bytes(bytes: &[u8]) -> Option<Tally> {
        Some(Tally { asked: word(bytes, 0)?, made: word(bytes, 1)? })
    }
}
