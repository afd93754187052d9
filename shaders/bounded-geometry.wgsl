// The geometry term of a light on a surface, which grows without bound near the light unless it is bounded.

#import "color.wgsl"
#import "scene.wgsl"

/// How far short rays go that return what bounds by area take [m]. No light is bounded by its area farther off.
fn most_bound() -> f32 {
    return 0.2 * scene_info.dense_extent;
}

/// The least π d² [m²] that counts near a light that stands for an area [m²] and is bounded at so many radii of a disc of it.
fn area_of_bound(radii: f32, area: f32) -> f32 {
    return min(radii * radii * area, PI * most_bound() * most_bound());
}

/// Geometry term of a light without its visibility [1/m²], cosθ cosθ' / (π d² + disc), with π d² taken as at least `least` [m²]: what
/// remains after this bound, and what it removes. `offset` [m] is from the light to the receiver; `rounding` [m] is that of positions.
fn bounded_geometry(
    offset: vec3<f32>,
    light_normal: vec3<f32>,
    normal: vec3<f32>,
    rounding: f32,
    least: f32,
    disc: f32,
) -> vec2<f32> {
    // Below the rounding, neither the distance nor the light's direction is meaningful.
    let distance2 = max(dot(offset, offset), rounding * rounding);
    let cosines = max(-dot(normal, offset), 0.0) * max(dot(light_normal, offset), 0.0) / distance2;
    // Exactly zero where nothing is bounded, whatever a compiler fuses: a difference of two quotients is not.
    let bounded = max(least - PI * distance2, 0.0);
    let whole = PI * distance2 + disc;
    let kept = cosines / (whole + bounded);
    return vec2(kept, kept * bounded / whole);
}
