//! How far a result is that is made in several frames.

/// The struct Progress of shaders/progress.wgsl.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Steps so far: samples, iterations, whatever the pipeline counts.
    pub step: u32,
    /// The most steps there will be.
    pub steps: u32,
    /// Estimate of what is still wrong, by the pipeline's own measure; 0 until there is one.
    pub error: f32,
    /// Whether no more steps are wanted.
    pub done: bool,
}

impl Progress {
    /// Reads the bytes of the buffer; `None` where they are too few.
    pub fn from_bytes(bytes: &[u8]) -> Option<Progress> {
        Some(Progress {
            step: word(bytes, 0)?,
            steps: word(bytes, 1)?,
            error: f32::from_bits(word(bytes, 2)?),
            done: word(bytes, 3)? != 0,
        })
    }
}

/// Number `i` of the `u32` in a buffer; `None` beyond its end.
pub(crate) fn word(bytes: &[u8], i: usize) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(4 * i..4 * i + 4)?.try_into().ok()?))
}
