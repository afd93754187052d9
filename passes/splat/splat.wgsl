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
#input past: FillingMaps optional // With `keep`, `prev` of the output `kept`, reset by `Scene`, `Reload`, `Setting` and `Moved`.
#input rendered: Stands optional // With `keep`, `prev` of the output `stands`, reset by the same.
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
// DEVIATION(traced): the paper splats points alone.
#option TRACED false // Whether rays find what is splatted, too. What is near a light is large in its map, but small in the scene, where it
    // has few points: light leaks past it. Rays need a hierarchy over the triangles.
#option MASKED false // whether triangles do not count where alpha is below their material's cutoff
#option KEEP false // Whether the maps of lights that stay go on filling: each frame adds other points, so a map comes nearer to an
    // exact one. Where geometry moves, all begin anew. It needs the links `past` and `rendered`.
#if KEEP
#output kept: FillingMaps continues past // The maps for the next frame.
#output stands: Stands(count: lights.count) // Where the lights stand whose maps these are.
#endif

#import "algorithms/morton.wgsl"
#import "counters.wgsl"
#import "dispatch.wgsl"
#import "ray-tracing.wgsl"
#import "surfel.wgsl"
#import interface "points"
#if KEEP
#import "filling-maps.wgsl"
#import "stands.wgsl"
#endif

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
    /// Side of the square of texels of which each ray finds a surface, with `traced`. 1 makes nearly exact maps; more: more light that
    /// leaks, but less time. [default: 2, min: 1, max: 512, unit: "px"]
    texels_per_ray: u32,
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
    /// Frames over which a map goes on filling with `keep`; then it is done, and takes no time. More: less light that leaks where
    /// nothing moves, but more time until maps are done. [default: 64, min: 1, max: 65536]
    frames: u32,
    /// Points of all maps that were requested.
    wanted: u32,
    /// The first of the maps that are bound, and the one after the last.
    first_map: u32,
    end_map: u32,
    /// The greatest side of a splat [px].
    side: f32,
    /// Rays along each side of a map.
    rays_across: u32,
    /// The splats of these maps: from the first to before the end, where their number is padded to whole blocks.
    first: u32,
    end: u32,
#if KEEP
    lights_count: u32,
    /// Frames since there are maps of the frame before.
    rendered_age: u32,
#endif
    @align(16) samples: SamplesWanted,
}

var<uniform> settings: Settings;
var<storage, read> lights: VirtualLights;
/// [count: lights.count * settings.map * settings.map]
var<storage, read_write> depth: array<atomic<u32>>;
/// The same buffer, as vectors of four texels.
var<storage, read_write> cleared: array<vec4<u32>>;
var<storage, read_write> counters: Counters;
#if KEEP
/// [count: lights.count * settings.map * settings.map]
var<storage, read_write> kept: array<u32>;
/// What there was before this frame's points.
var<storage, read> there: array<u32>;
var<storage, read> rendered: Stands;
var<storage, read_write> stands: Stands;
#endif

/// The distance of an empty texel, +∞.
const EMPTY: u32 = 0x7f800000u;
/// Part of the seed of the places of rays.
const RAY_PLACES: u32 = 0x7370u;

#if TRACED
/// Of the side of a splat: what rays find need not be hidden by wide surfels.
const SHARE_OF_SIDE: f32 = 0.7;
#else
const SHARE_OF_SIDE: f32 = 1.0;
#endif

/// Frames in which points fell into a map before.
fn frames_before(map: u32) -> u32 {
#if KEEP
    if map < min(lights.count, settings.lights_count) {
        let past = rendered.stands[map];
        return select(0u, past.frames, is_same_stand(stand_of(lights.lights[map]), past));
    }
#endif
    return 0u;
}

/// Which of many sets of points and rays are splatted in this frame.
fn turn() -> u32 {
#if KEEP
    return settings.rendered_age;
#else
    return 0u;
#endif
}

#if KEEP
/// Writes where the light of each map stands.
@compute @workgroup_size(64)
fn note_stands(row: Row) {
    let map = index_in(row, 64u);
    if map < settings.lights_count {
        var light: VirtualLight;
        if map < lights.count {
            light = lights.lights[map];
        }
        var stand = stand_of(light);
        stand.frames = select(0u, min(frames_before(map) + 1u, settings.frames), stand.is_rendered == 1u);
        stands.stands[map] = stand;
    }
}

/// What the frame before leaves of a texel.
fn texel_after(texel: u32, map: u32) -> u32 {
    let before = frames_before(map);
    let is_over = before == 0u || (before < settings.frames && is_outdated(texel, before));
    return select(texel, EMPTY, is_over);
}

/// Turns what is kept into distances.
@compute @workgroup_size(64)
fn show_distances(row: Row) {
    let index = index_in(row, 64u);
    if index < arrayLength(&cleared) {
        for (var c = 0u; c < 4u; c++) {
            let texel = 4u * index + c;
            if texel < arrayLength(&kept) {
                cleared[index][c] = distance_kept(kept[texel]);
            }
        }
    }
}
#endif

