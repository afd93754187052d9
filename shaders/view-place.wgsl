// The surfaces that pixels show, for passes that gather light there.

#import "surface-around.wgsl"

/// A pixel for which a thread gathers.
struct Place {
    pixel: vec2<u32>,
    /// Whether it is in the frame and something is seen there.
    seen: bool,
    at: vec3<f32>,
    normal: vec3<f32>,
    /// The normal of its plane.
    plane: vec3<f32>,
}

/// The place at a pixel of a view of `size` pixels; where that is outside of the frame, at the nearest inside.
fn place_at(pixel: vec2<u32>, size: vec2<u32>) -> Place {
    let inside = min(pixel, size - 1u);
    let depth = textureLoad(view_depth, inside, 0).x;
    let normal = normalize(textureLoad(view_normal, inside, 0).xyz);
    let at = camera.position + pixel_ray(vec2<f32>(inside), size) * depth;
    return Place(pixel, depth > 0.0 && all(pixel == inside), at, normal, plane_normal(inside, normal));
}
