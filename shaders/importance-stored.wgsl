// Importance that is stored for each texel of a reflective shadow map.

var importance_map: texture_2d_array<f32>;

/// f(v) ≥ 0 of a texel.
fn importance(layer: u32, texel: vec2<u32>) -> f32 {
    return textureLoad(importance_map, texel, layer, 0).r;
}
