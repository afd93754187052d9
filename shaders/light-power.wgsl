// The power of the lights of the scene.

#import "algorithms/scaled.wgsl"
#import "color.wgsl"
#import "lights.wgsl"

/// Solid angle [sr] into which a light is sampled; of a directional light, the area [m²] across it.
fn measure_of(light: Light) -> f32 {
    if light.kind == LIGHT_DIRECTIONAL {
        let half_extent = scene_light_layers[light.first_layer].half_extent;
        return 4.0 * half_extent.x * half_extent.y;
    }
    return 2.0 * PI * light.cap_sampled;
}

/// The greatest power that counts, so that the sum over all lights is finite: it does nothing but share out paths.
const MOST_POWER: f32 = 1e30;

/// Luminance of what a light emits, but for the falloff of a spot.
fn power_of(light: Light) -> f32 {
    return min(weight_of(luminance(light.intensity) * measure_of(light)), MOST_POWER);
}
