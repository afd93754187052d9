// Points that lie in a buffer. Map after map takes the next run of them, from the first again after the last: a fixed
// subset, and an even one.

#import "points.wgsl"
#import "scene.wgsl"
#import "surface-sample.wgsl"

struct PointsFacts {
    /// How many different points there are.
    count: u32,
}

var<uniform> points_facts: PointsFacts;
var<storage, read> points: array<Point>;

/// How many samples there are to be, of all maps together: what the triangles ask for, or ANY_NUMBER.
fn samples_requested() -> u32 {
    return ANY_NUMBER;
}

/// Sample `index` of all maps' together. Neighbours are of one map.
fn surface_sample(wanted: SamplesWanted, index: u32) -> SurfaceSample {
    let point = points[index % points_facts.count];
    // All stand for the same area: what the scene has, shared out among those of one map.
    let area = scene_info.area / f32(wanted.per_map);
    return SurfaceSample(point.position, index / wanted.per_map, point.normal, area);
}
