// Numbers that are the cells of their elements.

#import "algorithms/grid.wgsl"

/// Length and cells.
var<storage, read> count: array<u32>;
var<storage, read> numbers: array<u32>;

fn grid_length() -> u32 {
    return count[0];
}

fn grid_cells() -> u32 {
    return count[1];
}

fn grid_cell(i: u32) -> u32 {
    return numbers[i];
}
