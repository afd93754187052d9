// The lights that are in a tree, and the box around those on surfaces.

#import "color.wgsl"
#import "light-nodes.wgsl"
#import "virtual-lights.wgsl"

struct Summary {
    /// The box around the lights on surfaces [m].
    low: vec3<f32>,
    /// The number of lights that are not dark.
    count: u32,
    high: vec3<f32>,
    pad: u32,
}

/// The most that a light, or all below a node, count as.
const GREATEST: f32 = 1e37;

/// Luminance of the flux of a light [W], or of the irradiance of one infinitely far [W/m²].
fn brightness(light: VirtualLight) -> f32 {
    return min(luminance(light.flux), GREATEST);
}

/// Whether a light gives any light, from a place that is a number.
fn is_lit(light: VirtualLight) -> bool {
    return luminance(light.flux) > 0.0 && all(abs(light.position) <= vec3(3.0e37));
}
