// Visibility by a ray from the receiver to the virtual light: exact.

#import "light-ray.wgsl"

/// Part of a virtual light that is seen from a point: 0 behind the light's plane and where something is in between.
/// `at` [m] and the unit `normal` are the receiver's.
fn visibility(index: u32, light: VirtualLight, at: vec3<f32>, normal: vec3<f32>) -> f32 {
    if light.kind != INFINITELY_FAR && dot(light.normal, at - light.position) <= 0.0 {
        return 0.0;
    }
    return select(0.0, 1.0, is_free(light, at, normal, FAR));
}
