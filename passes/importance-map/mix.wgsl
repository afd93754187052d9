// The importance mixed with the flux: f = (1 - δ) c / Σc + δ Φ / ΣΦ, times the number of texels, so that its
// mean is 1. A texel that reflects light is then sampled even if no sample of the view saw it, and no virtual light
// weighs more than 1/δ times its weight when sampled by flux alone (defensive sampling, Hesterberg 1995).
// DEVIATION(defensive): δ = 0 gives the importance of the paper.

#import "algorithms/scaled.wgsl"
#import "color.wgsl"
#import "sums.wgsl"

struct Settings {
    defensive: f32,
}

var<uniform> settings: Settings;
/// Over all texels.
var<storage, read> sums: Sums;
var contribution: texture_2d_array<f32>;
var rsm_flux: texture_2d_array<f32>;
var importance: texture_storage_2d_array<r32float, write>;

/// Share of a value in the total; 0 if the total is 0.
fn share(value: f32, whole: Scaled) -> f32 {
    if whole.value == 0.0 {
        return 0.0;
    }
    return in_units(Scaled(value, 0), whole.exponent) / whole.value;
}

@compute @workgroup_size(8, 8)
fn mix_with_flux(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(rsm_flux);
    if any(id.xy >= size) {
        return;
    }
    let by_view = share(textureLoad(contribution, id.xy, id.z, 0).r, sums.contribution);
    let by_flux = share(weight_of(luminance(textureLoad(rsm_flux, id.xy, id.z, 0).rgb)), sums.flux);
    let texels = f32(size.x) * f32(size.y) * f32(textureNumLayers(rsm_flux));
    textureStore(importance, id.xy, id.z, vec4(texels * mix(by_view, by_flux, settings.defensive)));
}
