//! The algorithms against their CPU references: no elements, one, 2ⁿ ± 1, within a block and across many.

mod bench;
mod curves;
mod parts;
mod reductions;
mod scans;
mod selection;
mod sorts;
mod workgroups;

use pass::UseContext;
use pass_test::random::hash2;

/// A use of a pass, for the layouts of the shaders.
fn cx() -> UseContext<'static> {
    pass_test::use_context()
}

/// Numbers of elements: around powers of two, within a thread, a workgroup and a block, and of many blocks.
const LENGTHS: [u32; 20] = [
    0, 1, 2, 7, 8, 9, 31, 33, 255, 256, 257, 2047, 2048, 2049, 16_383, 16_385, 65_537, 131_071, 131_072,
    131_073,
];

/// More blocks than a workgroup has threads.
const MANY: u32 = (1 << 19) + 1;

/// Returns random numbers below `bound`.
fn numbers(length: u32, bound: u64) -> Vec<u32> {
    (0..length).map(|i| ((u64::from(hash2(length, i)) * bound) >> 32) as u32).collect()
}
