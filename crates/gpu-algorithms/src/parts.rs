//! Splits dispatches into parts.

/// The most loop iterations that a thread should execute in one dispatch. A driver treats a dispatch that runs for
/// seconds as a hang, and lavapipe silently ends all loops of a thread after 65,535 iterations.
pub const LOOP_ITERATIONS: u32 = 32_768;

/// The range of elements of one of several dispatches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// The first element.
    pub begin: u32,
    /// The end of the range, exclusive; `u32::MAX` for the last part, which takes all remaining elements.
    pub end: u32,
    /// Whether this is the last part.
    pub last: bool,
}

/// Returns the parts, at least one, of a dispatch over `length` elements, where each part has at most `most` of them.
pub fn parts(length: u32, most: u32) -> impl ExactSizeIterator<Item = Part> {
    let most = most.max(1);
    let count = length.div_ceil(most).max(1);
    (0..count).map(move |part| {
        let (begin, last) = (part * most, part + 1 == count);
        Part { begin, end: if last { u32::MAX } else { begin + most }, last }
    })
}
