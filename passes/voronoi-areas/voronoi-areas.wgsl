// Estimates how densely points lie on surfaces, by the area of their Voronoi cells.
//
// A sample of the surfaces adds the area that its own density leaves it to the nearest point. Areas are summed as integers of
// 64 bits, so that the order of threads changes nothing.

#input points: SurfacePoints // The points that have a density.
#input samples: SurfacePoints // Samples of the surfaces on which the points lie.
#input sample_density: Density // The density of the samples.
#input owners: Owners // The point that is nearest to each of them.
#input past: Areas optional // `areas` of the frame before: with it, areas are averaged over frames.
#output density: Density(count: points.count) // Density of each point; 0 where that is empty.
#output areas: Areas(count: points.count) // The area of each point, for the next frame.

#option PAST false // whether there are areas of the frame before

#import "areas.wgsl"
#import "algorithms/scaled.wgsl"
#import "dispatch.wgsl"
#import "scene.wgsl"
#import "surface-points.wgsl"

struct Settings {
    points_count: u32,
    samples_count: u32,
    /// The most frames that an area is the mean of. More: areas are smoother, but follow later where points come and go around,
    /// and where others are seen. [default: 32, min: 1, max: 4096]
    frames: u32,
}

/// The numbers of points and samples that are not empty.
struct Present {
    points: u32,
    samples: u32,
}

var<uniform> settings: Settings;
var<storage, read> points: SurfacePoints;
var<storage, read> samples: SurfacePoints;
/// [1/m²]
var<storage, read> sample_density: array<f32>;
/// The point nearest to each sample.
var<storage, read> owners: array<u32>;
#if PAST
var<storage, read> past: PointAreas;
#endif
/// Their numbers. [scratch]
var<storage, read_write> present: Present;
/// Area of each point in 2⁻¹⁶ of the scene's: whole, and the fraction in 2⁻³². [scratch, count: points.count, cleared]
var<storage, read_write> sums: array<array<atomic<u32>, 2>>;
var<storage, read_write> areas: PointAreas;
var<storage, read_write> density: array<f32>;

/// Units of `sums` in the area of the scene.
const UNITS: f32 = 65536.0;

fn is_sample(index: u32) -> bool {
    return index < samples.header.count && samples.points[index].triangle != NO_TRIANGLE && sample_density[index] > 0.0;
}

fn is_point(index: u32) -> bool {
    return index < points.header.count && points.points[index].triangle != NO_TRIANGLE;
}

/// Counts points and samples, in one workgroup. [threads: 1]
@compute @workgroup_size(GROUP_SIZE)
fn count(@builtin(local_invocation_index) thread: u32) {
    var here = vec2(0u);
    for (var i = thread; i < settings.points_count; i += GROUP_SIZE) {
        here.x += select(0u, 1u, is_point(i));
    }
    for (var i = thread; i < settings.samples_count; i += GROUP_SIZE) {
        here.y += select(0u, 1u, is_sample(i));
    }
    let all = vec2(prefix_sum_u32(thread, here.x).y, prefix_sum_u32(thread, here.y).y);
    if thread == 0u {
        present = Present(all.x, all.y);
    }
}

/// Adds the area of each sample to its point. [threads: samples.count]
@compute @workgroup_size(64)
fn share(row: Row) {
    let index = index_in(row, 64u);
    if index >= settings.samples_count || !is_sample(index) {
        return;
    }
    let owner = owners[index];
    if owner >= settings.points_count {
        return;
    }
    // A share of the scene's area; no sample stands for more than all of it.
    let share = 1.0 / max(f32(present.samples) * sample_density[index] * scene_info.area, 1.0);
    let whole = floor(share * UNITS);
    let fraction = u32((share * UNITS - whole) * 4294967296.0);
    let before = atomicAdd(&sums[owner][1], fraction);
    // What the fraction carries over.
    atomicAdd(&sums[owner][0], u32(whole) + select(0u, 1u, before + fraction < before));
}

/// The area of a point [m²] by the samples of this frame.
fn area_of(index: u32) -> f32 {
    let whole = f32(atomicLoad(&sums[index][0]));
    let fraction = f32(atomicLoad(&sums[index][1])) * 0x1p-32f;
    return weight_of((whole + fraction) / UNITS * scene_info.area);
}

/// Averages areas over the frames that their points have been there. [threads: points.count]
@compute @workgroup_size(64)
fn average(row: Row) {
    let index = index_in(row, 64u);
    if index >= settings.points_count {
        return;
    }
    var own = PointArea(0u, 0u, 0.0, 0u);
    var dense = 0.0;
    if is_point(index) {
        own = PointArea(points.points[index].seed, 1u, area_of(index), 0u);
#if PAST
        if index < arrayLength(&past.areas) && past.areas[index].frames > 0u && past.areas[index].seed == own.seed {
            let before = past.areas[index];
            own.frames = min(before.frames + 1u, settings.frames);
            own.area = mix(before.area, own.area, 1.0 / f32(own.frames));
        }
#endif
        // A point without samples stands for nothing: its density is as great as can be.
        dense = 1.0 / max(f32(present.points) * own.area, 1e-37);
    }
    areas.areas[index] = own;
    density[index] = dense;
}
