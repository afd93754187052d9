// Samples the surfaces that the camera sees, stratified over the image. [SMC-IR §3.2, Alg. 1]
//
// Points are where rays through places of the image meet the scene: line 3 of the algorithm.

#input past: SurfacePoints optional // Points whose iteration is the one before this: a link with `prev`. Without it, the
    // frame's number counts.
#input progress: Progress optional // How far the algorithm was in the frame before: a link with `prev`. With it, iterations that
    // no picture shows have a quarter of the points.
#output points: SurfacePoints(count: settings.count * settings.rate) // Points; empty where the camera sees nothing. The count in
    // their header is that of the iteration.

#option PAST false // whether there are points of the frame before
#option PROGRESS false // whether it is known how far the algorithm was

#import "camera.wgsl"
#import "dispatch.wgsl"
#if PROGRESS
#import "progress.wgsl"
#endif
#import "ray-tracing.wgsl"
#import "sobol.wgsl"
#import "surface-point.wgsl"
#if !PAST
#import "frame.wgsl"
#endif

struct Settings {
    points_count: u32,
    /// Number I of virtual lights that the points are for. More than 2,796,202 points in all require an adapter that binds
    /// buffers of more than 128 MiB. [default: 2048, min: 1, max: 2097152]
    count: u32,
    /// Points for each virtual light. More: candidates for lights are more uniform, and small parts of the image have points
    /// in each frame, but the time for rays and densities grows. [default: 16, min: 1, max: 4096]
    rate: u32,
    /// Whether each iteration has other points. [bool, default: true]
    vary: u32,
    seed: u32,
}

var<uniform> settings: Settings;
#if PAST
var<storage, read> past: SurfacePoints;
#endif
#if PROGRESS
var<storage, read> progress: Progress;
#endif
var<storage, read_write> points: SurfacePoints;

/// Points of a frame for each one of an iteration that no picture shows.
const SPARSE: u32 = 4u;

/// The number of iterations before this one.
fn iteration() -> u32 {
#if PAST
    // A history buffer that holds nothing yet has no points.
    return select(past.header.iteration + 1u, 0u, past.header.count == 0u);
#else
    return select(0u, frame.index, settings.vary != 0u);
#endif
}

/// The points of this iteration.
fn points_now() -> u32 {
#if PROGRESS
    // The last of the steps is that of a picture. Where there is no history yet, the number of steps is not known.
    if progress.step + 1u < progress.steps {
        return (settings.points_count + SPARSE - 1u) / SPARSE;
    }
#endif
    return settings.points_count;
}

/// The point that is seen at a place of the image [px].
fn point_at(place: vec2<f32>, seed: u32) -> SurfacePoint {
    // The ray has length 1 along the viewing axis, where the near plane is measured.
    let direction = view_ray(place);
    let hit = trace(camera.position, direction, camera.near, FAR);
    if hit.triangle == NO_HIT {
        return no_point();
    }
    return surface_point(hit.triangle, hit.barycentrics, direction, seed);
}

@compute @workgroup_size(64)
fn see(row: Row) {
    let index = index_in(row, 64u);
    if index >= settings.points_count {
        return;
    }
    let iteration = iteration();
    let seed = hash2(settings.seed, select(0u, iteration, settings.vary != 0u));
    let count = points_now();
    if index < count {
        let place = sobol2_of(index, seed) * camera.size;
        points.points[index] = point_at(place, hash2(seed, index));
    } else {
        points.points[index] = no_point();
    }
    if index == 0u {
        points.header = SurfacePointsHeader(count, iteration, 0u, 0u);
    }
}
