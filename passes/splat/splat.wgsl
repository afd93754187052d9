// Splats points of the scene into hemispherical depth maps, one per virtual light. [ISM §3.2]
//
// These are imperfect shadow maps before their holes are filled.
//
// depth: [count × tile × tile] u32, map after map, each row by row: the bits of the distance [m]. Distances are not
// negative, so their bits are in the order of their values and an integer minimum keeps the nearest. What is bound may be
// a run of the maps.
//
// A surfel is a piece of the scene's own triangles: more of them, or larger maps, come nearer to exact maps. It stores the
// distances of the centres of texels, which need no bias for the slope; a box stores that of the middle of a splat, of the usual
// two to four texels.

#input points: Points // The points to splat.
#input lights: VirtualLights // The lights: one map each, over the hemisphere around its normal.
#output depth: DepthAtlas(
    count: lights.count,
    tile: settings.map,
    depth_bias: 0.3 * settings.depth_bias when settings.kernel == 'surfel',
    depth_bias: 0.2 * settings.depth_bias when settings.kernel == 'box',
    slope_bias: 0.0 when settings.kernel == 'surfel',
    slope_bias: 2.0 * settings.depth_bias when settings.kernel == 'box',
) // The maps, with holes.
#output counters: Counters // The numbers of points that were requested and that were generated.

// DEVIATION(surfel): the paper stores one distance, in a square of the point's solid angle.
#option KERNEL surfel one_of [box, surfel] // What a splat covers. box: a square, at one distance (ISM §3.2). surfel: the texels
    // whose rays meet the point's triangle, no farther from the point than the surface that it stands for; takes longer.
#option MASKED false // whether triangles do not count where alpha is below their material's cutoff

#import "dispatch.wgsl"
#import "light-projection.wgsl"
#import "mask.wgsl"
#import "random.wgsl"
#import "scene.wgsl"
#import "surface-sample.wgsl"
#import "counters.wgsl"
#import "triangle.wgsl"
#import "virtual-lights.wgsl"
#import interface "points"

struct Settings {
    /// Side of a map (ISM uses 128 and 256). Larger: sharper shadows, but more time. [default: 64, min: 1, max: 512, unit:
    /// "px"]
    map: u32,
    /// Points that are splatted into each map; 0 takes as many as `points_per_texel` says. [default: 0]
    points_per_map: u32,
    /// Points for each texel of the hemisphere, where `points_per_map` is 0. ISM §5.2 has a quarter. More: fewer holes and so
    /// less light that leaks, but more time. [default: 0.25, min: 0.0, max: 64.0]
    points_per_texel: f32,
    // DEVIATION(candidates): the paper splats every point of a map.
    /// Points of which each splat takes one, by the solid angle that they cover: surfaces near a light get more splats than
    /// others, and those behind it none. 1 takes points as they come, by area. More: fewer holes and thinner shadows near the
    /// light, but more time. [default: 4, min: 1, max: 16]
    candidates: u32,
    /// The most points of all maps together, candidates included, which bounds the time. If more are requested, all maps lose
    /// the same share; the port `counters` gives the numbers of points requested and generated. [default: 33554432, min: 1,
    /// max: 1073741824]
    budget: u32,
    /// Factor on the side of a splat. Larger: fewer holes, but thicker shadows. [default: 1.0, min: 0.0, max: 16.0]
    splat_scale: f32,
    /// Greatest side of a splat, which bounds the time of points near a light; 0 is 64, and of a box 4 / √(points a texel).
    /// Larger: fewer holes near the light. [default: 0.0, min: 0.0, max: 512.0, unit: "px"]
    max_splat: f32,
    /// Factor on the bias of the depth test that these maps need. Surfaces shadow themselves less and light leaks more with
    /// it. [default: 1.0, min: 0.0]
    depth_bias: f32,
    /// Points of all maps that were requested.
    wanted: u32,
    /// The first of the maps that are bound.
    first_map: u32,
    /// The greatest side of a splat [px].
    side: f32,
    /// The splats of these maps: from the first to before the end, where their number is padded to whole blocks.
    first: u32,
    end: u32,
    @align(16) samples: SamplesWanted,
}

