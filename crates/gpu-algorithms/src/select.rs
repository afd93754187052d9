//! The element of a rank: `shaders/algorithms/select.wgsl`.

use crate::{one_group, per_block};
use pass::{Compute, OutputDesc, Request, ResourceDesc};

/// Bytes of `Selection`: three words and 256 counts.
const SELECTION_BYTES: u64 = 4 * (3 + 256);

/// Digits of a key, 8 bits each.
const DIGITS: usize = 4;

/// Returns the scratch memory, for any number of elements.
pub fn scratch(name: &str) -> OutputDesc {
    OutputDesc::scratch(name, ResourceDesc::buffer(SELECTION_BYTES))
}

/// Returns the steps for at most `length` elements.
pub fn steps(shader: &Request, length: u32, scratch: &str) -> Vec<Compute> {
    let digit = [per_block(shader, "select_count", length), one_group(shader, "select_narrow")];
    let digits = std::iter::repeat_n(digit, DIGITS).flatten();
    let steps = [one_group(shader, "select_begin")].into_iter().chain(digits);
    steps.map(|step| step.bind("selection", scratch)).collect()
}
