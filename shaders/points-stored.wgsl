// Points that lie in a buffer. Map after map takes the next run of them, from the first again after the last: a fixed
// subset, and an even one. What is made of `settings` is said in surface-sample.wgsl.

#import "points.wgsl"
#import "scene.wgsl"
#import "surface-sample.wgsl"

var<storage, read> points: array<Point>;

/// How many samples there are to be, of all maps together: what the triangles ask for, or ANY_NUMBER.
fn samples_asked() -> u32 {
    return ANY_NUMBER;
}

/// Sample `index` of all maps' together. Neighbours are of one map.
fn surface_sample(index: u32) -> SurfaceSample {
    let point = points[index % settings.points_count];
    // All stand for the same area: what the scene has, shared out among those of one map.
    let area = scene_info.area / f32(settings.points_per_map);
    return SurfaceSample(point.position, index / settings.points_per_map, point.normal, area);
}
