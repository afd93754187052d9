//! Splits elements into parts.

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
