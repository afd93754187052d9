// Traces a ray from each of a number of surface points to the point that it meets. [SMC-IR §3.2.1, Alg. 1]
//
// Line 5 of the algorithm.

#input points: SurfacePoints // The origins of the rays.
#output traced: SurfacePoints(count: points.count) // Their ends; empty where a ray meets nothing, and where none begins.

#option DIRECTIONS cosine one_of [cosine, uniform] // The distribution of directions of rays over the hemisphere about the
    // normal. cosine: in proportion to the cosine with it, as light counts. uniform: every solid angle alike, which finds more of
    // what is seen at grazing angles.

#import "dispatch.wgsl"
#import "hemisphere.wgsl"
#import "ray-tracing.wgsl"
#import "sobol.wgsl"
#import "surface-point.wgsl"
#import "tangent-frame.wgsl"

/// Separates these random numbers from those of the origins' places: where a run has the seed 0, so have all passes.
const DIRECTIONS: u32 = 0x7472u;

struct Settings {
    points_count: u32,
    seed: u32,
}

var<uniform> settings: Settings;
var<storage, read> points: SurfacePoints;
var<storage, read_write> traced: SurfacePoints;

/// A direction about the z axis, unit, from the unit square.
fn direction_of(square: vec2<f32>) -> vec3<f32> {
#if DIRECTIONS == cosine
    return by_cosine(square);
#else
    return direction_about_z(square.x, square.y);
#endif
}

/// The point that a ray from a point meets.
fn seen_from(point: SurfacePoint, square: vec2<f32>, seed: u32) -> SurfacePoint {
    if point.triangle == NO_TRIANGLE {
        return no_point();
    }
    let direction = frame_from_normal(point.normal) * direction_of(square);
    let hit = trace(offset_origin(point.position, point.normal), direction, 0.0, FAR);
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
    var seen = no_point();
    if index < points.header.count {
        let seed = hash2(hash2(settings.seed, DIRECTIONS), points.header.iteration);
        seen = seen_from(points.points[index], sobol2_of(index, seed), hash2(seed, index));
    }
    traced.points[index] = seen;
    if index == 0u {
        traced.header = points.header;
    }
}
