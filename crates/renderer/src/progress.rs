//! How far a progressive picture is.

/// The struct Progress of shaders/path-progress.wgsl.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Samples a pixel so far.
    pub samples: u32,
    /// Estimate of the picture's own relMSE; 0 before two samples.
    pub error: f32,
    /// Whether no more samples are wanted.
    pub done: bool,
    /// The most samples there will be.
    pub limit: u32,
}

impl Progress {
    /// From the bytes of the buffer; `None` where they are too few.
    pub fn from_bytes(bytes: &[u8]) -> Option<Progress> {
        Some(Progress {
            samples: word(bytes, 0)?,
            error: f32::from_bits(word(bytes, 1)?),
            done: word(bytes, 2)? != 0,
            limit: word(bytes, 3)?,
        })
    }
}

/// Number `i` of the `u32` in a buffer; `None` beyond its end.
pub(crate) fn word(bytes: &[u8], i: usize) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(4 * i..4 * i + 4)?.try_into().ok()?))
}
