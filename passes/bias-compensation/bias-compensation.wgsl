// Returns by short rays the light that the bound of virtual lights took away. [Kollig & Keller 2004]
//
// Of the light that a surface at distance d sends, virtual lights give a share s: d² / b² where they are bounded at one distance b, and
// π d² / (r² A) where each is bounded at r radii of a disc of the area A that it stands for. The rest comes along rays over the cosine: π
// times the mean of (1 - s) times the radiance that is reflected where they end. There, A is that of the nearest light: areas are those of
// a density, which changes little from one light to the next.
//
// The pixels of a window of the interleaving share one stratified set of rays, as they share one set of lights.
//
// compensated: rgba32float [W/m²]; alpha is what bounds took away, less what the rays returned. As a difference of two estimates it can be
// negative at a pixel.

#input view: GBuffer // The pixels at which light was gathered.
#input irradiance: Irradiance like view with clamp // The irradiance of lights that give less near them, by the facts `clamp` and
    // `area_bound`: the output of `gather` itself.
#input lights: VirtualLights optional // The lights that gave it: without them, what `area_bound` took is not returned.
#output compensated: Irradiance(
    interleave_x: irradiance.interleave_x?,
    interleave_y: irradiance.interleave_y?,
) // The irradiance with what the bound took away.

#option LIGHTS false // whether there are lights

#import "camera.wgsl"
#import "diffuse-reflectance.wgsl"
#import "hemisphere.wgsl"
#import "reflected-light.wgsl"
#import "sobol.wgsl"
#import "tangent-frame.wgsl"
#import "view-geometric.wgsl"
#if LIGHTS
#import "virtual-lights.wgsl"
#endif

struct Settings {
    view_size: vec2<u32>,
    irradiance_interleave_x: u32,
    irradiance_interleave_y: u32,
    /// The distance b, as a fraction of the scene's dense extent.
    irradiance_clamp: f32,
    /// The distance below which a light gives no more, in radii of a disc of its area.
    irradiance_area_bound: f32,
    /// Rays of a pixel. More: less noise near edges and contacts, and more time. [default: 1, min: 0, max: 64]
    rays_per_pixel: u32,
    /// Length of rays where lights are bounded by their areas, as a fraction of the scene's dense extent. Longer: what sparse lights
    /// lack is returned from farther, and rays take more time. [default: 0.1, min: 0.0, max: 10.0]
    reach: f32,
    seed: u32,
}

var<uniform> settings: Settings;
var view_depth: texture_2d<f32>;
var view_normal: texture_2d<f32>;
#if LIGHTS
var<storage, read> lights: VirtualLights;
#endif
var irradiance: texture_2d<f32>;
var compensated: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn compensate(@builtin(global_invocation_id) id: vec3<u32>, @builtin(workgroup_id) group: vec3<u32>) {
    if any(id.xy >= settings.view_size) {
        return;
    }
    var whole = textureLoad(irradiance, id.xy, 0);
    let depth = textureLoad(view_depth, id.xy, 0).x;
    if depth > 0.0 {
        let at = camera.position + pixel_ray(vec2<f32>(id.xy), settings.view_size) * depth;
        let normal = normalize(textureLoad(view_normal, id.xy, 0).xyz);
        let returned = near_field(id.xy, group.xy, at, normal, plane_normal(id.xy, normal));
        whole += vec4(returned, -luminance(returned));
    }
    textureStore(compensated, id.xy, whole);
}

#if LIGHTS
/// The most lights among which the end of a ray finds the nearest: a run, since consecutive lights are spread as all of them are.
const MOST_LIGHTS: u32 = 1024u;

/// The most lights for all rays of a pixel: a CPU driver ends the loops of a thread after 65,535 iterations.
const MOST_COMPARED: u32 = 32768u;

/// The area for which a light at a point with a unit normal stands [m²]: that of the nearest light, where those with other
/// normals count as farther; 0 if there is none. `start`, below 1, chooses the run of lights: that of a workgroup, whose
/// threads then read one light at a time.
fn area_at(at: vec3<f32>, normal: vec3<f32>, start: f32) -> f32 {
    let count = min(lights.count, arrayLength(&lights.lights));
    let run = min(count, min(MOST_LIGHTS, MOST_COMPARED / settings.rays_per_pixel));
    let first = u32(start * f32(count - run));
    var least = 1e37;
    var nearest = count;
    for (var i = first; i < first + run; i++) {
        let offset = lights.lights[i].position - at;
        let cosine = dot(lights.lights[i].normal, normal);
        let farther = 1.0 / max(cosine * cosine, 1e-6);
        let distance2 = dot(offset, offset) * farther * farther;
        if distance2 < least && cosine > 0.0 && lights.lights[i].kind == ON_SURFACE {
            least = distance2;
            nearest = i;
        }
    }
    if nearest == count {
        return 0.0;
    }
    return lights.lights[nearest].area;
}
#endif

/// The irradiance that bounded lights lack [W/m²], at a point [m] with a unit normal, in a plane with another.
fn near_field(
    pixel: vec2<u32>,
    group: vec2<u32>,
    at: vec3<f32>,
    normal: vec3<f32>,
    plane: vec3<f32>,
) -> vec3<f32> {
    let bound = settings.irradiance_clamp * scene_info.dense_extent;
    var reach = bound;
#if LIGHTS
    if settings.irradiance_area_bound > 0.0 {
        reach = max(reach, settings.reach * scene_info.dense_extent);
    }
#endif
    if reach <= 0.0 {
        return vec3(0.0);
    }
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
        let hit = trace(origin, direction, 0.0, reach);
        if hit.triangle == NO_HIT {
            continue;
        }
        let vertex = path_vertex(hit, direction);
        let reflected = reflected_light(vertex, -direction);
        if !any(reflected > vec3(0.0)) {
            continue;
        }
        let offset = vertex.position - at;
        let distance2 = dot(offset, offset);
        var share = min(distance2 / max(bound * bound, 1e-37), 1.0);
#if LIGHTS
        let radii = settings.irradiance_area_bound;
        if radii > 0.0 {
            let area = area_at(vertex.position, vertex.normal, unit_float(hash2(group.x, group.y)));
            share *= min(PI * distance2 / max(radii * radii * area, 1e-37), 1.0);
        }
#endif
        sum += reflected * (1.0 - share);
    }
    return PI * sum / f32(max(settings.rays_per_pixel, 1u));
}
