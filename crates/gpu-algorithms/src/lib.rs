//! Reductions, scans, compactions, sorts and selection, as steps for passes.
//!
//! The WGSL is in `shaders/algorithms/`. A pass has its own shader, which imports one of these files and defines the
//! functions that the file calls: how many elements there are, the value of each, and what happens with the results. So
//! an algorithm can read textures, structs or numbers that are never stored. The functions of this crate return the
//! dispatches of that shader, in order, and the scratch memory that they need:
//!
//! | | the shader imports | scratch | steps |
//! |---|---|---|---|
//! | combine all elements into one | `algorithms/reduce.wgsl`, `sum-f32.wgsl`, `sum-vec4.wgsl`, `sum-scaled.wgsl`, `summarize.wgsl` | [`reduce::scratch`] | [`reduce::steps`] |
//! | prefix sums of integers | `algorithms/scan.wgsl` | [`scan::scratch`] | [`scan::steps`] |
//! | keep some elements | `algorithms/compact.wgsl` | [`scan::scratch`] | [`scan::steps`] |
//! | prefix sums of weights, by segments | `algorithms/segmented-scan.wgsl` | | [`segmented_scan`] |
//! | the element of a rank | `algorithms/select.wgsl` | [`select::scratch`] | [`select::steps`] |
//! | sort keys and values | (none) | [`RadixSort::scratch`] | [`RadixSort::steps`] |
//!
//! All of them compute the same bits in every run: sums of floating-point numbers have one order, and atomic operations
//! are on integers alone. No workgroup waits for another. Lengths are upper bounds: a shader may read the true one from
//! a buffer. Zero elements are allowed everywhere, and at most 2³¹. Sizes of workgroups and of structs are those of the
//! WGSL, so every function that depends on them fails where the WGSL is refused.
//!
//! ```no_run
//! # fn record(cx: &pass::RecordContext<'_>, count: u32) -> Result<pass::Recording, pass::PassTypeError> {
//! use gpu_algorithms::scan;
//! let shader = cx.shader("passes/my-pass/offsets.wgsl", &[]);
//! Ok(pass::Recording::of(scan::steps(&cx.use_context(), &shader, count, "offsets_sums")?))
//! # }
//! ```

mod parts;
mod radix_sort;
pub mod reduce;
pub mod reference;
pub mod scan;
pub mod select;

pub use parts::{Part, parts};
pub use radix_sort::RadixSort;

use pass::{Compute, PassTypeError, Request, Threads, UseContext};

/// The share of elements of a workgroup: the constants of `shaders/algorithms/workgroup.wgsl`.
#[derive(Clone, Copy)]
struct Blocks {
    /// Threads of a workgroup.
    group: u32,
    /// Elements of a workgroup.
    elements: u32,
}

impl Blocks {
    fn of(cx: &UseContext<'_>) -> Result<Blocks, PassTypeError> {
        let constant = |name| cx.constant("shaders/algorithms/workgroup.wgsl", name);
        Ok(Blocks { group: constant("GROUP_SIZE")?, elements: constant("BLOCK_SIZE")? })
    }

    /// The number of blocks for this many elements, at least one.
    fn count(self, length: u32) -> u32 {
        length.div_ceil(self.elements).max(1)
    }

    /// A dispatch of a workgroup for each block.
    fn dispatch(self, shader: &Request, entry: &str, length: u32) -> Compute {
        Compute::new(shader.clone(), entry, Threads::Row(self.group * self.count(length)))
    }
}

/// Returns a dispatch of one workgroup.
fn one_group(shader: &Request, entry: &str) -> Compute {
    Compute::new(shader.clone(), entry, Threads::Row(1))
}

/// Returns the scan of segments of equal length, with one workgroup for each: `rows` times `layers` segments, whose
/// number the shader gets as `segment.y` and `segment.z`. At most 65,535 of each.
pub fn segmented_scan(shader: &Request, rows: u32, layers: u32) -> Compute {
    Compute::new(shader.clone(), "scan_segments", Threads::Grid([1, rows, layers]))
}
