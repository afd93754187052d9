// Returns by short rays the light that the bound of virtual lights took away. [Kollig & Keller 2004]
//
// Of the light that a surface at distance d sends, virtual lights give a share s: d² / b² where they are bounded at one distance b, and
// π d² / (r² A) where each is bounded at r radii of a disc of the area A that it stands for, no farther off than rays go. The rest comes
// along rays over the cosine: π times the mean of (1 - s) times the radiance that is reflected where they end. There, A is that of the
// nearest light: areas are those of a density, which changes little from one light to the next.
//
// The pixels of a window of the interleaving share one stratified set of rays, as they share one set of lights. A pixel traces more of them
// where the first rays of those around it differ, and where few pixels of its window see its surface. The samples of a pixel of the frame
// that see one surface share the rays of one of them, chosen at random.
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
#lights

#option LIGHTS false // whether there are lights

#import "bounded-geometry.wgsl"
#import "camera.wgsl"
#import "diffuse-reflectance.wgsl"
#import "hemisphere.wgsl"
#import "reflected-light.wgsl"
#import "sobol.wgsl"
#import "surface-around.wgsl"
#import "tangent-frame.wgsl"
#import "view-geometric.wgsl"
#if LIGHTS
#import "virtual-lights.wgsl"
#endif

struct Settings {
    view_size: vec2<u32>,
    view_supersampling: u32,
    irradiance_interleave_x: u32,
    irradiance_interleave_y: u32,
    /// The distance b, as a fraction of the scene's dense extent.
    irradiance_clamp: f32,
    /// The distance below which a light gives no more, in radii of a disc of its area.
    irradiance_area_bound: f32,
    /// Rays of a pixel, at the least. More: less noise near edges and contacts, and more time. [default: 1, min: 0, max: 64]
    rays_per_pixel: u32,
    /// The most rays of a pixel, or of each of its samples, where those around it differ. No more than `rays_per_pixel`: all pixels trace
    /// as many. [default: 8, min: 0, max: 64]
    most_rays: u32,
    /// The noise for which a pixel traces more rays, as a share of the irradiance around it. More: fewer rays, and more noise. [default:
    /// 0.05, min: 0.0, max: 1000.0]
    noise: f32,
    seed: u32,
    sample: u32,
}

var<uniform> settings: Settings;
#if LIGHTS
var<storage, read> lights: VirtualLights;
#endif
var irradiance: texture_2d<f32>;
var compensated: texture_storage_2d<rgba32float, write>;

/// Side of a workgroup [pixels of the frame].
const SIDE: u32 = 8u;

/// Pixels of a workgroup beside one.
const OTHERS: u32 = SIDE * SIDE - 1u;

/// What the first rays of each pixel of a workgroup return, in the mean, and the irradiance before: luminances [W/m²].
var<workgroup> firsts: array<vec2<f32>, OTHERS + 1u>;

/// Where the rays of a sample begin, and which they are.
struct RaySet {
    /// The surface, and where rays begin off it [m].
    at: vec3<f32>,
    origin: vec3<f32>,
    /// Unit normals: of shading, and of the surface's plane.
    normal: vec3<f32>,
    plane: vec3<f32>,
    /// The place of the pixel in its window of the interleaving, the pixels of that, and the seed of their set of rays.
    place: u32,
    window: u32,
    seed: u32,
    /// The samples of the pixel that share these rays, a bit for each of those from `sample_of`.
    sharing: u32,
    /// The samples in a window of the interleaving whose mean a filter takes; 0 where nothing is seen.
    alike: u32,
    /// Where the run of lights begins in which the nearest is sought, below 1.
    start: f32,
}

/// Sample i of a pixel of the frame, in an order at random that begins with each of them and goes to either side as often, so that of
/// samples that see one surface each is the first as often.
fn sample_of(pixel: vec2<u32>, i: u32) -> vec2<u32> {
    let side = settings.view_supersampling;
    let random = hash2(settings.seed, hash2(pixel.x, pixel.y));
    let step = select(i, side * side - i, (random & 1u) != 0u);
    let place = ((random >> 1u) % (side * side) + step) % (side * side);
    return pixel * side + vec2(place % side, place / side);
}

