//! Dispatches cut into parts.

/// Loop iterations that a thread should make at most in one dispatch. A driver takes a dispatch that goes on for seconds
/// for a hang, and lavapipe silently ends all loops of a thread after 65,535 iterations.
pub const LOOP_ITERATIONS: u32 = 32_768;

/// What one of several dispatches takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// The first element.
    pub begin: u32,
    /// Behind the last element; `u32::MAX` for the last part, which takes all that there are.
    pub end: u32,
    /// Whether it is the last part.
    pub last: bool,
}

/// Returns the parts, at least one, in which a dispatch takes `length` elements, when each takes `most` of them.
pub fn parts(length: u32, most: u32) -> impl ExactSizeIterator<Item = Part> {
    let most = most.max(1);
    let count = length.div_ceil(most).max(1);
    (0..count).map(move |part| {
        let (begin, last) = (part * most, part + 1 == count);
        Part { begin, end: if last { u32::MAX } else { begin + most }, last }
    })
}
