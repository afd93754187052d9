//! Grids.

use crate::bench::Bench;
use crate::{LENGTHS, cx, numbers};
use gpu_algorithms::{Grid, reference};

/// Where cells begin, and the elements of all cells.
fn grid(cell_of: &[u32], bound: u32, cells: u32) -> Option<(Vec<u32>, Vec<u32>)> {
    let shader = pass::request("crates/gpu-algorithms/tests/main/grid.wgsl", &[]);
    let grid = Grid { length: bound, cells, starts: "starts", indices: "indices", scratch: "grid" };
    let outputs = Bench::default()
        .input("count", &[cell_of.len() as u32, cells])
        .input("numbers", cell_of)
        .output("starts", grid.starts_bytes() as usize / 4)
        .output("indices", grid.indices_bytes() as usize / 4)
        .steps(grid.scratch(&cx()).unwrap(), grid.steps(&cx(), &shader).unwrap())
        .run()?;
    let mut starts: Vec<u32> = outputs.read("starts");
    // Small buffers are larger than requested.
    starts.truncate(cells as usize + 1);
    let mut indices: Vec<u32> = outputs.read("indices");
    indices.truncate(starts[cells as usize] as usize);
    Some((starts, indices))
}

#[test]
fn elements_lie_in_their_cells_in_order() {
    for length in LENGTHS {
        // One cell, a few, and more than elements. A seventh of the elements is in none.
        for cells in [1, 7, 70_000] {
            let cell_of = numbers(length, u64::from(cells) + u64::from(cells).div_ceil(6));
            let Some(found) = grid(&cell_of, length, cells) else { return };
            assert!(found == reference::grid(&cell_of, cells), "{length} elements in {cells} cells");
        }
    }
}

#[test]
fn fewer_elements_than_the_bound_are_sorted_alone() {
    for length in [0, 1, 2049] {
        let cell_of = numbers(length, 40);
        let Some(found) = grid(&cell_of, 10_000, 33) else { return };
        assert!(found == reference::grid(&cell_of, 33), "{length} elements");
    }
}
