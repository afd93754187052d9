// Sums the irradiance of virtual lights at the camera's pixels, interleaved. [ISM §4]
//
// The pixels are split into n×m interleaved sub-images, and each sub-image takes one of n·m subsets of the lights
// (Segovia et al. 2006).
// A workgroup is 8×8 pixels of one sub-image, so all its threads read the same lights and nearby texels of their maps.
//
// irradiance: rgba32float [W/m²]; in alpha the luminance of what the clamp removed [W/m²].

#input view: GBuffer // The pixels at which light is gathered.
#input lights: VirtualLights // The lights.
#input visibility: Visibility optional // The visibility of the lights; without it, all are visible.
#output irradiance: Irradiance(
    interleave_x: min(settings.interleave_x, view.width),
    interleave_y: min(settings.interleave_y, view.height),
    clamp: settings.clamp when settings.area_bound == 0 && settings.geometry == 'bounded',
) // Diffuse irradiance, with noise if interleaved.

#option GEOMETRY bounded one_of [bounded, point-to-disc, disc] // What a light near a receiver gives. bounded: no more than at the
    // bound, so what is nearer is lost. disc: what a disc of the light's area gives, for lights that stand for an area of known
    // shape. point-to-disc: the same where it is straight ahead, Φ cosθ cosθ' / (π d² + A), and less elsewhere (ACRSM Eq. 3.9).
#option VISIBILITY false // whether something says which lights are seen

#import "camera.wgsl"
#import "color.wgsl"
#if GEOMETRY == disc
#import "disc-irradiance.wgsl"
#else
#import "bounded-geometry.wgsl"
#endif
#import "scene.wgsl"
#import "view-geometric.wgsl"
#import "virtual-lights.wgsl"
#if VISIBILITY
#import interface "visibility"
#endif

struct Settings {
    view_size: vec2<u32>,
    /// Number of sub-images along a row, at most one per pixel. Each pixel takes one of interleave_x · interleave_y subsets of
    /// the lights. More: less time, but more noise for a filter to remove. With 1 × 1 each pixel takes all lights. ISM Tab. 1
    /// uses 4 and 8. [default: 4, min: 1, max: 16]
    interleave_x: u32,
    /// Number of sub-images along a column, as `interleave_x` of a row. [default: 4, min: 1, max: 16]
    interleave_y: u32,
    /// The lights that form a subset. runs: consecutive lights. strides: every (n·m)-th light. Consecutive elements of a Halton
    /// sequence are stratified; every (n·m)-th ones share digits, and so lie in strips. Strides suit lights that are sorted by
    /// position. [default: "runs", one_of: ["runs", "strides"]]
    subsets: u32,
    /// Distance below which a light's geometry term is bounded, as a fraction of the scene's dense extent; 0 is no such bound. Where
    /// `geometry` is disc, the least radius of a disc, by which nothing is lost.
    /// Larger: smaller bright spots near lights, but more energy lost near corners, which alpha has and `bias-compensation`
    /// returns. [default: 0.0, min: 0.0, max: 1.0]
    clamp: f32,
    /// The same in radii of a disc of the area that each light stands for, where `geometry` is bounded: where lights are dense,
    /// they are bounded at less distance. 0 is no such bound. With more lights, less is lost. [default: 1.0, min: 0.0, max:
    /// 100.0]
    area_bound: f32,
    irradiance_interleave_x: u32,
    irradiance_interleave_y: u32,
    /// The lights of each subset that this dispatch takes: `begin` to `end`.
    begin: u32,
    end: u32,
    /// 1 for the dispatch that takes the last lights.
    last: u32,
}

var<uniform> settings: Settings;
var<storage, read> lights: VirtualLights;
var view_depth: texture_2d<f32>;
var view_normal: texture_2d<f32>;
var irradiance: texture_storage_2d<rgba32float, write>;
/// Sums of the dispatches before, pixel by pixel. [scratch, count: view.width * view.height * min(parts - 1, 1)]
var<storage, read_write> sums: array<vec4<f32>>;

const STAGED: u32 = 64u;
var<workgroup> staged: array<VirtualLight, STAGED>;

/// A subset of the lights: its light k is `first + k * stride`.
struct Subset {
    first: u32,
    count: u32,
    stride: u32,
}

/// Subset s of `subsets`. Every light is in exactly one, also if the count is not a multiple of `subsets`.
fn subset(s: u32, subsets: u32, count: u32) -> Subset {
    if settings.subsets == 0u {
        let first = s * count / subsets;
        return Subset(first, (s + 1u) * count / subsets - first, 1u);
    }
    return Subset(s, (count + subsets - 1u - s) / subsets, subsets);
}

/// Geometry term of a light without its visibility [1/m²], cosθ cosθ' / (π d²), or the cosine alone where the light is infinitely
/// far: what remains after the bound, and what the bound removes.
fn geometry(light: VirtualLight, at: vec3<f32>, normal: vec3<f32>) -> vec2<f32> {
    if light.kind == INFINITELY_FAR {
        return vec2(max(-dot(normal, light.normal), 0.0), 0.0);
    }
    let offset = at - light.position;
    // Below the rounding of positions, neither the distance nor the light's direction is meaningful.
    let rounding = 1e-6 * scene_info.extent;
    let closest = settings.clamp * scene_info.dense_extent;
#if GEOMETRY == disc
    let radius = max(closest, rounding);
    return vec2(disc_irradiance(offset, light.normal, normal, max(light.area / PI, radius * radius)), 0.0);
#else
    var least = PI * closest * closest;
    var disc = light.area;
#if GEOMETRY == bounded
    least = max(least, settings.area_bound * settings.area_bound * light.area);
    disc = 0.0;
#endif
    return bounded_geometry(offset, light.normal, normal, rounding, least, disc);
#endif
}

