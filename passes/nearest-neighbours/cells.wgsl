// Sorts points into cells, and puts the positions of those of a cell next to each other.
//
// DEVIATION(cells): the paper searches a bounding volume hierarchy.

#import "algorithms/grid.wgsl"
#import "neighbourhood.wgsl"

struct Settings {
    among_count: u32,
    /// The most cells in a direction.
    resolution: u32,
}

var<uniform> settings: Settings;
var<storage, read> among: SurfacePoints;
var<storage, read> summary: Summary;
/// Indices of points, cell after cell.
var<storage, read> order: array<u32>;
/// Position [units] as bits, and index.
var<storage, read_write> arranged: array<vec4<u32>>;

fn grid_length() -> u32 {
    return settings.among_count;
}

fn grid_cells() -> u32 {
    return settings.resolution * settings.resolution * settings.resolution;
}

/// Empty points are in no cell.
fn grid_cell(i: u32) -> u32 {
    let point = among.points[i];
    if i >= among.header.count || point.triangle == NO_TRIANGLE {
        return grid_cells();
    }
    let cells = cells_around(summary, settings.resolution);
    return cell_index(cells, cell_at(cells, point.position * units_per_metre()));
}

@compute @workgroup_size(GROUP_SIZE)
fn arrange(row: Row) {
    let place = index_in(row, GROUP_SIZE);
    // Empty points come last.
    if place >= summary.count {
        return;
    }
    let index = order[place];
    arranged[place] = vec4(bitcast<vec3<u32>>(among.points[index].position * units_per_metre()), index);
}
