// Moves the points that are taken, each with its origin, to where they follow each other; what is left stays empty.

#option TELL false // whether it is noted which points were taken
#option TIES false // whether points with the number 2 come behind all with the number 1

#import "algorithms/compact.wgsl"
#import "counters.wgsl"
#import "surface-points.wgsl"

struct Settings {
    points_count: u32,
    /// How many points are wanted.
    count: u32,
}

var<uniform> settings: Settings;
var<storage, read> points: SurfacePoints;
var<storage, read> origins: SurfacePoints;
/// [points] 0 for points that are not taken.
var<storage, read> taken: array<u32>;
var<storage, read_write> resampled: SurfacePoints;
var<storage, read_write> resampled_origins: SurfacePoints;
var<storage, read_write> counters: Counters;
#if TELL
var<storage, read_write> indices: array<u32>;
#endif

/// Makes all points empty.
@compute @workgroup_size(GROUP_SIZE)
fn clear_points(
    @builtin(workgroup_id) id: vec3<u32>,
    @builtin(num_workgroups) ids: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let i = row_index(id, ids, thread, GROUP_SIZE);
    if i >= settings.count {
        return;
    }
    resampled.points[i] = no_point();
    resampled_origins.points[i] = no_point();
    if i == 0u {
        resampled.header = SurfacePointsHeader(settings.count, points.header.iteration, 0u, 0u);
        resampled_origins.header = SurfacePointsHeader(settings.count, origins.header.iteration, 0u, 0u);
    }
}

fn scan_length() -> u32 {
#if TIES
    return 2u * settings.points_count;
#else
    return settings.points_count;
#endif
}

fn compact_keeps(i: u32) -> bool {
    return taken[i % settings.points_count] == 1u + i / settings.points_count;
}

fn compact_move(i: u32, place: u32) {
    if place < settings.count {
        resampled.points[place] = points.points[i % settings.points_count];
        resampled_origins.points[place] = origins.points[i % settings.points_count];
#if TELL
        indices[place] = i;
#endif
    }
}

fn compact_count(count: u32) {
    counters = Counters(settings.count, min(count, settings.count));
}
