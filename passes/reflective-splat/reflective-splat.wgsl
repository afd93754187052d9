// Makes virtual lights of the next bounce where imperfect reflective shadow maps of virtual lights say that their light falls. [ISM §4.1]
//
// A texel stores the index of the sample that its light sees there: the nearest by distance, and of those the one of least
// index. Where the sample lies, which way it faces and what it reflects follow from its triangle.

#input points: Points // The points to splat.
#input lights: VirtualLights // Lights of a bounce: one map each, over the hemisphere around its normal.
#output reflected: VirtualLights(count: settings.count) // Lights of the next bounce, by the flux that is reflected there.

#option MASKED false // whether triangles do not count where alpha is below their material's cutoff
#option TEXTURED false // whether any material of the scene has a texture

#import "algorithms/morton.wgsl"
#import "algorithms/scaled.wgsl"
#import "color.wgsl"
#import "cumulative-choice.wgsl"
#import "dispatch.wgsl"
#import "horizon.wgsl"
#import "sobol.wgsl"
#import "surfel.wgsl"
#import "vertex-on-triangle.wgsl"
#import interface "points"

struct Settings {
    /// Number N of virtual lights of the next bounce (ISM Fig. 7: 256). Error falls as N^-½; the time for shadows and gathering
    /// rises with N. [default: 256, min: 1, max: 2097152]
    count: u32,
    /// Side of a map. Larger: edges of light and shadow are met more closely, but more time. [default: 64, one_of:
    /// [1, 2, 4, 8, 16, 32, 64, 128, 256, 512], unit: "px"]
    map: u32,
    /// Points that are splatted into each map. More: fewer holes and finer edges, but more time. [default: 4000, min: 1]
    points_per_map: u32,
    /// Points of which each splat takes one, by the solid angle that they cover: see `splat`. [default: 4, min: 1, max: 16]
    candidates: u32,
    /// The most points of all maps together, candidates included, which bounds the time. If more are wanted, all maps lose the
    /// same share. [default: 33554432, min: 1, max: 1073741824]
    budget: u32,
    /// Factor on the side of a splat. Larger: fewer holes, but more time: the rays through texels meet a surfel's own triangle, so
    /// no surface grows. [default: 1.6, min: 0.0, max: 16.0]
    splat_scale: f32,
    /// How far a texel without a point looks for the nearest that has one, along its row and its column; it takes that only where
    /// there are points on all sides, so that light that leaves the scene is not reflected. 0 leaves holes dark. [default: 8,
    /// min: 0, max: 512, unit: "px"]
    fill: u32,
    seed: u32,
    /// The number of maps.
    maps: u32,
    /// The splats of all maps, where their number is padded to whole blocks.
    end: u32,
    /// Whether samples are stored, or distances.
    stores_samples: u32,
    /// The sum over a map of cosine times solid angle of its texels, over π: 1 but for the texels at its rim.
    whole: f32,
    @align(16) samples: SamplesWanted,
}

var<uniform> settings: Settings;
var<storage, read> lights: VirtualLights;
var<storage, read_write> reflected: VirtualLights;
/// The bits of the distance of the nearest sample [m]. [scratch, count: lights.count * settings.map * settings.map]
var<storage, read_write> distances: array<atomic<u32>>;
/// The index of the nearest sample. [scratch, count: lights.count * settings.map * settings.map]
var<storage, read_write> nearest: array<atomic<u32>>;
/// Luminance of the flux that texels reflect [W], in the order of a Z-shaped curve: takes the place of the distances.
var<storage, read_write> weights: array<f32>;
/// Sums along the curve in each map.
var<storage, read> texel_cdf: array<f32>;
/// Sums over the maps.
var<storage, read> map_cdf: array<f32>;

/// The most lights on a surface that maps of other lights are expected to put there, over those of lights that are spread over the
/// scene.
const MOST_SHARED: f32 = 4.0;

/// Radius over distance from which on a surfel comes near the light.
const NEAR: f32 = 0.5;

/// Index of a sample where there is none.
const NO_SAMPLE: u32 = 0xffffffffu;

@compute @workgroup_size(64)
fn clear(row: Row) {
    let index = index_in(row, 64u);
    if index < arrayLength(&nearest) {
        atomicStore(&distances[index], 0x7f800000u);
        atomicStore(&nearest[index], NO_SAMPLE);
    }
}

