// The material of the scene at a point of its surface: a fragment, or a point of a triangle.
//
// Surfaces are two-sided. Materials are those of glTF's metallic-roughness model: the diffuse part is Lambertian
// with reflectance base color × (1 − metallic).

#option TEXTURED false // whether any material of the scene has a texture

#import "mean-normal.wgsl"
#import "scene.wgsl"

/// The vertices of `Draw::Scene`.
struct Attributes {
    /// World space [m].
    @location(0) position: vec3<f32>,
    /// World space, unit.
    @location(1) normal: vec3<f32>,
    @location(2) uv: vec2<f32>,
    @location(3) material: u32,
    @location(4) instance: u32,
}

/// Changes of position and texture coordinates: from a pixel to its neighbours on the right and below, or along
/// two edges of a triangle.
struct Change {
    position_x: vec3<f32>,
    position_y: vec3<f32>,
    uv_x: vec2<f32>,
    uv_y: vec2<f32>,
}

struct Surface {
    /// Diffuse reflectance.
    albedo: vec3<f32>,
    /// Reflectance at normal incidence.
    specular: vec3<f32>,
    roughness: f32,
    /// Emitted radiance [W/(m² sr)].
    emission: vec3<f32>,
}

#if TEXTURED
/// The most reads along a footprint.
const MOST_TAPS: f32 = 16.0;

/// How a texture is read that is filtered over a footprint: by as many reads along its longer side as that is longer than the other,
/// each of a level whose texels are as wide as the shorter one. A sampler with anisotropic filtering does the same, but on llvmpipe it
/// takes 10 to 100 times as long, and some adapters take the shape of a footprint from several threads, which have nothing to do with
/// each other where rays end.
struct Footprint {
    longer: vec2<f32>,
    taps: f32,
    level: f32,
}

/// The footprint of these changes of texture coordinates.
fn footprint_of(uv_x: vec2<f32>, uv_y: vec2<f32>) -> Footprint {
    let size = vec2<f32>(textureDimensions(scene_textures));
    let lengths = vec2(length(uv_x * size), length(uv_y * size));
    let longer = select(uv_y, uv_x, lengths.x > lengths.y);
    let texels = max(lengths.x, lengths.y);
    let taps = clamp(ceil(texels / max(min(lengths.x, lengths.y), 1.0)), 1.0, MOST_TAPS);
    return Footprint(longer, taps, log2(max(texels / taps, 1.0)));
}

/// A texture filtered over a footprint.
fn texel_of(textures: texture_2d_array<f32>, uv: vec2<f32>, layer: u32, over: Footprint) -> vec4<f32> {
    var sum = vec4(0.0);
    for (var tap = 0.5; tap < over.taps; tap += 1.0) {
        let at = uv + over.longer * (tap / over.taps - 0.5);
        sum += textureSampleLevel(textures, scene_sampler, at, layer, over.level);
    }
    return sum / over.taps;
}
#endif

/// The surface at a point. Textures are filtered over `uv_x` and `uv_y`; with both zero, the finest level is read.
fn surface(index: u32, uv: vec2<f32>, uv_x: vec2<f32>, uv_y: vec2<f32>) -> Surface {
    let material = scene_materials[index];
    var base = material.base_color;
    var metallic = material.metallic;
    var roughness = material.roughness;
    var emission = material.emission;
#if TEXTURED
    let over = footprint_of(uv_x, uv_y);
    if material.base_color_texture != NO_TEXTURE {
        base *= texel_of(scene_textures, uv, material.base_color_texture, over);
    }
    if material.metallic_roughness_texture != NO_TEXTURE {
        let layer = material.metallic_roughness_texture;
        let texel = texel_of(scene_textures_linear, uv, layer, over);
        roughness *= texel.g;
        metallic *= texel.b;
    }
    if material.emission_texture != NO_TEXTURE {
        emission *= texel_of(scene_textures, uv, material.emission_texture, over).rgb;
    }
#endif
    // A dielectric of roughness 1 counts as Lambertian, here as in the trait `glossy`.
    let dielectric = select(material.specular, vec3(0.0), roughness >= 1.0);
    let specular = mix(dielectric, base.rgb, metallic);
    return Surface(base.rgb * (1.0 - metallic), specular, roughness, emission);
}

/// The texture coordinates of a point of a triangle, by the weights of its second and third vertex.
fn uv_on_triangle(index: u32, barycentrics: vec2<f32>) -> vec2<f32> {
    let uv = scene_vertices[scene_indices[3u * index]].uv;
    let uv1 = scene_vertices[scene_indices[3u * index + 1u]].uv;
    let uv2 = scene_vertices[scene_indices[3u * index + 2u]].uv;
    return uv + (uv1 - uv) * barycentrics.x + (uv2 - uv) * barycentrics.y;
}

