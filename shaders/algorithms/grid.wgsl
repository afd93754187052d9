// Sorts elements into the cells of a grid, or of a hash table: `gpu_algorithms::Grid` dispatches it. Those of a cell keep
// their order.
//
// The shader that imports this file gives
//   fn grid_length() -> u32           how many elements
//   fn grid_cells() -> u32            how many cells
//   fn grid_cell(i: u32) -> u32       the cell of element i; at least `grid_cells()`: it is left out
//
// The elements of cell c are then those with the numbers `indices[starts[c]]` to `indices[starts[c + 1] - 1]`.

#import "algorithms/workgroup.wgsl"
#import "dispatch.wgsl"

/// [elements] Cells as keys of the sort; those left out come last.
var<storage, read_write> grid_keys: array<u32>;
/// [elements] The same, sorted.
var<storage, read> grid_sorted: array<u32>;
/// [cells + 1] Where the elements of each cell begin, and how many there are in all.
var<storage, read_write> grid_starts: array<u32>;

/// Gives each element its key. Beyond the last element keys are those of elements left out.
@compute @workgroup_size(GROUP_SIZE)
fn grid_make_keys(row: Row) {
    let i = index_in(row, GROUP_SIZE);
    if i >= arrayLength(&grid_keys) {
        return;
    }
    var cell = grid_cells();
    if i < grid_length() {
        cell = min(grid_cell(i), cell);
    }
    grid_keys[i] = cell;
}

/// Finds where each cell begins, one thread per cell.
@compute @workgroup_size(GROUP_SIZE)
fn grid_find_starts(row: Row) {
    let cell = index_in(row, GROUP_SIZE);
    if cell > grid_cells() {
        return;
    }
    var low = 0u;
    var high = grid_length();
    while low < high {
        let middle = low + (high - low) / 2u;
        if grid_sorted[middle] < cell {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    grid_starts[cell] = low;
}
