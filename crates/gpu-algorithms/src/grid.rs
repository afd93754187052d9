//! Sorts elements into cells: `shaders/algorithms/grid.wgsl`.

use crate::RadixSort;
use pass::{Compute, OutputDesc, PassTypeError, Request, ResourceDesc, Threads, UseContext};

/// The elements of a grid's cells, or of a hash table's: a table of where each cell begins, and the elements' numbers
/// cell after cell. Elements of a cell keep their order, so the result does not depend on the order of threads.
///
/// Buffers are named as `port` or `port.member`.
#[derive(Clone, Copy, Debug)]
pub struct Grid<'a> {
    /// The greatest number of elements, at most 2³¹.
    pub length: u32,
    /// The number of cells, which `grid_cells` of the shader returns; at most 2³¹.
    pub cells: u32,
    /// Name of the buffer with the begin of each cell, and the end of the last: [`Grid::starts_bytes`] bytes.
    pub starts: &'a str,
    /// Name of the buffer with the indices of the elements, cell after cell: [`Grid::indices_bytes`] bytes. Elements
    /// without a cell are at the end.
    pub indices: &'a str,
    /// Prefix of the names of the scratch memory.
    pub scratch: &'a str,
}

impl Grid<'_> {
    /// Returns the size of the buffer `starts`.
    pub fn starts_bytes(&self) -> u64 {
        4 * (u64::from(self.cells) + 1)
    }

    /// Returns the size of the buffer `indices`.
    pub fn indices_bytes(&self) -> u64 {
        4 * u64::from(self.length.max(1))
    }

    fn keys(&self) -> String {
        format!("{}_cells", self.scratch)
    }

    fn sort<'a>(&'a self, keys: &'a str) -> RadixSort<'a> {
        RadixSort {
            length: self.length,
            count: None,
            bits: u32::BITS - self.cells.leading_zeros(),
            keys,
            values: None,
            sorted_keys: keys,
            sorted_values: self.indices,
            scratch: self.scratch,
        }
    }

    /// Returns the scratch memory: 12 bytes per element, and little more.
    ///
    /// # Errors
    /// Where the WGSL of the algorithms is refused.
    pub fn scratch(&self, cx: &UseContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        let keys = self.keys();
        let mut scratch = self.sort(&keys).scratch(cx)?;
        scratch.push(OutputDesc::scratch(&keys, ResourceDesc::buffer(self.indices_bytes())));
        Ok(scratch)
    }

    /// Returns the steps, with a shader that imports `algorithms/grid.wgsl`.
    ///
    /// # Errors
    /// Where the WGSL of the algorithms is refused.
    pub fn steps(&self, cx: &UseContext<'_>, shader: &Request) -> Result<Vec<Compute>, PassTypeError> {
        let keys = self.keys();
        let make_keys = Compute::new(shader.clone(), "grid_make_keys", Threads::Row(self.length.max(1)));
        let find_starts = Compute::new(shader.clone(), "grid_find_starts", Threads::Row(self.cells + 1));
        let mut steps = vec![make_keys.bind("grid_keys", &keys)];
        steps.extend(self.sort(&keys).steps(cx)?);
        steps.push(find_starts.bind("grid_sorted", &keys).bind("grid_starts", self.starts));
        Ok(steps)
    }
}