/// A thread a pixel of the frame. [threads: (view.width / view.supersampling, view.height / view.supersampling, 1)]
@compute @workgroup_size(SIDE, SIDE)
fn compensate(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) index: u32,
) {
    let side = settings.view_supersampling;
    let samples = select(0u, side * side, all(side * id.xy < settings.view_size));
    var rays = RaySet();
    var sum = vec3(0.0);
    if samples > 0u {
        rays = rays_of_sample(id.xy, 0u, 0u, group.xy);
    }
    var traced = least_of(rays);
    if rays.alike > 0u {
        sum = sum_of_rays(rays, 0u, traced);
        let before = luminance(textureLoad(irradiance, sample_of(id.xy, 0u), 0).rgb);
        firsts[index] = vec2(luminance(sum) / f32(max(traced, 1u)), before);
    }
    workgroupBarrier();
    var done = 0u;
    for (var i = 0u; i < samples; i++) {
        if (done & (1u << i)) != 0u {
            continue;
        }
        if i > 0u {
            rays = rays_of_sample(id.xy, i, done, group.xy);
            sum = vec3(0.0);
            traced = 0u;
        }
        var returned = vec3(0.0);
        if rays.alike > 0u {
            let count = wanted_rays(index, rays);
            returned = (sum + sum_of_rays(rays, traced, count)) / f32(max(count, 1u));
        }
        for (var j = i; j < samples; j++) {
            if (rays.sharing & (1u << j)) != 0u {
                let at = sample_of(id.xy, j);
                let whole = textureLoad(irradiance, at, 0);
                textureStore(compensated, at, whole + vec4(returned, -luminance(returned)));
            }
        }
        done |= rays.sharing;
    }
}

/// The rays of sample i of a pixel, shared by those after it that see its surface and are not done.
fn rays_of_sample(pixel: vec2<u32>, i: u32, done: u32, group: vec2<u32>) -> RaySet {
    var rays = RaySet();
    rays.sharing = 1u << i;
    let own = sample_of(pixel, i);
    let depth = textureLoad(view_depth, own, 0).x;
    if depth <= 0.0 {
        return rays;
    }
    rays.normal = normalize(textureLoad(view_normal, own, 0).xyz);
    rays.plane = plane_normal(own, rays.normal);
    rays.at = position_from_depth(own, settings.view_size, depth);
    rays.origin = offset_origin(rays.at, rays.plane);
    let around = surface_around(own, settings.view_size, depth, rays.normal);
    let side = settings.view_supersampling;
    for (var j = i + 1u; j < side * side; j++) {
        let other = vec2<i32>(sample_of(pixel, j));
        if (done & (1u << j)) == 0u && is_same_surface(around, other, SAME_PLANE, SAME_NORMAL) {
            rays.sharing |= 1u << j;
        }
    }
    // Whole pixels of the frame.
    let interleave = max(vec2(settings.irradiance_interleave_x, settings.irradiance_interleave_y), vec2(side));
    rays.alike = clamp(alike_in_window(around, settings.view_size, interleave), 1u, interleave.x * interleave.y);
    let pixels = interleave / side;
    let window = pixel / pixels;
    let within = pixel % pixels;
    rays.place = within.y * pixels.x + within.x;
    rays.window = pixels.x * pixels.y;
    rays.seed = hash2(settings.seed, hash2(window.x, window.y));
    rays.start = unit_float(hash2(group.x, group.y));
    return rays;
}

/// The most rays of a pixel of the frame, each of which compares MOST_LIGHTS lights: a CPU driver ends the loops of a thread after
/// 65,535 iterations.
const MOST_RAYS: u32 = 128u;

/// The part of MOST_RAYS of the samples that share rays.
fn most_of(rays: RaySet) -> u32 {
    let side = settings.view_supersampling;
    return max(MOST_RAYS * countOneBits(rays.sharing) / (side * side), 1u);
}

/// How many rays each sample traces, or those that share them together.
fn least_of(rays: RaySet) -> u32 {
    return min(settings.rays_per_pixel, most_of(rays));
}

