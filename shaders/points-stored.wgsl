// Points that are stored in a buffer. Each map takes the next run of them, and starts again at the first after the
// last: a fixed subset, and a uniform one. So does each turn.

#import "points.wgsl"
#import "scene.wgsl"
#import "surface-sample.wgsl"

struct PointsFacts {
    /// The number of different points.
    count: u32,
}

var<uniform> points_facts: PointsFacts;
var<storage, read> points: array<Point>;

/// Returns the number of samples to generate for all maps together: the triangles' sum, or ANY_NUMBER.
fn samples_requested() -> u32 {
    return ANY_NUMBER;
}

/// Sample `index` of those of all maps. Neighbours belong to the same map.
fn surface_sample(wanted: SamplesWanted, index: u32) -> SurfaceSample {
    let number = index + wanted.turn * wanted.maps * wanted.per_map;
    let point = points[number % points_facts.count];
    // Each stands for the same area: the area of the scene over the number of samples of one map. Where the surface is cut
    // out, there is none.
    let area = select(scene_info.area / f32(wanted.per_map), 0.0, all(point.normal == vec3(0.0)));
    return SurfaceSample(point.position, index / wanted.per_map, point.normal, area, point.triangle, 0u, 0u, 0u);
}
