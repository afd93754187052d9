// Splats points of the scene into hemispherical depth maps, one per virtual light. [ISM §3.2]
//
// These are imperfect shadow maps before their holes are filled.
//
// depth: [count × tile × tile] u32, map after map, each row by row: the bits of the distance [m]. Distances are not
// negative, so their bits are in the order of their values and an integer minimum keeps the nearest. What is bound may be
// a run of the maps.
//
// Surfels store the distances of the centres of texels, which need no bias for the slope; a box stores that of the middle of
// a splat, of the usual two to four texels.

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
#output counters: Counters // The numbers of splats that were requested and that were produced.

// DEVIATION(surfel): the paper stores one distance.
#option KERNEL surfel one_of [box, surfel] // The depth that a splat stores. box: one distance (ISM §3.2). surfel: in each texel the
    // distance of the point's tangent plane, so that a surface shadows itself less; takes longer.

#import "dispatch.wgsl"
#import "paraboloid.wgsl"
#import "scene.wgsl"
#import "surface-sample.wgsl"
#import "counters.wgsl"
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
    /// The most points of all maps together, which bounds the time. If more are requested, all maps lose the same share; the
    /// port `counters` gives the numbers of points requested and produced. [default: 33554432, min: 1, max: 1073741824]
    budget: u32,
    /// Factor on the side of a splat. Larger: fewer holes, but thicker shadows. [default: 1.0, min: 0.0, max: 16.0]
    splat_scale: f32,
    /// Greatest side of a splat, which bounds the time of points near a light. Larger: fewer holes near the light.
    /// [default: 8.0, min: 1.0, max: 512.0, unit: "px"]
    max_splat: f32,
    /// Factor on the bias of the depth test that these maps need. Surfaces shadow themselves less and light leaks more with
    /// it. [default: 1.0, min: 0.0]
    depth_bias: f32,
    /// Splats of all maps that were requested.
    wanted: u32,
    /// The first of the maps that are bound.
    first_map: u32,
    /// The samples of these maps: from the first to before the end, where their number is padded to whole blocks.
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

/// One thread per splat.
@compute @workgroup_size(64)
fn splat(row: Row) {
    let index = settings.first + index_in(row, 64u);
    if index >= settings.end {
        return;
    }
    let point = surface_sample(settings.samples, index);
    let map = point.map;
    if point.area <= 0.0 || map >= lights.count {
        return;
    }
    let frame = frame_from_normal(lights.lights[map].normal);
    let offset = point.position - lights.lights[map].position;
    let local = offset * frame;
    if !above_horizon(local, scene_info.extent) {
        return;
    }

    let distance = length(local);
    let facing = abs(dot(point.normal, offset)) / distance;
    let centre = paraboloid_from_direction(local / distance);
    let tile = settings.map;
    let texel = paraboloid_density(centre) * texel_area(tile);
    let side = clamp(settings.splat_scale * sqrt(point.area * facing / texel) / distance, 1.0, settings.max_splat);

    // Texels whose centres are in the square: at least one, as a side is at least 1.
    let position = tile_position(centre, tile);
    let low = vec2<u32>(max(ceil(position - 0.5 * side - 0.5), vec2(0.0)));
    let high = vec2<u32>(min(ceil(position + 0.5 * side - 0.5), vec2(f32(tile))));
    let size = high - low;
    let first = ((map - settings.first_map) * tile + low.y) * tile + low.x;
#if KERNEL == surfel
    let normal = point.normal * frame;
    let height = dot(normal, local);
    // Within the splat, or, if that is smaller than a texel, within a texel of a plane of slope 4.
    let reach = max(sqrt(point.area) * settings.splat_scale, 3.0 * distance * sqrt(texel));
#endif
    // One loop instead of two: neighbouring threads with splats of different sizes wait less for each other.
    var at = vec2(0u);
    for (var i = 0u; i < size.x * size.y; i++) {
#if KERNEL == surfel
        // The distance at which the texel's ray meets the tangent plane, limited for rays at grazing angles.
        let along = dot(normal, direction_from_paraboloid(texel_centre(low + at, tile)));
        let hit = select(distance, height / along, along * height > 0.0);
        let stored = clamp(hit, max(distance - reach, 0.0), distance + reach);
#else
        let stored = distance;
#endif
        atomicMin(&depth[first + at.y * tile + at.x], bitcast<u32>(stored));
        at.x++;
        if at.x == size.x {
            at = vec2(0u, at.y + 1u);
        }
    }
}
