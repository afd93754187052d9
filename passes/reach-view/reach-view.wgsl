// Keeps the points on surfaces that points in view see.
//
// A point is asked whether it is seen by the point in view from which a ray came near it, and by a few others. That of the ray
// finds what few points see; the others what is seen widely, where neighbours of a point are hidden from the first.

#input points: SurfacePoints // The points to keep or not.
#input nearest: Owners // For each of them, from which point in view the ray came that met a surface nearest to it.
#input view: SurfacePoints // The points in view: the origins of these rays.
#output reached: SurfacePoints(count: points.count) // The points that are seen, in their places; others are empty.

#import "dispatch.wgsl"
#import "random.wgsl"
#import "ray-tracing.wgsl"
#import "surface-segment.wgsl"

struct Settings {
    points_count: u32,
    view_count: u32,
    /// Points in view that are asked beside that of the nearest hit. More: fewer points are lost that are seen, but more rays
    /// where points are hidden. [default: 3, min: 0, max: 64]
    tries: u32,
    seed: u32,
}

var<uniform> settings: Settings;
var<storage, read> points: SurfacePoints;
var<storage, read> nearest: array<u32>;
var<storage, read> view: SurfacePoints;
var<storage, read_write> reached: SurfacePoints;

/// The points in view that there are.
fn viewers() -> u32 {
    return min(view.header.count, settings.view_count);
}

fn is_seen_by(point: SurfacePoint, index: u32) -> bool {
    return index < viewers() && view.points[index].triangle != NO_TRIANGLE
        && see_each_other(point, view.points[index]);
}

fn is_seen(point: SurfacePoint, index: u32) -> bool {
    if is_seen_by(point, nearest[index]) {
        return true;
    }
    let key = hash2(settings.seed, point.seed);
    for (var i = 0u; i < settings.tries; i++) {
        if is_seen_by(point, hash2(key, i) % max(viewers(), 1u)) {
            return true;
        }
    }
    return false;
}

@compute @workgroup_size(64)
fn reach(row: Row) {
    let index = index_in(row, 64u);
    if index >= settings.points_count {
        return;
    }
    var point = no_point();
    if index < points.header.count {
        point = points.points[index];
    }
    if point.triangle != NO_TRIANGLE && !is_seen(point, index) {
        point = no_point();
    }
    reached.points[index] = point;
    if index == 0u {
        reached.header = points.header;
    }
}