/// Whether the surface is there: alpha at the finest level of textures is not below the material's cutoff. A mask is filtered no more
/// than the outlines of triangles are: where its mean is below the cutoff nothing would be left.
fn surface_exists(index: u32, uv: vec2<f32>) -> bool {
    let material = scene_materials[index];
    var alpha = material.base_color.a;
#if TEXTURED
    if material.alpha_cutoff > 0.0 && material.base_color_texture != NO_TEXTURE {
        alpha *= textureSampleLevel(scene_textures, scene_sampler, uv, material.base_color_texture, 0.0).a;
    }
#endif
    return alpha >= material.alpha_cutoff;
}

/// The interpolated normal, unit, on the seen side.
///
/// `towards` is the geometric normal on the seen side, of any length. It decides the side, since the winding of
/// real scenes says nothing, and since an interpolated normal at a silhouette may turn away from who sees it.
fn smooth_normal(interpolated: vec3<f32>, towards: vec3<f32>) -> vec3<f32> {
    // Normals of unit length that nearly cancel between vertices have no direction of their own.
    let is_valid = dot(interpolated, interpolated) >= 1e-8;
    return facing(unit(select(towards, interpolated, is_valid)), towards);
}

/// The mean of the normals for shading that a footprint has: the smooth one, unit, bent by the material's normal map. What is lit by
/// the cosine of each is lit by that of their mean, which is shorter than they are: a unit vector would be too bright. It may turn away
/// from who sees the surface.
fn mean_shading_normal(index: u32, unbent: vec3<f32>, uv: vec2<f32>, change: Change) -> vec3<f32> {
#if TEXTURED
    let layer = scene_materials[index].normal_texture;
    if layer != NO_TEXTURE {
        let over = footprint_of(change.uv_x, change.uv_y);
        let mean = texel_of(scene_textures_linear, uv, layer, over).xyz * 2.0 - 1.0;
        let scale = scene_materials[index].normal_scale;
        let scaled = vec3(mean.xy * scale, mean.z);
        // Each normal is scaled and then made a unit vector. Where all lean alike, the mean of these has this length.
        let length_of_each = sqrt(scale * scale * max(1.0 - mean.z * mean.z, 0.0) + mean.z * mean.z);
        let share = min(length(scaled) / max(length_of_each, 1e-6), 1.0);
        // Between texels of the finest level a normal is interpolated, and a unit vector.
        return bent_normal(unbent, scaled, change) * mix(1.0, share, min(over.level, 1.0));
    }
#endif
    return unbent;
}

/// The normal for shading where a ray ends, unit, at the finest level: the change is that along two edges of the triangle, whatever its
/// size.
fn shading_normal_on_triangle(index: u32, unbent: vec3<f32>, uv: vec2<f32>, change: Change) -> vec3<f32> {
#if TEXTURED
    let layer = scene_materials[index].normal_texture;
    if layer != NO_TEXTURE {
        let texel = textureSampleLevel(scene_textures_linear, scene_sampler, uv, layer, 0.0);
        let scale = vec3(vec2(scene_materials[index].normal_scale), 1.0);
        return bent_normal(unbent, (texel.xyz * 2.0 - 1.0) * scale, change);
    }
#endif
    return unbent;
}

/// The light that a surface receives under a bent normal, or under those that have this mean, over that under its own.
fn lit_share(normal: vec3<f32>, unbent: vec3<f32>, to_light: vec3<f32>) -> f32 {
    if all(normal == unbent) {
        return 1.0;
    }
    // A plane that is nearly parallel to the beam counts as if it stood at 84°, as its area does.
    return dot(mean_facing(normal, to_light), to_light) / max(dot(unbent, to_light), 0.1);
}

/// The normal, flipped to the side of a direction.
fn facing(normal: vec3<f32>, direction: vec3<f32>) -> vec3<f32> {
    return select(normal, -normal, dot(normal, direction) < 0.0);
}

/// A tangent-space normal (glTF: x along u, y against v) in the frame that the changes of position and texture
/// coordinates span about `normal` (Schüler 2006, without precomputed tangents).
fn bent_normal(normal: vec3<f32>, tangent_space: vec3<f32>, change: Change) -> vec3<f32> {
    let across_y = cross(change.position_y, normal);
    let across_x = cross(normal, change.position_x);
    // Its sign is the handedness of the two changes about the normal.
    let turn = sign(dot(change.position_x, across_y));
    let along_u = (across_y * change.uv_x.x + across_x * change.uv_y.x) * turn;
    let along_v = (across_y * change.uv_x.y + across_x * change.uv_y.y) * turn;
    let longest = sqrt(max(dot(along_u, along_u), dot(along_v, along_v)));
    // Texture coordinates that do not change have no directions: the map says nothing there.
    if longest == 0.0 {
        return normal;
    }
    return unit((along_u * tangent_space.x - along_v * tangent_space.y) / longest + normal * tangent_space.z);
}

/// A vector of any length scaled to 1; zero stays zero. Scaled by its largest component first, so that the
/// squares of pixels in a scene of millimetres do not vanish.
fn unit(v: vec3<f32>) -> vec3<f32> {
    let largest = max(max(abs(v.x), abs(v.y)), abs(v.z));
    if largest == 0.0 {
        return v;
    }
    return normalize(v / largest);
}
