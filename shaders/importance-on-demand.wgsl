// Importance of a texel of a reflective shadow map, computed where a sampler asks for it (TCAS Eq. 1-2): a chain of
// Metropolis-Hastings looks at few texels, and needs no sum over the others.

#import "view-sample.wgsl"

struct ImportanceFacts {
    view_samples: u32,
    /// Least distance in the geometry term [extents].
    min_distance: f32,
    /// Response that is added everywhere [1/extents²].
    defensive: f32,
}

var<uniform> importance_facts: ImportanceFacts;
var<storage, read> importance_samples: array<ViewSample>;
var importance_position: texture_2d_array<f32>;
var importance_normal: texture_2d_array<f32>;
var importance_flux: texture_2d_array<f32>;

/// f(v) ≥ 0 of a texel. The time is that of `view_samples` evaluations of the geometry term.
fn importance(layer: u32, texel: vec2<u32>) -> f32 {
    let flux = textureLoad(importance_flux, texel, layer, 0).rgb;
    if all(flux == vec3(0.0)) {
        return 0.0;
    }
    let position = to_extents(textureLoad(importance_position, texel, layer, 0).xyz);
    let normal = textureLoad(importance_normal, texel, layer, 0).xyz;
    var response = vec3(0.0);
    for (var k = 0u; k < importance_facts.view_samples; k++) {
        let at = importance_samples[k];
        response += at.response * sample_geometry(position, normal, at, importance_facts.min_distance);
    }
    return importance_of(flux, response / f32(importance_facts.view_samples), importance_facts.defensive);
}
