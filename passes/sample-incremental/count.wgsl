// Counts what the Voronoi cell of each light holds, when all lights have their places. [Laine et al. 2007]

#import "dispatch.wgsl"
#import "domain.wgsl"
#import "hear.wgsl"

struct Settings {
    count: u32,
    probes: u32,
}

/// A cell while it is counted.
struct CellSum {
    probes: atomic<u32>,
    shine: atomic<u32>,
}

var<uniform> settings: Settings;
/// [scratch, count: settings.count, cleared]
var<storage, read_write> cells: array<CellSum>;

@compute @workgroup_size(64)
fn count(row: Row) {
    let index = index_in(row, 64u);
    if index >= settings.count * settings.probes {
        return;
    }
    let share = shares[index / settings.probes];
    if share.source == NO_SOURCE {
        return;
    }
    hear(index, share);
    let owner = owners[index];
    if owner != NO_SLOT {
        let unit = f32(shine_unit(settings.count * settings.probes));
        let shine = shine_at(scene_lights.lights[share.source], probes[index].place);
        atomicAdd(&cells[owner].probes, 1u);
        atomicAdd(&cells[owner].shine, u32(shine * unit + 0.5));
    }
}
