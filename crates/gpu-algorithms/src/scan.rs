//! Prefix sums of whole numbers, `shaders/algorithms/scan.wgsl`, and compactions, `shaders/algorithms/compact.wgsl`.

use crate::{BLOCK_SIZE, blocks, one_group, per_block};
use pass::{Compute, OutputDesc, Request, ResourceDesc, Threads};

/// Returns the scratch memory for at most `length` elements, where there is more than one block of them.
pub fn scratch(name: &str, length: u32) -> Option<OutputDesc> {
    let words = u64::from(blocks(length)) * u64::from(BLOCK_SIZE + 1);
    (length > BLOCK_SIZE).then(|| OutputDesc::scratch(name, ResourceDesc::buffer(4 * words)))
}

/// Returns the steps for at most `length` elements.
pub fn steps(shader: &Request, length: u32, scratch: &str) -> Vec<Compute> {
    if length <= BLOCK_SIZE {
        return vec![one_group(shader, "scan_block")];
    }
    vec![
        per_block(shader, "scan_blocks", length).bind("scan_sums", scratch),
        one_group(shader, "scan_offsets").bind("scan_sums", scratch),
        Compute::new(shader.clone(), "scan_place", Threads::Row(length)).bind("scan_sums", scratch),
    ]
}
