// Renders what the lights see: position, normal and reflected flux. One layer for a spot or directional light, six for a point
// light. [Dachsbacher & Stamminger 2005, §3.1]

#output rsm: ReflectiveShadowMap(size: side, layers: max(scene.light_layers, 1)) // What the lights see.
#lights

#option GLOSSY false // whether the map has the member `specular`

#import "beam.wgsl"
#import "horizon.wgsl"
#import "lights.wgsl"
#import "octahedron.wgsl"
#import "surface-fragment.wgsl"

struct Settings {
    /// Side of a layer. Larger: sharper shadows and more positions for virtual lights; time and memory grow with its square.
    /// [default: 512, min: 1, max: 8192, unit: "px"]
    size: u32,
    /// The most layers that have `size`² texels: where lights have more, all of them share the texels of so many, and have smaller sides.
    /// Larger: sharper shadows of many lights; time and memory grow with it. [default: 16, min: 1, max: 4096]
    full_layers: u32,
    /// The layer that is rendered.
    layer: u32,
}

var<uniform> settings: Settings;
var rsm_position: texture_2d_array<f32>;
var rsm_normal: texture_2d_array<f32>;
var rsm_albedo: texture_2d_array<f32>;
var rsm_flux: texture_storage_2d_array<rgba32float, write>;

struct Seen {
    @builtin(position) clip: vec4<f32>,
    /// [m]; not from the light, which may be so far away that places in the scene would all be rounded to one.
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) uv: vec2<f32>,
    @location(3) @interpolate(flat) material: u32,
}

struct Texel {
    @location(0) rsm_position: vec4<f32>,
    @location(1) rsm_normal: vec4<f32>,
    @location(2) rsm_albedo: vec4<f32>,
}

@vertex
fn project(vertex: Attributes) -> Seen {
    let clip = scene_light_layers[settings.layer].clip_from_world * vec4(vertex.position, 1.0);
    return Seen(clip, vertex.position, vertex.normal, vertex.uv, vertex.material);
}

@fragment
fn surfaces(seen: Seen) -> Texel {
    let change = change_of(seen);
    let at = fragment_surface(seen.material, seen.uv, change);
    let world_from_layer = scene_light_layers[settings.layer].world_from_layer;
    let offset = seen.position - world_from_layer[3].xyz;
    let along = -dot(offset, world_from_layer[2].xyz);
    // DEVIATION(sides): from a texel down and from there to the right turns to the light, whatever the surface; but not where
    // the next texel is beyond the plane's horizon, as in maps of few texels.
    let parallel = scene_light_layers[settings.layer].kind == LIGHT_DIRECTIONAL;
    let travels = select(offset, -world_from_layer[2].xyz, parallel);
    let towards = facing(cross(change.position_y, change.position_x), -travels);
    let normal = smooth_normal(seen.normal, towards);
    let bent = mean_shading_normal(seen.material, normal, seen.uv, change);
    var share = 1.0;
    var horizon = 0.0;
    if any(bent != normal) {
        share = lit_share(bent, normal, -normalize(travels)) * share_above(normal, bent);
        horizon = half_float_from_direction(unit(bent));
    }
    return Texel(vec4(seen.position, along), vec4(normal, horizon), vec4(at.albedo, share));
}

#if GLOSSY
/// Rendered in a draw of its own: WebGPU guarantees 32 bytes per texel for the targets of one draw.
@fragment
fn rsm_specular(seen: Seen) -> @location(0) vec4<f32> {
    let change = change_of(seen);
    let at = fragment_surface(seen.material, seen.uv, change);
    return vec4(at.specular, at.roughness);
}
#endif

fn change_of(seen: Seen) -> Change {
    return Change(dpdx(seen.position), dpdy(seen.position), dpdx(seen.uv), dpdy(seen.uv));
}

/// Computes the flux [W] that the surface in each texel reflects: albedo × the flux that the light sends into the texel × what a
/// normal map leaves of it; in alpha the area of that surface [m²].
@compute @workgroup_size(8, 8)
fn flux(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(rsm_position)) {
        return;
    }
    var reflected = vec4(0.0);
    let position = textureLoad(rsm_position, id.xy, id.z, 0);
    if position.w > 0.0 {
        // DEVIATION(flux): by the texel's solid angle.
        let beam = texel_beam(id, textureDimensions(rsm_position));
        let normal = textureLoad(rsm_normal, id.xy, id.z, 0).xyz;
        let albedo = textureLoad(rsm_albedo, id.xy, id.z, 0);
        reflected = vec4(albedo.rgb * beam.flux * albedo.a, surface_area(beam, position, normal));
    }
    textureStore(rsm_flux, id.xy, id.z, reflected);
}

/// Area [m²] of the plane surface that a beam lights.
fn surface_area(beam: Beam, position: vec4<f32>, normal: vec3<f32>) -> f32 {
    // A surface that is nearly parallel to the beam ends within the texel: it is counted as if it stood at 84°.
    let cosine = max(-dot(normalize(normal), beam.direction), 0.1);
    if beam.directional {
        return beam.section / cosine;
    }
    let distance = length(position.xyz - beam.origin);
    return beam.section * distance * distance / cosine;
}