/// A pixel for which a thread gathers, and its sum so far.
struct Receiver {
    pixel: vec2<u32>,
    seen: bool,
    at: vec3<f32>,
    normal: vec3<f32>,
    /// The normal of its plane.
    plane: vec3<f32>,
    sum: vec4<f32>,
}

/// Pixels per thread along each side of a square, GROUP_SIDE apart: each light is read once for all of them.
const SPAN: u32 = 2u;

/// Side of a workgroup.
const GROUP_SIDE: u32 = 8u;

/// Side of the square of pixels of a sub-image that a workgroup takes.
const SQUARE: u32 = GROUP_SIDE * SPAN;

/// Gathers at the pixels of a square of GROUP_SIDE * SPAN in one sub-image. A light takes an iteration, and one more and a lookup
/// for each pixel of a thread. [threads: (
///     ((view.width + irradiance.interleave_x - 1) / irradiance.interleave_x + SQUARE - 1) / SQUARE * GROUP_SIDE,
///     ((view.height + irradiance.interleave_y - 1) / irradiance.interleave_y + SQUARE - 1) / SQUARE * GROUP_SIDE
///         * irradiance.interleave_x * irradiance.interleave_y, 1),
/// items: 1 + lights.count / (min(settings.interleave_x, view.width) * min(settings.interleave_y, view.height)),
/// iterations: 1 + SPAN * SPAN * (1 + visibility.iterations)]
@compute @workgroup_size(GROUP_SIDE, GROUP_SIDE)
fn gather(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
    @builtin(local_invocation_index) local_index: u32,
) {
    let interleave = vec2(settings.irradiance_interleave_x, settings.irradiance_interleave_y);
    let subsets = interleave.x * interleave.y;
    // Workgroups along a sub-image; the number of the widest for all of them. Sub-images follow one after the other, so
    // that the maps of one subset of the lights are in the caches.
    let groups = ((settings.view_size + interleave - 1u) / interleave + SQUARE - 1u) / SQUARE;
    let image = group.y / groups.y;
    let first = vec2(image % interleave.x, image / interleave.x);
    let corner = vec2(group.x, group.y % groups.y) * SQUARE + local.xy;
    var receivers: array<Receiver, SPAN * SPAN>;
    for (var r = 0u; r < SPAN * SPAN; r++) {
        let pixel = (corner + GROUP_SIDE * vec2(r % SPAN, r / SPAN)) * interleave + first;
        receivers[r].pixel = pixel;
        let inside = min(pixel, settings.view_size - 1u);
        let depth = textureLoad(view_depth, inside, 0).x;
        receivers[r].seen = depth > 0.0;
        receivers[r].at = camera.position + pixel_ray(vec2<f32>(inside), settings.view_size) * depth;
        receivers[r].normal = normalize(textureLoad(view_normal, inside, 0).xyz);
        receivers[r].plane = plane_normal(inside, receivers[r].normal);
    }
    let own = subset(image, subsets, min(lights.count, arrayLength(&lights.lights)));
    let part_end = min(own.count, settings.end);
    for (var begin = settings.begin; begin < part_end; begin += STAGED) {
        if begin + local_index < part_end {
            staged[local_index] = lights.lights[own.first + (begin + local_index) * own.stride];
        }
        workgroupBarrier();
        let end = min(part_end - begin, STAGED);
        for (var i = 0u; i < end; i++) {
            let light = staged[i];
            let flux_luminance = luminance(light.flux);
            for (var r = 0u; r < SPAN * SPAN; r++) {
                let at = receivers[r].at;
                let normal = receivers[r].normal;
                var terms = geometry(light, at, normal);
#if VIEW_GEOMETRIC
                // No light arrives from behind the plane, even where a bent normal faces it.
                let to_light = select(light.position - at, -light.normal, light.kind == INFINITELY_FAR);
                terms *= select(0.0, 1.0, dot(receivers[r].plane, to_light) > 0.0);
#endif
#if VISIBILITY
                if terms.x > 0.0 {
                    terms *= visibility(own.first + (begin + i) * own.stride, light, at, receivers[r].plane);
                }
#endif
                receivers[r].sum += vec4(light.flux * terms.x, flux_luminance * terms.y);
            }
        }
        workgroupBarrier();
    }
    for (var r = 0u; r < SPAN * SPAN; r++) {
        if all(receivers[r].pixel < settings.view_size) {
            // A subset represents all lights: the mean over the sub-images is the sum over all lights.
            var sum = select(vec4(0.0), receivers[r].sum * f32(subsets), receivers[r].seen);
            let index = receivers[r].pixel.y * settings.view_size.x + receivers[r].pixel.x;
            if settings.begin > 0u {
                sum += sums[index];
            }
            if settings.last == 0u {
                sums[index] = sum;
                continue;
            }
            textureStore(irradiance, receivers[r].pixel, sum);
        }
    }
}
