// A virtual light from a texel of a reflective shadow map: for passes with a port `rsm`.

#import "color.wgsl"
#import "horizon.wgsl"
#import "lights.wgsl"
#import "octahedron.wgsl"
#import "virtual-lights.wgsl"

var rsm_position: texture_2d_array<f32>;
var rsm_normal: texture_2d_array<f32>;
var rsm_flux: texture_2d_array<f32>;

/// A light that emits nothing: for texels that saw nothing, and if no texel can be sampled. It has a valid normal all
/// the same, so that a frame built around it has finite axes.
fn dark_light(texel: u32) -> VirtualLight {
    return VirtualLight(vec3(0.0), 0.0, vec3(0.0, 0.0, 1.0), texel, vec3(0.0), ON_SURFACE);
}

/// The farthest distance off the plane of a surface at which another map's texel may lie to show the same surface, in sides of a square of a texel's
/// area.
const COPLANAR: f32 = 0.25;

/// The least cosine between the normals of texels of two maps that show the same surface.
const ALIKE: f32 = 0.5;

/// Returns the light of a source that a surface reflects, as its own layer of the map has it.
struct Reflected {
    /// [m]
    position: vec3<f32>,
    /// Unit.
    normal: vec3<f32>,
    /// Luminance of the flux that the texel reflects [W].
    flux: f32,
    /// Area of the texel's surface [m²].
    area: f32,
}

/// The radiosity of a surface by the light of another layer, over that by its own; 0 where that layer does not see it.
fn relative_radiosity(own: Reflected, layer: u32) -> f32 {
    let clip = scene_light_layers[layer].clip_from_world * vec4(own.position, 1.0);
    if !(clip.w > 0.0 && all(abs(clip.xy) < vec2(clip.w))) {
        return 0.0;
    }
    let size = textureDimensions(rsm_position);
    let place = (clip.xy / clip.w * vec2(0.5, -0.5) + 0.5) * vec2<f32>(size);
    // The quotient can round up to 1.
    let texel = min(vec2<u32>(place), size - 1u);
    let flux = textureLoad(rsm_flux, texel, layer, 0);
    let other = Reflected(
        textureLoad(rsm_position, texel, layer, 0).xyz,
        textureLoad(rsm_normal, texel, layer, 0).xyz,
        luminance(flux.rgb),
        flux.a,
    );
    let off_plane = abs(dot(own.normal, other.position - own.position));
    let is_same = off_plane <= COPLANAR * sqrt(max(own.area, other.area)) && dot(own.normal, other.normal) >= ALIKE;
    if !(is_same && other.flux > 0.0 && other.area > 0.0) {
        return 0.0;
    }
    return other.flux / own.flux * (own.area / other.area);
}

/// The share of the radiosity of a texel's surface that comes from the light of its layer: 1 where no other light sees it.
fn share_of_radiosity(own: Reflected, layer: u32) -> f32 {
    let layers = min(textureNumLayers(rsm_position), arrayLength(&scene_light_layers));
    if !(own.flux > 0.0 && own.area > 0.0 && layer < layers) {
        return 1.0;
    }
    let light = scene_light_layers[layer].light;
    var whole = 1.0;
    for (var other = 0u; other < layers; other++) {
        // The layers of one light do not overlap.
        if scene_light_layers[other].light != light {
            whole += relative_radiosity(own, other);
        }
    }
    return 1.0 / whole;
}

/// The light at a texel that stands for `weight` texels like it: with `weight` times the flux that is reflected there [W],
/// and `weight` times its surface. With the weight 1 / (N p), that is the area of a surface on which one light lies on
/// average. A surface that several lights of the scene see has virtual lights of each of their layers, and belongs to those
/// of a layer by its share of the radiosity: so no virtual light sends more from its area than the surface sends there.
fn virtual_light_from_texel(layer: u32, x: u32, y: u32, weight: f32) -> VirtualLight {
    let size = textureDimensions(rsm_position);
    let texel = (layer * size.y + y) * size.x + x;
    let position = textureLoad(rsm_position, vec2(x, y), layer, 0);
    let normals = textureLoad(rsm_normal, vec2(x, y), layer, 0);
    if position.w == 0.0 || dot(normals.xyz, normals.xyz) == 0.0 {
        return dark_light(texel);
    }
    // Half floats change the normal's length by up to 0.05 %.
    let normal = normalize(normals.xyz);
    let flux = textureLoad(rsm_flux, vec2(x, y), layer, 0);
    // A light of 1e30 W sampled with probability 1e-20 would be infinite.
    let whole = min(flux * weight, vec4(1e37));
    let share = share_of_radiosity(Reflected(position.xyz, normal, luminance(flux.rgb), flux.a), layer);
    var light = VirtualLight(position.xyz, whole.a * share, normal, texel, whole.rgb, ON_SURFACE);
    if normals.w != 0.0 {
        light.kind = kind_on_surface(normal, direction_from_half_float(normals.w));
        // The map has the flux that leaves: the light's is exact, although half floats and bytes turn its normal by a degree.
        light.flux = min(light.flux / max(share_above_horizon(light), 1e-3), vec3(1e37));
    }
    return light;
}
