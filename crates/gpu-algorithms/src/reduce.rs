//! Combining all elements into one: `shaders/algorithms/reduce.wgsl`.

use crate::{blocks, one_group, per_block};
use pass::{Compute, OutputDesc, Request, ResourceDesc};

/// Returns the scratch memory for at most `length` elements. `bytes` is the size of `Reduced` in WGSL.
pub fn scratch(name: &str, length: u32, bytes: u64) -> OutputDesc {
    OutputDesc::scratch(name, ResourceDesc::buffer(bytes * u64::from(blocks(length))))
}

/// Returns the steps for at most `length` elements.
pub fn steps(shader: &Request, length: u32, scratch: &str) -> Vec<Compute> {
    let steps = [per_block(shader, "reduce_blocks", length), one_group(shader, "reduce_parts")];
    steps.into_iter().map(|step| step.bind("reduced_blocks", scratch)).collect()
}

/// Returns the step for a few elements, such as what workgroups of another shader have summed: one workgroup, whose
/// threads take every 256th element.
pub fn few(shader: &Request) -> Compute {
    one_group(shader, "reduce_few")
}
