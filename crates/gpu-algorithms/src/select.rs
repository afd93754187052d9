//! Finds the element of a rank: `shaders/algorithms/select.wgsl`.

use crate::{Blocks, one_group};
use pass::{Compute, OutputDesc, PassTypeError, Request, Struct, UseContext};

const SELECTION: Struct = Struct::new("shaders/algorithms/selection.wgsl", "Selection");

/// Returns the scratch memory, for any number of elements.
///
/// # Errors
/// Where the WGSL of the algorithms is refused.
pub fn scratch(cx: &UseContext<'_>, name: &str) -> Result<OutputDesc, PassTypeError> {
    Ok(OutputDesc::scratch(name, cx.buffer(SELECTION, 1)?))
}

/// Returns the steps for at most `length` elements.
///
/// # Errors
/// Where the WGSL of the algorithms is refused.
pub fn steps(
    cx: &UseContext<'_>,
    shader: &Request,
    length: u32,
    scratch: &str,
) -> Result<Vec<Compute>, PassTypeError> {
    let blocks = Blocks::of(cx)?;
    let bits_of_digit = cx.constant(SELECTION.file, "SELECT_DIGITS")?.ilog2();
    let digit = [blocks.dispatch(shader, "select_count", length), one_group(shader, "select_narrow")];
    let digits = std::iter::repeat_n(digit, u32::BITS.div_ceil(bits_of_digit) as usize).flatten();
    let steps = [one_group(shader, "select_begin")].into_iter().chain(digits);
    Ok(steps.map(|step| step.bind("selection", scratch)).collect())
}
