// Visibility by a ray from the receiver to the virtual light: exact.

#import "ray-tracing.wgsl"
#import "virtual-lights.wgsl"

/// Part of a virtual light that is seen from a point: 0 behind the light's plane and where something is in between.
/// `at` [m] and the unit `normal` are the receiver's.
fn visibility(index: u32, light: VirtualLight, at: vec3<f32>, normal: vec3<f32>) -> f32 {
    let origin = offset_origin(at, normal);
    if light.kind == INFINITELY_FAR {
        return select(1.0, 0.0, occluded(origin, -light.normal, 0.0, FAR));
    }
    if dot(light.normal, at - light.position) <= 0.0 {
        return 0.0;
    }
    // Both ends lie on surfaces, and neither may stand in its own light.
    let goal = offset_origin(light.position, light.normal);
    return select(1.0, 0.0, occluded(origin, goal - origin, 0.0, 1.0));
}
