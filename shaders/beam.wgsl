// The light that a source sends through the texels of its reflective shadow map.

#import "lights.wgsl"

/// The light that a source sends through a texel.
struct Beam {
    /// [W]
    flux: vec3<f32>,
    /// Across the beam [m²]: of a spot or point light, at the distance of 1 m from it.
    section: f32,
    /// Position of the light; a directional light has none.
    origin: vec3<f32>,
    /// The way the light of the texel's centre travels, unit.
    direction: vec3<f32>,
    directional: bool,
}

/// The beam of a texel: column, row and layer of a map whose layers have `size` texels.
fn texel_beam(texel: vec3<u32>, size: vec2<u32>) -> Beam {
    let layer = scene_light_layers[texel.z];
    let light = scene_lights.lights[layer.light];
    // On the image plane at distance 1, y up; for a directional light, in metres.
    let middle = texel_middle(texel.xy, size, layer.half_extent);
    let sides = texel_sides(size, layer.half_extent);
    let origin = layer.world_from_layer[3].xyz;
    if layer.kind == LIGHT_DIRECTIONAL {
        let section = sides.x * sides.y;
        return Beam(light.intensity * section, section, origin, light.direction, true);
    }
    let direction = normalize((layer.world_from_layer * vec4(middle, -1.0, 0.0)).xyz);
    let section = rectangle_solid_angle(middle, sides);
    return Beam(light_intensity(light, direction) * section, section, origin, direction, false);
}

/// Returns the middle of a texel of a map of `size` texels, on the plane at distance 1 that is `half_extent` to each side.
fn texel_middle(at: vec2<u32>, size: vec2<u32>, half_extent: vec2<f32>) -> vec2<f32> {
    return ((vec2<f32>(at) + 0.5) / vec2<f32>(size) * 2.0 - 1.0) * vec2(1.0, -1.0) * half_extent;
}

/// The same for all texels. The difference of two corners has lost digits where texels are small.
fn texel_sides(size: vec2<u32>, half_extent: vec2<f32>) -> vec2<f32> {
    return 2.0 * half_extent / vec2<f32>(size);
}

/// Solid angle [sr] of a rectangle on the plane at distance 1, given its middle and its sides: the sum of its two
/// triangles. Exact for any rectangle, so the texels of six faces sum to 4π for maps of any size.
fn rectangle_solid_angle(middle: vec2<f32>, sides: vec2<f32>) -> f32 {
    let low = middle - 0.5 * sides;
    let high = middle + 0.5 * sides;
    let a = vec3(low, 1.0);
    let b = vec3(high.x, low.y, 1.0);
    let c = vec3(high, 1.0);
    let d = vec3(low.x, high.y, 1.0);
    let volume = sides.x * sides.y;
    return triangle_solid_angle(a, b, c, volume) + triangle_solid_angle(a, c, d, volume);
}

/// Van Oosterom & Strackee 1983, Eq. 8. `volume` is |a · (b × c)|, which the caller knows without cancellation.
fn triangle_solid_angle(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>, volume: f32) -> f32 {
    let la = length(a);
    let lb = length(b);
    let lc = length(c);
    let t = volume / (la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
    // Built-in arc tangents have errors of about 1e-6, too much for the texel of a large map: there, a series is used.
    if t < 0.03125 {
        return 2.0 * t * (1.0 - t * t * (1.0 / 3.0 - t * t * 0.2));
    }
    return 2.0 * atan(t);
}