/// Splats twice by the same code, so that the second time finds the bits of the first: distances, and then the samples that are
/// as near as that. A thread is a splat.
@compute @workgroup_size(64)
fn splat(row: Row) {
    let index = index_in(row, 64u);
    if index >= settings.end {
        return;
    }
    let map = map_of_splat(settings.samples, settings.candidates, index);
    if map >= min(lights.count, settings.samples.maps) || all(lights.lights[map].flux == vec3(0.0)) {
        return;
    }
    let light = lights.lights[map];
    let frame = frame_from_normal(light.normal);
    // DEVIATION(candidates): the paper splats every point of a map.
    let splat = chosen(settings.samples, settings.candidates, index, map, light, frame);
    if splat.point.area <= 0.0 {
        return;
    }
    let tile = settings.map;
    // DEVIATION(surfel): the paper draws shaded squares.
    var surfel = surfel_of(splat, light, frame, tile, settings.splat_scale, f32(tile), 1.0);
    let from_light = map_distance(light.kind, splat.local);
    // The image of a triangle that comes near the light is far larger than that of a small disc: from a corner, a wall is half of
    // what is seen.
    if light.kind != INFINITELY_FAR && !surfel.is_small && surfel.radius > NEAR * from_light {
        surfel.reach = vec2(0.5 * f32(tile));
    }
    let centre = map_position(light.kind, splat.local, from_light);
    let texels = texels_about(centre, surfel.reach, tile);
    for (var i = 0u; i < texels.size.x * texels.size.y; i++) {
        let texel = texels.first + vec2(i % texels.size.x, i / texels.size.x);
        let distance = meet_surfel(surfel, map_ray(light.kind, texel_centre(texel, tile))).distance;
        if distance < 0.0 {
            continue;
        }
        let place = (map * tile + texel.y) * tile + texel.x;
        if settings.stores_samples == 0u {
            atomicMin(&distances[place], bitcast<u32>(distance));
        } else if bitcast<u32>(distance) == atomicLoad(&distances[place]) {
            atomicMin(&nearest[place], splat.sample);
        }
    }
}

/// What a texel of a map sees.
struct Seen {
    sample: u32,
    /// The texel whose ray meets it: another where this one is a hole.
    texel: vec2<u32>,
}

/// The texels of a map from one on, in a direction.
struct Look {
    found: Seen,
    /// How many texels away that is.
    distance: u32,
    /// Whether the map goes on, and nothing was found.
    is_open: bool,
}

/// Whether the ray of a texel points above the horizon, and so is part of the map.
fn is_of_map(kind: u32, at: vec2<f32>) -> bool {
    return kind == INFINITELY_FAR || dot(at, at) < 1.0;
}

fn look(map: u32, kind: u32, start: vec2<u32>, step: vec2<i32>) -> Look {
    let tile = i32(settings.map);
    for (var i = 1; i <= i32(settings.fill); i++) {
        let texel = vec2<i32>(start) + i * step;
        let is_inside = all(texel >= vec2(0)) && all(texel < vec2(tile));
        if !is_inside || !is_of_map(kind, texel_centre(vec2<u32>(texel), settings.map)) {
            return Look(Seen(NO_SAMPLE, start), 0u, false);
        }
        let sample = atomicLoad(&nearest[(i32(map) * tile + texel.y) * tile + texel.x]);
        if sample != NO_SAMPLE {
            return Look(Seen(sample, vec2<u32>(texel)), u32(i), false);
        }
    }
    return Look(Seen(NO_SAMPLE, start), 0u, true);
}

/// Returns what a texel sees; in a hole, what the nearest texel sees.
fn seen(map: u32, kind: u32, texel: vec2<u32>) -> Seen {
    let sample = atomicLoad(&nearest[(map * settings.map + texel.y) * settings.map + texel.x]);
    if sample != NO_SAMPLE {
        return Seen(sample, texel);
    }
    var best = Look(Seen(NO_SAMPLE, texel), 0xffffffffu, false);
    for (var side = 0; side < 4; side++) {
        let forth = 1 - 2 * (side & 1);
        let there = look(map, kind, texel, select(vec2(forth, 0), vec2(0, forth), side >= 2));
        if there.is_open {
            return Seen(NO_SAMPLE, texel);
        }
        if there.found.sample != NO_SAMPLE && there.distance < best.distance {
            best = there;
        }
    }
    return best.found;
}

/// The flux that arrives at a texel [W], and cosine and solid angle there.
fn share_of_texel(light: VirtualLight, at: vec2<f32>) -> f32 {
    if light.kind == INFINITELY_FAR {
        let side = far_reach() * 2.0 / f32(settings.map);
        return side * side;
    }
    return direction_from_paraboloid(at).z * paraboloid_density(at) * texel_area(settings.map) / (PI * settings.whole);
}

