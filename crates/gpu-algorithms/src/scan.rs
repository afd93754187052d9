//! Prefix sums of integers, `shaders/algorithms/scan.wgsl`, and compactions, `shaders/algorithms/compact.wgsl`.

use crate::{Blocks, one_group};
use pass::{Compute, OutputDesc, PassTypeError, Request, ResourceDesc, Threads, UseContext};

/// Returns the scratch memory for at most `length` elements, where there is more than one block of them.
///
/// # Errors
/// Where the WGSL of the algorithms is refused.
pub fn scratch(cx: &UseContext<'_>, name: &str, length: u32) -> Result<Option<OutputDesc>, PassTypeError> {
    let blocks = Blocks::of(cx)?;
    let words = u64::from(blocks.count(length)) * u64::from(blocks.elements + 1);
    Ok((length > blocks.elements).then(|| OutputDesc::scratch(name, ResourceDesc::buffer(4 * words))))
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
    if length <= blocks.elements {
        return Ok(vec![one_group(shader, "scan_block")]);
    }
    Ok(vec![
        blocks.dispatch(shader, "scan_blocks", length).bind("scan_sums", scratch),
        one_group(shader, "scan_offsets").bind("scan_sums", scratch),
        Compute::new(shader.clone(), "scan_place", Threads::Row(length)).bind("scan_sums", scratch),
    ])
}
