// The points among which neighbours are searched, and the cells that they are sorted into.
//
// Lengths are in a unit near the scene's extent, so that their squares stay in range for scenes of any scale. It is a power of
// two times a metre: positions in it are exact, and so are differences of neighbours.

#import "algorithms/summary.wgsl"
#import "scene.wgsl"
#import "surface-points.wgsl"

/// Units in a metre.
fn units_per_metre() -> f32 {
    let exponent = i32(bitcast<u32>(scene_info.extent) >> 23u);
    let inverse = bitcast<f32>(u32(clamp(254 - exponent, 1, 253)) << 23u);
    return select(1.0, inverse, scene_info.extent > 0.0);
}

/// Cubes around all points.
struct Cells {
    low: vec3<f32>,
    /// Side of a cube [units].
    width: f32,
    /// The greatest index of a cube in each direction.
    last: vec3<u32>,
    /// Cubes in a unit.
    per_unit: f32,
}

/// At most `resolution` cubes in each direction.
fn cells_around(summary: Summary, resolution: u32) -> Cells {
    let size = summary.high - summary.low;
    let longest = max(size.x, max(size.y, size.z));
    // Points that are all in one place need no more than one.
    if summary.count == 0u || longest < 1e-10 {
        return Cells(summary.low, 1.0, vec3(0u), 1.0);
    }
    let per_unit = f32(resolution) / longest;
    return Cells(summary.low, longest / f32(resolution), min(vec3<u32>(size * per_unit), vec3(resolution - 1u)), per_unit);
}

/// The cube of a position, or the one nearest to it where it lies outside.
fn cell_at(cells: Cells, position: vec3<f32>) -> vec3<u32> {
    return vec3<u32>(clamp((position - cells.low) * cells.per_unit, vec3(0.0), vec3<f32>(cells.last)));
}

/// Index of a cube. Those of a row along x follow each other.
fn cell_index(cells: Cells, cell: vec3<u32>) -> u32 {
    let size = cells.last + 1u;
    return (cell.z * size.y + cell.y) * size.x + cell.x;
}
