// Importance of a texel of a reflective shadow map from its own flux and the response of the view to a texel of its block.

#import "view-sample.wgsl"

struct ImportanceFacts {
    /// Side of a block [texels].
    stride: u32,
    /// Response that is added everywhere [1/extents²].
    defensive: f32,
}

var<uniform> importance_facts: ImportanceFacts;
var importance_flux: texture_2d_array<f32>;
var importance_response: texture_2d_array<f32>;

/// f(v) ≥ 0 of a texel.
fn importance(layer: u32, texel: vec2<u32>) -> f32 {
    let flux = textureLoad(importance_flux, texel, layer, 0).rgb;
    let response = textureLoad(importance_response, texel / importance_facts.stride, layer, 0).rgb;
    return importance_of(flux, response, importance_facts.defensive);
}
