// The lights that are in a tree. Of their summary, the box is around those on surfaces [m].

#import "algorithms/summary.wgsl"
#import "color.wgsl"
#import "light-nodes.wgsl"
#import "virtual-lights.wgsl"

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
