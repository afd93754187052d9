//! Combines all elements into one: `shaders/algorithms/reduce.wgsl`.

use crate::{Blocks, one_group};
use pass::{Compute, OutputDesc, PassTypeError, Request, ResourceDesc, UseContext};

/// Returns the scratch memory for at most `length` elements. `bytes` is the size of `Reduced` in WGSL.
///
/// # Errors
/// Where the WGSL of the algorithms is refused.
pub fn scratch(
    cx: &UseContext<'_>,
    name: &str,
    length: u32,
    bytes: u64,
) -> Result<OutputDesc, PassTypeError> {
    let blocks = u64::from(Blocks::of(cx)?.count(length));
    Ok(OutputDesc::scratch(name, ResourceDesc::buffer(bytes * blocks)))
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
    let steps = [blocks.dispatch(shader, "reduce_blocks", length), one_group(shader, "reduce_parts")];
    Ok(steps.into_iter().map(|step| step.bind("reduced_blocks", scratch)).collect())
}

/// Returns the step for a few elements, such as the sums of workgroups of another shader: one workgroup, whose
/// threads take every 256th element.
pub fn few(shader: &Request) -> Compute {
    one_group(shader, "reduce_few")
}
