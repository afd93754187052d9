//! What was asked for and could not all be made.

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

    /// From the bytes of the buffer; `None` where they are too few.
    pub fn from_bytes(bytes: &[u8]) -> Option<Tally> {
        let word = |i: usize| Some(u32::from_le_bytes(bytes.get(4 * i..4 * i + 4)?.try_into().ok()?));
        Some(Tally { asked: word(0)?, made: word(1)? })
    }
}
