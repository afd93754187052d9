//! Splits dispatches into parts.

use pass::Compute;

wgsl_structs::wgsl! {
    "../../shaders/dispatch.wgsl" {
        pub const LOOP_ITERATIONS;
    }
}

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

/// Returns how many dispatches [`split`] makes.
pub fn split_count(elements: u32, iterations: u32) -> u32 {
    parts_of_loop(elements, iterations).len() as u32
}

/// Splits a dispatch whose threads loop over `elements`, each of which takes this many loop iterations, so that no driver
/// ends the loops. Each part has the values `begin`, `end` and `last` (1 for the last part) for members of `settings`.
pub fn split(step: Compute, elements: u32, iterations: u32) -> impl ExactSizeIterator<Item = Compute> {
    parts_of_loop(elements, iterations).map(move |part| {
        let step = step.clone().value("begin", part.begin).value("end", part.end);
        step.value("last", u32::from(part.last))
    })
}

fn parts_of_loop(elements: u32, iterations: u32) -> impl ExactSizeIterator<Item = Part> {
    parts(elements, LOOP_ITERATIONS / iterations.max(1))
}
