// The map of a light that sees a point.

#import "lights.wgsl"

/// Index of the layer of a light that sees a point: for a point light, the one of six along whose axis it lies
/// farthest.
fn layer_that_sees(light: Light, at: vec3<f32>) -> u32 {
    var best = light.first_layer;
    for (var i = 1u; i < light.layers; i++) {
        let candidate = light.first_layer + i;
        if dot(at - light.position, along(candidate)) > dot(at - light.position, along(best)) {
            best = candidate;
        }
    }
    return best;
}

/// The axis of a layer, away from the light.
fn along(layer: u32) -> vec3<f32> {
    return -scene_light_layers[layer].world_from_layer[2].xyz;
}