var<uniform> settings: Settings;
var<storage, read> lights: VirtualLights;
/// [count: lights.count * settings.map * settings.map]
var<storage, read_write> depth: array<atomic<u32>>;
/// The same buffer, as vectors of four texels.
var<storage, read_write> cleared: array<vec4<u32>>;
var<storage, read_write> counters: Counters;

/// Four texels per thread are set to +∞, that is, empty. One thread writes the counters.
@compute @workgroup_size(64)
fn clear(row: Row) {
    let index = index_in(row, 64u);
    if index < arrayLength(&cleared) {
        cleared[index] = vec4(0x7f800000u);
    }
    if index == 0u {
        let requested = samples_requested();
        let made = min(requested, settings.samples.maps * settings.samples.per_map);
        counters = Counters(select(requested, settings.wanted, requested == ANY_NUMBER), made);
    }
}

/// Radius of the disc of a surfel whose triangle is smaller than the surface that the point stands for, over the square root of that
/// surface's area: beyond the triangle it thickens shadows.
const SMALL_RADIUS: f32 = 0.5;
/// The same of a surfel that ends with its triangle: where it overlaps others, it stores what they store.
const LARGE_RADIUS: f32 = 1.2;

/// What a thread splats.
struct Splat {
    /// The point; its area is 0 where there is none.
    point: SurfaceSample,
    /// The point in the light's frame [m].
    local: vec3<f32>,
}

/// The splats of a map. Points of a map that are this far apart in its order are far apart in the scene.
fn splats_of_map() -> u32 {
    return settings.samples.per_map / settings.candidates;
}

/// Returns the splat of an index among those of all maps, in a block of maps: one of as many points of its map as there are
/// candidates. (Talbot et al. 2005)
fn chosen(index: u32, block: u32, light: VirtualLight, frame: mat3x3<f32>) -> Splat {
    let stride = splats_of_map();
    let bits = settings.samples.block_bits;
    let first = index + (block * (settings.samples.per_map - stride) << bits);
    var splat: Splat;
    var sum = 0.0;
    var share = 1.0;
    for (var i = 0u; i < settings.candidates; i++) {
        let point = surface_sample(settings.samples, first + (i * stride << bits));
        let offset = point.position - light.position;
        let local = offset * frame;
        if point.area <= 0.0 || !above_horizon(local, scene_info.extent) {
            continue;
        }
        // Bounded at the light, and not zero for surfaces that are seen on edge.
        let is_far = light.kind == INFINITELY_FAR;
        let squared = dot(offset, offset);
        let cosine = abs(select(dot(point.normal, offset) * inverseSqrt(squared), dot(point.normal, light.normal), is_far));
        let weight = point.area / select(squared + point.area, 1.0, is_far) * mix(0.1, 1.0, cosine);
        sum += weight;
        if unit_float(hash2(index, i)) * sum <= weight {
            splat = Splat(point, local);
            share = weight;
        }
    }
    // It stands for all candidates, in the measure by which it was taken.
    splat.point.area *= sum / share;
    return splat;
}

