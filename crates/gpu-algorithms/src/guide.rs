//! Guides searches for triangles: `shaders/algorithms/guide.wgsl`.

use pass::{Compute, Request, Threads};

/// Returns the binary logarithm of the number of entries without the last, which is about the number of triangles: at least 1.
pub fn bits(triangles: u32) -> u32 {
    triangles.max(2).ilog2().min(20)
}

/// Returns the number of entries.
pub fn entries(triangles: u32) -> u32 {
    (1 << bits(triangles)) + 1
}

/// Returns the step that makes the table.
pub fn step(shader: Request, triangles: u32) -> Compute {
    Compute::new(shader, "guide", Threads::Row(entries(triangles)))
}
