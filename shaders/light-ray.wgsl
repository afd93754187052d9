// Rays from receivers to virtual lights.

#import "ray-tracing.wgsl"
#import "virtual-lights.wgsl"

/// Whether nothing is between a receiver and a light, within `reach` [m] of the receiver; FAR is the whole way. `at` [m] and the
/// unit `normal` are the receiver's, which is in front of the light.
fn is_free(light: VirtualLight, at: vec3<f32>, normal: vec3<f32>, reach: f32) -> bool {
    let origin = offset_origin(at, normal);
    if light.kind == INFINITELY_FAR {
        return !occluded(origin, -light.normal, 0.0, reach);
    }
    // Both ends lie on surfaces, and neither may stand in its own light.
    let way = offset_origin(light.position, light.normal) - origin;
    return !occluded(origin, way, 0.0, min(reach / length(way), 1.0));
}
