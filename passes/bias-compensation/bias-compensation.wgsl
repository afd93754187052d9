// Returns by short rays the light that the bound of virtual lights took away. [Kollig & Keller 2004]
//
// Of the light that a surface at distance d < b sends, virtual lights give the share d² / b².
// The rest comes along rays of length b over the cosine: π times the mean of (1 - d² / b²) times the radiance that
// is reflected where they end.
//
// The pixels of a window of the interleaving share one stratified set of rays, as they share one set of lights.
//
// compensated: rgba32float [W/m²]; alpha is what bounds took away, less what the rays returned. As a difference of two estimates it can be
// negative at a pixel.

#input view: GBuffer // The pixels at which light was gathered.
#input irradiance: Irradiance like view with clamp // The irradiance of lights that give less within one distance, the fact `clamp`:
    // the output of `gather` itself.
#output compensated: Irradiance(
    interleave_x: irradiance.interleave_x?,
    interleave_y: irradiance.interleave_y?,
) // The irradiance with what the bound took away.

#import "camera.wgsl"
#import "diffuse-reflectance.wgsl"
#import "hemisphere.wgsl"
#import "reflected-light.wgsl"
#import "sobol.wgsl"
#import "tangent-frame.wgsl"
#import "view-geometric.wgsl"

struct Settings {
    view_size: vec2<u32>,
    irradiance_interleave_x: u32,
    irradiance_interleave_y: u32,
    /// The distance b, as a fraction of the scene's dense extent.
    irradiance_clamp: f32,
    /// Rays of a pixel. More: less noise near edges and contacts, and more time. [default: 1, min: 1, max: 64]
    rays_per_pixel: u32,
    seed: u32,
}

var<uniform> settings: Settings;
var view_depth: texture_2d<f32>;
var view_normal: texture_2d<f32>;
var irradiance: texture_2d<f32>;
var compensated: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn compensate(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= settings.view_size) {
        return;
    }
    var whole = textureLoad(irradiance, id.xy, 0);
    let depth = textureLoad(view_depth, id.xy, 0).x;
    let bound = settings.irradiance_clamp * scene_info.dense_extent;
    if depth > 0.0 && bound > 0.0 {
        let at = camera.position + pixel_ray(vec2<f32>(id.xy), settings.view_size) * depth;
        let normal = normalize(textureLoad(view_normal, id.xy, 0).xyz);
        let returned = near_field(id.xy, at, normal, plane_normal(id.xy, normal), bound);
        whole += vec4(returned, -luminance(returned));
    }
    textureStore(compensated, id.xy, whole);
}

/// The irradiance that bounded lights lack [W/m²], at a point [m] with a unit normal, in a plane with another.
fn near_field(pixel: vec2<u32>, at: vec3<f32>, normal: vec3<f32>, plane: vec3<f32>, bound: f32) -> vec3<f32> {
    let interleave = max(vec2(settings.irradiance_interleave_x, settings.irradiance_interleave_y), vec2(1u));
    let window = pixel / interleave;
    let within = pixel % interleave;
    let place = within.y * interleave.x + within.x;
    let window_seed = hash2(settings.seed, hash2(window.x, window.y));
    let tangents = frame_from_normal(normal);
    let origin = offset_origin(at, plane);
    var sum = vec3(0.0);
    for (var ray = 0u; ray < settings.rays_per_pixel; ray++) {
        let square = sobol2_of(place * settings.rays_per_pixel + ray, window_seed);
        let direction = tangents * by_cosine(square);
        if dot(direction, plane) <= 0.0 {
            continue;
        }
        let hit = trace(origin, direction, 0.0, bound);
        if hit.triangle == NO_HIT {
            continue;
        }
        let vertex = path_vertex(hit, direction);
        let offset = (vertex.position - at) / bound;
        let missing = max(1.0 - dot(offset, offset), 0.0);
        sum += reflected_light(vertex, -direction) * missing;
    }
    return PI * sum / f32(settings.rays_per_pixel);
}