/// One thread per splat.
@compute @workgroup_size(64)
fn splat(row: Row) {
    let index = settings.first + index_in(row, 64u);
    if index >= settings.end {
        return;
    }
    let bits = settings.samples.block_bits;
    let block = (index >> bits) / splats_of_map();
    let map = (block << bits) + (index & ((1u << bits) - 1u));
    // The map of a dark light is never looked up.
    if map >= min(lights.count, settings.samples.maps) || all(lights.lights[map].flux == vec3(0.0)) {
        return;
    }
    let light = lights.lights[map];
    let frame = frame_from_normal(light.normal);
    let splat = chosen(index, block, light, frame);
    let area = splat.point.area;
    if area <= 0.0 {
        return;
    }

    let local = splat.local;
    let distance = map_distance(light.kind, local);
    let normal = splat.point.normal * frame;
    let height = dot(normal, local);
    let centre = map_position(light.kind, local, distance);
    let tile = settings.map;
    // Texels per metre across the ray.
    let density = 1.0 / map_texel_width(light.kind, local, distance, tile);
#if KERNEL == surfel
    let triangle = triangle_of_scene(splat.point.triangle);
    let is_small = normal_and_area(triangle.a, triangle.b).w < area;
    let radius = select(LARGE_RADIUS, SMALL_RADIUS, is_small) * settings.splat_scale * sqrt(area);
    // In an orthographic map, x and y are the same directions everywhere, as in the middle of a paraboloid one.
    let extent = disc_extent(normal, select(centre, vec2(0.0), light.kind == INFINITELY_FAR));
    let reach = min(radius * density * extent, vec2(0.5 * settings.side));
    let corner = (triangle.corner - light.position) * frame;
    let a = map_homogeneous(light.kind, corner);
    let b = map_homogeneous(light.kind, corner + triangle.a * frame);
    let c = map_homogeneous(light.kind, corner + triangle.b * frame);
    let edges = mat3x3(cross(b, c), cross(c, a), cross(a, b));
#else
    // At least one texel, as a side is at least 1.
    let cosine = abs(dot(normal, map_direction(light.kind, local, distance)));
    let side = clamp(settings.splat_scale * sqrt(area * cosine) * density, 1.0, settings.side);
    let reach = vec2(0.5 * side);
#endif

    // Texels whose centres are in the rectangle.
    let position = tile_position(centre, tile);
    let low = vec2<u32>(max(ceil(position - reach - 0.5), vec2(0.0)));
    let high = vec2<u32>(min(ceil(position + reach - 0.5), vec2(f32(tile))));
    let size = high - low;
    let first = ((map - settings.first_map) * tile + low.y) * tile + low.x;
    // One loop instead of two: neighbouring threads with splats of different sizes wait less for each other.
    var at = vec2(0u);
    for (var i = 0u; i < size.x * size.y; i++) {
        var stored = distance;
#if KERNEL == surfel
        let ray = map_ray(light.kind, texel_centre(low + at, tile));
        let times = (height - dot(normal, ray.origin)) / dot(normal, ray.direction);
        let met = ray.origin + times * ray.direction;
        let off = met - local;
        stored = times * ray.length;
        // Rays of texels that only touch the disc point below the horizon.
        var is_met = stored > 0.0 && dot(off, off) <= radius * radius && above_horizon(met, scene_info.extent);
        if is_met && !is_small {
            // On which side of each edge the ray passes: in proportion to the weights of the opposite corners.
            let sides = ray.image * edges;
            is_met = (all(sides >= vec3(0.0)) || all(sides <= vec3(0.0)))
                && triangle_exists(splat.point.triangle, sides.yz / (sides.x + sides.y + sides.z));
        }
#else
        let is_met = true;
#endif
        if is_met {
            atomicMin(&depth[first + at.y * tile + at.x], bitcast<u32>(stored));
        }
        at.x++;
        if at.x == size.x {
            at = vec2(0u, at.y + 1u);
        }
    }
}

#if KERNEL == surfel
/// How far the image of a disc reaches along x and y of the square, over that of a disc across the ray. The map is conformal: x
/// and y follow two directions at right angles, along which the disc is as wide as the sines of the angles to its normal.
fn disc_extent(normal: vec3<f32>, centre: vec2<f32>) -> vec2<f32> {
    let r2 = dot(centre, centre);
    let product = centre.x * centre.y;
    let along_x = vec3(1.0 + r2 - 2.0 * centre.x * centre.x, -2.0 * product, -2.0 * centre.x) / (1.0 + r2);
    let along_y = vec3(-2.0 * product, 1.0 + r2 - 2.0 * centre.y * centre.y, -2.0 * centre.y) / (1.0 + r2);
    let cosines = vec2(dot(normal, along_x), dot(normal, along_y));
    return sqrt(max(1.0 - cosines * cosines, vec2(0.0)));
}
#endif