/// How many rays a sample traces: those of the pixels of its window that see another surface too, and as many as bring the mean that a
/// filter takes to `noise`, by how the first rays of the other pixels of the workgroup differ. Its own do not count: pixels whose first
/// rays return little would keep to these, and the mean would be wrong. Of the samples that a filter finds, those that share rays count
/// once.
fn wanted_rays(index: u32, rays: RaySet) -> u32 {
    let least = least_of(rays);
    let sharing = countOneBits(rays.sharing);
    let most = clamp(max(settings.most_rays, least) * sharing, least, most_of(rays));
    let of_window = min((least * rays.window * sharing + rays.alike - 1u) / rays.alike, most);
    var returned = 0.0;
    var before = 0.0;
    for (var i = 0u; i <= OTHERS; i++) {
        returned += select(firsts[i].x / f32(OTHERS), 0.0, i == index);
        before += select(firsts[i].y / f32(OTHERS), 0.0, i == index);
    }
    if returned <= 0.0 {
        return of_window;
    }
    var variance = 0.0;
    for (var i = 0u; i <= OTHERS; i++) {
        let away = (firsts[i].x - returned) / (returned + before);
        variance += select(away * away / f32(OTHERS), 0.0, i == index);
    }
    let wanted = variance * f32(least * sharing) / max(f32(rays.alike) * settings.noise * settings.noise, 1e-37);
    return clamp(u32(min(wanted, f32(most))), of_window, most);
}

#if LIGHTS
/// The most lights among which the end of a ray finds the nearest: a run, since consecutive lights are spread as all of them are. All of
/// them took more time, and erred as much.
const MOST_LIGHTS: u32 = 256u;

/// The area for which a light at a point with a unit normal stands [m²]: that of the nearest light, where those with other
/// normals count as farther; 0 if there is none. `start`, below 1, chooses the run of lights: that of a workgroup, whose
/// threads then read one light at a time.
fn area_at(at: vec3<f32>, normal: vec3<f32>, start: f32) -> f32 {
    let count = min(lights.count, arrayLength(&lights.lights));
    let run = min(count, MOST_LIGHTS);
    let first = u32(start * f32(count - run));
    var least = 1e37;
    var nearest = count;
    for (var i = first; i < first + run; i++) {
        let offset = lights.lights[i].position - at;
        let cosine = dot(lights.lights[i].normal, normal);
        let farther = 1.0 / max(cosine * cosine, 1e-6);
        let distance2 = dot(offset, offset) * farther * farther;
        if distance2 < least && cosine > 0.0 && lights.lights[i].kind != INFINITELY_FAR {
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

/// The element of the set that a ray of a pixel is. In a picture that is a mean over frames, the first rays of frames follow one another, and
/// others, which not all frames have, are apart.
fn element_of(rays: RaySet, ray: u32) -> u32 {
    let before = settings.sample * select(OTHER_RAYS, rays.window, ray == 0u);
    return before + ray * rays.window + rays.place;
}

/// More elements than the first rays of a window have.
const OTHER_RAYS: u32 = 1048576u;

/// The sum over rays, from `first` until before `end`, whose mean is the irradiance that bounded lights lack [W/m²].
fn sum_of_rays(rays: RaySet, first: u32, end: u32) -> vec3<f32> {
    let bound = settings.irradiance_clamp * scene_info.dense_extent;
    var reach = bound;
#if LIGHTS
    if settings.irradiance_area_bound > 0.0 {
        reach = max(reach, most_bound());
    }
#endif
    if reach <= 0.0 {
        return vec3(0.0);
    }
    let tangents = frame_from_normal(rays.normal);
    var sum = vec3(0.0);
    for (var ray = first; ray < end; ray++) {
        let direction = tangents * by_cosine(sobol2_of(element_of(rays, ray), rays.seed));
        if dot(direction, rays.plane) <= 0.0 {
            continue;
        }
        let hit = trace(rays.origin, direction, 0.0, reach);
        if hit.triangle == NO_HIT {
            continue;
        }
        let vertex = path_vertex(hit, direction);
        let reflected = reflected_light(vertex, -direction);
        if !any(reflected > vec3(0.0)) {
            continue;
        }
        let offset = vertex.position - rays.at;
        let distance2 = dot(offset, offset);
        var share = min(distance2 / max(bound * bound, 1e-37), 1.0);
#if LIGHTS
        let radii = settings.irradiance_area_bound;
        if radii > 0.0 {
            let least = area_of_bound(radii, area_at(vertex.position, vertex.normal, rays.start));
            share *= min(PI * distance2 / max(least, 1e-37), 1.0);
        }
#endif
        sum += reflected * (1.0 - share);
    }
    return PI * sum;
}