/// Four texels per thread are set to +∞, that is, empty, unless they are kept: then they are also copied for the splats. One thread writes
/// the counters.
@compute @workgroup_size(64)
fn clear(row: Row) {
    let index = index_in(row, 64u);
    if index < arrayLength(&cleared) {
#if KEEP
        let texels = settings.map * settings.map;
        for (var c = 0u; c < 4u; c++) {
            let texel = 4u * index + c;
            if texel < arrayLength(&kept) {
                kept[texel] = texel_after(kept[texel], settings.first_map + texel / texels);
                cleared[index][c] = kept[texel];
            }
        }
#else
        cleared[index] = vec4(EMPTY);
#endif
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
    let map = map_of_splat(settings.samples, settings.candidates, index);
    // The map of a dark light is never looked up.
    if map >= min(lights.count, settings.samples.maps) || all(lights.lights[map].flux == vec3(0.0)) {
        return;
    }
    let light = lights.lights[map];
    let frame = frame_from_normal(light.normal);
    let before = frames_before(map);
    if before >= settings.frames {
        return;
    }
    var samples = settings.samples;
    samples.turn = turn();
    let splat = chosen(samples, settings.candidates, index, map, light, frame);
    if splat.point.area <= 0.0 {
        return;
    }
    cover(splat, map, light, frame, before);
}

/// The place of a ray in the square of a map: somewhere in its cell.
fn place_of_ray(map: u32, cell: vec2<u32>) -> vec2<f32> {
    let seed = hash2(hash2(RAY_PLACES, map), turn());
    let number = 2u * (cell.y * settings.rays_across + cell.x);
    let jitter = vec2(unit_float(hash2(seed, number)), unit_float(hash2(seed, number + 1u)));
    return (vec2<f32>(cell) + jitter) * (2.0 / f32(settings.rays_across)) - 1.0;
}

/// One thread per ray, map after map. A hit stands for the surface that its cell sees.
@compute @workgroup_size(64)
fn splat_hits(row: Row) {
    let index = index_in(row, 64u);
    let rays = settings.rays_across * settings.rays_across;
    let map = settings.first_map + index / rays;
    if map >= min(lights.count, settings.end_map) || all(lights.lights[map].flux == vec3(0.0)) {
        return;
    }
    let before = frames_before(map);
    if before >= settings.frames {
        return;
    }
    let light = lights.lights[map];
    let ray = map_ray(light.kind, place_of_ray(map, place_in_turn(index % rays, settings.rays_across)));
    let nearest = rise_above_horizon(ray);
    if nearest < 0.0 {
        return;
    }
    let frame = frame_from_normal(light.normal);
    let hit = trace(light.position + frame * ray.origin, frame * ray.direction, nearest, FAR);
    if hit.triangle == NO_HIT {
        return;
    }
    let triangle = triangle_of_scene(hit.triangle);
    var splat: Splat;
    splat.local = ray.origin + hit.distance * ray.direction;
    splat.point.position = light.position + frame * splat.local;
    splat.point.normal = normal_and_area(triangle.a, triangle.b).xyz;
    splat.point.triangle = hit.triangle;
    let distance = map_distance(light.kind, splat.local);
    let width = map_texel_width(light.kind, splat.local, distance, settings.rays_across);
    // On a surface that is seen on edge, a cell sees more than stays in its plane.
    let cosine = abs(dot(splat.point.normal * frame, map_direction(light.kind, splat.local, distance)));
    splat.point.area = width * width / max(cosine, 0.1);
    cover(splat, map, light, frame, before);
}

/// Splats a point into a map into which points fell in so many frames before.
fn cover(splat: Splat, map: u32, light: VirtualLight, frame: mat3x3<f32>, before: u32) {
    let tile = settings.map;
    let scale = SHARE_OF_SIDE * settings.splat_scale;
    let distance = map_distance(light.kind, splat.local);
    let centre = map_position(light.kind, splat.local, distance);
#if KERNEL == surfel
    let surfel = surfel_of(splat, light, frame, tile, scale, settings.side, 1.0 / f32(before + 1u));
#if KEEP
    let kind = kind_of_disc(surfel.triangle_area, splat.point.area);
#endif
    let reach = surfel.reach;
#else
    // At least one texel, as a side is at least 1.
    let cosine = abs(dot(splat.point.normal * frame, map_direction(light.kind, splat.local, distance)));
    let density = 1.0 / map_texel_width(light.kind, splat.local, distance, tile);
    let side = clamp(scale * sqrt(splat.point.area * cosine) * density, 1.0, settings.side);
    let reach = vec2(0.5 * side);
#if KEEP
    let kind = 0u;
#endif
#endif

    let texels = texels_about(centre, reach, tile);
    let first = ((map - settings.first_map) * tile + texels.first.y) * tile + texels.first.x;
    // One loop instead of two: neighbouring threads with splats of different sizes wait less for each other.
    var at = vec2(0u);
    for (var i = 0u; i < texels.size.x * texels.size.y; i++) {
#if KERNEL == surfel
        let met = meet_surfel(surfel, map_ray(light.kind, texel_centre(texels.first + at, tile)));
        let stored = met.distance;
        let is_of_triangle = met.is_of_triangle;
#else
        let stored = distance;
        let is_of_triangle = true;
#endif
        if stored >= 0.0 {
            var bits = bitcast<u32>(stored);
#if KEEP
            bits = kept_distance(bits, select(kind, 0u, is_of_triangle));
            // Later discs fill holes alone: all of them together would be thicker than those of one frame.
            if !is_of_triangle && before > 0u {
                let is_hole = there[first + at.y * tile + at.x] == EMPTY;
                bits = select(EMPTY, bits, is_hole && !is_outdated(bits, before));
            }
#endif
            atomicMin(&depth[first + at.y * tile + at.x], bits);
        }
        at.x++;
        if at.x == texels.size.x {
            at = vec2(0u, at.y + 1u);
        }
    }
}
