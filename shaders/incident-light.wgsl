// The light that a source of the scene gives at a point, without shadows.

#import "lights.wgsl"
#import "scene.wgsl"

struct Incident {
    /// The way the light travels, unit.
    direction: vec3<f32>,
    /// On a plane across it [W/m²].
    irradiance: vec3<f32>,
}

/// The light that falls on a point [m].
fn incident_light(light: Light, at: vec3<f32>) -> Incident {
    if light.kind == LIGHT_DIRECTIONAL {
        return Incident(light.direction, light.intensity);
    }
    let offset = at - light.position;
    // A light that lies on a surface would shine on it without bound: nearer than this it stays as bright.
    let nearest = 1e-6 * scene_info.extent;
    let distance = max(length(offset), nearest);
    let direction = offset / distance;
    return Incident(direction, light_intensity(light, direction) / distance / distance);
}
