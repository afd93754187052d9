// The specular reflection of a virtual light from a texel of a reflective shadow map: for passes with a port `rsm` that has the
// member `specular`.

#import "beam.wgsl"
#import "rsm-light.wgsl"
#import "virtual-lobe.wgsl"

var rsm_specular: texture_2d_array<f32>;

/// The least flux [W] of a light that has a lobe: what renders maps of lights leaves out those of dark ones, and a metal reflects
/// nothing diffusely.
const LEAST_FLUX: f32 = 1e-30;

/// The lobe of the light of a texel that stands for `weight` texels like it.
fn lobe_from_texel(layer: u32, x: u32, y: u32, weight: f32) -> VirtualLobe {
    let texel = vec3(x, y, layer);
    let specular = textureLoad(rsm_specular, texel.xy, texel.z, 0);
    if textureLoad(rsm_position, texel.xy, texel.z, 0).w == 0.0 || !any(specular.rgb > vec3(0.0)) {
        return no_lobe();
    }
    let beam = texel_beam(texel, textureDimensions(rsm_position));
    return VirtualLobe(-beam.direction, specular.a, min(beam.flux * weight, vec3(1e37)), 0u, specular.rgb, 0u);
}

/// A light with this lobe, for which maps are rendered although it may reflect nothing diffusely.
fn with_lobe(light: VirtualLight, lobe: VirtualLobe) -> VirtualLight {
    var seen = light;
    if any(lobe.flux > vec3(0.0)) {
        seen.flux = max(seen.flux, vec3(LEAST_FLUX));
    }
    return seen;
}
