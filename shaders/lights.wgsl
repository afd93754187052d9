// The lights of the scene, and the layers of the maps that are rendered from them.
//
// Candela and lux of KHR_lights_punctual are read as W/sr and W/m², per RGB channel.

const LIGHT_SPOT: u32 = 0u;
const LIGHT_POINT: u32 = 1u;
const LIGHT_DIRECTIONAL: u32 = 2u;

struct Light {
    /// World space [m]; unused by a directional light.
    position: vec3<f32>,
    kind: u32,
    /// The way the light travels along its axis, unit.
    direction: vec3<f32>,
    /// 1 - cos of the half angle beyond which a spot gives nothing, without cancellation; 2 for others.
    cap_outer: f32,
    /// [W/sr], or [W/m²] on a plane across the direction for a directional light.
    intensity: vec3<f32>,
    /// The same of the half angle within which a spot gives all.
    cap_inner: f32,
    first_layer: u32,
    layers: u32,
    /// The same of a half angle that holds all that a spot sends to the scene, for sampling: of a light far away, few directions
    /// of its cone meet the scene.
    cap_sampled: f32,
    pad0: u32,
}

/// One map of a light: one for a spot or a directional light, six for a point light and for a spot of more than 75° to each side.
struct LightLayer {
    clip_from_world: mat4x4<f32>,
    /// World space of the layer's axes: columns are right, up, back, and position.
    world_from_layer: mat4x4<f32>,
    /// Half the width and height: of the image plane at distance 1 (spot, point), or in metres (directional).
    half_extent: vec2<f32>,
    /// Index of the light.
    light: u32,
    /// LIGHT_...
    kind: u32,
}

struct SceneLights {
    count: u32,
    layers: u32,
    pad0: u32,
    pad1: u32,
    lights: array<Light>,
}

var<storage, read> scene_lights: SceneLights;
var<storage, read> scene_light_layers: array<LightLayer>;

/// 1 - cos of the angle of a unit direction to the axis of a light: within a narrow cone, cosines themselves are all 1.
fn cap_of(light: Light, leaving: vec3<f32>) -> f32 {
    let off_axis = leaving - light.direction;
    return 0.5 * dot(off_axis, off_axis);
}

/// Intensity [W/sr] of a spot or point light towards a unit direction that leaves it. The falloff is that of
/// KHR_lights_punctual: the square of a ramp in the cosine between the two angles.
fn light_intensity(light: Light, leaving: vec3<f32>) -> vec3<f32> {
    if light.kind != LIGHT_SPOT {
        return light.intensity;
    }
    let cap = cap_of(light, leaving);
    // Equal angles make a hard edge: the ramp's width is kept above the resolution of single precision.
    let ramp = (light.cap_outer - cap) / max(light.cap_outer - light.cap_inner, 1e-6 * light.cap_outer);
    let falloff = clamp(ramp, 0.0, 1.0);
    return light.intensity * (falloff * falloff);
}
