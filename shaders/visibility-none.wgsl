// Visibility without occluders: every virtual light is seen from everywhere.

#import "virtual-lights.wgsl"

/// Part of a virtual light that is seen from a point: all of it.
fn visibility(index: u32, light: VirtualLight, at: vec3<f32>, normal: vec3<f32>) -> f32 {
    return 1.0;
}

/// The same, which takes no ray.
fn visibility_at_once(index: u32, light: VirtualLight, at: vec3<f32>, normal: vec3<f32>) -> f32 {
    return visibility(index, light, at, normal);
}