/// The light that a texel reflects, as a virtual light of its own.
fn reflection(map: u32, texel: vec2<u32>) -> VirtualLight {
    var made: VirtualLight;
    made.normal = vec3(0.0, 0.0, 1.0);
    made.texel = (map * settings.map + texel.y) * settings.map + texel.x;
    let at = texel_centre(texel, settings.map);
    if map >= lights.count || !is_of_map(lights.lights[map].kind, at) {
        return made;
    }
    let light = lights.lights[map];
    let seen = seen(map, light.kind, texel);
    if seen.sample == NO_SAMPLE {
        return made;
    }
    // The weights of its triangle's corners where the ray meets its plane: beyond the triangle, those of the nearest point that
    // has none below zero.
    let point = surface_sample(settings.samples, seen.sample);
    let frame = frame_from_normal(light.normal);
    let ray = map_ray(light.kind, texel_centre(seen.texel, settings.map));
    let triangle = triangle_of_scene(point.triangle);
    let corner = (triangle.corner - light.position) * frame;
    let a = map_homogeneous(light.kind, corner);
    let b = map_homogeneous(light.kind, corner + triangle.a * frame);
    let c = map_homogeneous(light.kind, corner + triangle.b * frame);
    let signed_weights = ray.image * mat3x3(cross(b, c), cross(c, a), cross(a, b));
    let corners = max(select(signed_weights, -signed_weights, dot(signed_weights, vec3(1.0)) < 0.0), vec3(0.0));
    let sum = dot(corners, vec3(1.0));
    if !(sum > 0.0) {
        return made;
    }
    let direction = normalize(frame * ray.direction);
    let is_far = light.kind == INFINITELY_FAR;
    var share = share_of_texel(light, at);
    if !is_far {
        share *= share_along(light, direction);
    }
    if share == 0.0 {
        return made;
    }
    let vertex = vertex_on_triangle(point.triangle, corners.yz / sum, direction);
    let across = select(distance(vertex.position, light.position), 1.0, is_far);
    let area = select(paraboloid_density(at) * texel_area(settings.map), share_of_texel(light, at), is_far) * across * across;
    made.position = vertex.position;
    made.normal = vertex.geometric;
    // A plane that is nearly parallel to the ray counts as if it stood at 84°, as in reflective shadow maps.
    made.area = area / max(-dot(vertex.geometric, direction), 0.1);
    made.kind = kind_on_surface(vertex.geometric, vertex.normal);
    let albedo = vertex.surface.albedo * lit_share(vertex.normal, vertex.geometric, -direction);
    made.flux = weights_of(light.flux * share * albedo);
    return made;
}

/// One thread per texel.
@compute @workgroup_size(64)
fn weigh(row: Row) {
    let index = index_in(row, 64u);
    let tile = settings.map;
    if index >= settings.maps * tile * tile {
        return;
    }
    let map = index / (tile * tile);
    let texel = place_on_curve(index - map * tile * tile);
    weights[index] = weight_of(luminance(reflection(map, texel).flux));
}

struct Distribution {
    /// Whether it is that of the maps; otherwise that of the texels of a map.
    is_of_maps: bool,
    map: u32,
}

fn cumulated(which: Distribution, i: u32) -> f32 {
    if which.is_of_maps {
        return map_cdf[i];
    }
    return texel_cdf[which.map * settings.map * settings.map + i];
}

@compute @workgroup_size(64)
fn draw(row: Row) {
    let index = index_in(row, 64u);
    if index >= settings.count {
        return;
    }
    if index == 0u {
        reflected.count = settings.count;
    }
    var light: VirtualLight;
    light.normal = vec3(0.0, 0.0, 1.0);
    // As if there were no map, where there is none.
    if settings.maps > 0u && map_cdf[settings.maps - 1u] > 0.0 {
        let numbers = sobol2_of(index, settings.seed);
        // DEVIATION(least-probability): choose bounds it from below.
        let map = choose(Distribution(true, 0u), settings.maps, numbers.x);
        let texel = choose(Distribution(false, map.index), settings.map * settings.map, numbers.y);
        light = reflection(map.index, place_on_curve(texel.index));
        // Density of lights there [1/m²]: those of this map, and those of the others, which mostly see the same surfaces, but not what
        // is lit by this map's light alone because it is near.
        let own = texel.probability / light.area;
        let density = mix(min(own, MOST_SHARED / scene_info.area), own, map.probability);
        light.area = weight_of(1.0 / (f32(settings.count) * density));
        light.flux = weights_of(light.flux / (f32(settings.count) * map.probability * texel.probability));
    }
    reflected.lights[index] = light;
}
