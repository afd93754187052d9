// A virtual light from a texel of a reflective shadow map: for passes with a port `rsm`.

#import "virtual-lights.wgsl"

var rsm_position: texture_2d_array<f32>;
var rsm_normal: texture_2d_array<f32>;
var rsm_flux: texture_2d_array<f32>;

/// A light that emits nothing: for texels that saw nothing, and if no texel can be sampled. It has a valid normal all
/// the same, so that a frame built around it has finite axes.
fn dark_light(texel: u32) -> VirtualLight {
    return VirtualLight(vec3(0.0), 0.0, vec3(0.0, 0.0, 1.0), texel, vec3(0.0), 0.0);
}

/// The light at a texel that stands for `weight` texels like it: with `weight` times the flux that is reflected there [W],
/// and `weight` times its surface. With the weight 1 / (N p), that is the area of a surface on which one light lies on
/// average.
fn virtual_light_from_texel(layer: u32, x: u32, y: u32, weight: f32) -> VirtualLight {
    let size = textureDimensions(rsm_position);
    let texel = (layer * size.y + y) * size.x + x;
    let position = textureLoad(rsm_position, vec2(x, y), layer, 0);
    let normal = textureLoad(rsm_normal, vec2(x, y), layer, 0).xyz;
    if position.w == 0.0 || dot(normal, normal) == 0.0 {
        return dark_light(texel);
    }
    // A light of 1e30 W sampled with probability 1e-20 would be infinite.
    let whole = min(textureLoad(rsm_flux, vec2(x, y), layer, 0) * weight, vec4(1e37));
    // Half floats change the normal's length by up to 0.05 %.
    return VirtualLight(position.xyz, whole.a, normalize(normal), texel, whole.rgb, 0.0);
}
