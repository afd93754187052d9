// The flux [W] that the surface in each texel reflects: albedo × the flux that the light sends into the texel; in alpha
// the area of that surface [m²].

#import "lights.wgsl"

var rsm_position: texture_2d_array<f32>;
var rsm_normal: texture_2d_array<f32>;
var albedo: texture_2d_array<f32>;
var rsm_flux: texture_storage_2d_array<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn flux(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(rsm_position)) {
        return;
    }
    var reflected = vec4(0.0);
    let position = textureLoad(rsm_position, id.xy, id.z, 0);
    if position.w > 0.0 {
        let beam = texel_beam(id);
        let normal = textureLoad(rsm_normal, id.xy, id.z, 0).xyz;
        reflected = vec4(textureLoad(albedo, id.xy, id.z, 0).rgb * beam.flux, surface_area(beam, position, normal));
    }
    textureStore(rsm_flux, id.xy, id.z, reflected);
}

/// What a light sends through a texel.
struct Beam {
    /// [W]
    flux: vec3<f32>,
    /// Across the beam [m²]: of a spot or point light, at the distance of 1 m from it.
    section: f32,
    /// Where the light is; a directional light is nowhere.
    origin: vec3<f32>,
    /// The way the light of the texel's centre travels, unit.
    direction: vec3<f32>,
    directional: bool,
}

fn texel_beam(texel: vec3<u32>) -> Beam {
    let layer = scene_light_layers[texel.z];
    let light = scene_lights.lights[layer.light];
    // Corners on the image plane at distance 1, y up; for a directional light, in metres.
    let low = corner(texel.xy, layer.half_extent);
    let high = corner(texel.xy + 1u, layer.half_extent);
    let origin = layer.world_from_layer[3].xyz;
    if layer.kind == LIGHT_DIRECTIONAL {
        let sides = abs(high - low);
        let section = sides.x * sides.y;
        return Beam(light.intensity * section, section, origin, light.direction, true);
    }
    let middle = 0.5 * (low + high);
    let direction = normalize((layer.world_from_layer * vec4(middle, -1.0, 0.0)).xyz);
    // DEVIATION(flux): by the texel's solid angle.
    let section = solid_angle(low, high);
    return Beam(light_intensity(light, direction) * section, section, origin, direction, false);
}

/// Area [m²] of the plane surface that a beam lights.
fn surface_area(beam: Beam, position: vec4<f32>, normal: vec3<f32>) -> f32 {
    // A surface that is nearly parallel to the beam ends within the texel: it is counted as if it stood at 84°.
    let cosine = max(-dot(normalize(normal), beam.direction), 0.1);
    if beam.directional {
        return beam.section / cosine;
    }
    let distance = length(position.xyz - beam.origin);
    return beam.section * distance * distance / cosine;
}

fn corner(at: vec2<u32>, half_extent: vec2<f32>) -> vec2<f32> {
    return (vec2<f32>(at) / vec2<f32>(textureDimensions(rsm_position)) * 2.0 - 1.0) * vec2(1.0, -1.0) * half_extent;
}

/// Solid angle [sr] of a rectangle on the plane at distance 1, given two opposite corners: the sum of its two
/// triangles. Exact for any rectangle, so the texels of six faces sum to 4π for maps of any size.
fn solid_angle(low: vec2<f32>, high: vec2<f32>) -> f32 {
    let a = vec3(low, 1.0);
    let b = vec3(high.x, low.y, 1.0);
    let c = vec3(high, 1.0);
    let d = vec3(low.x, high.y, 1.0);
    let sides = abs(high - low);
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
