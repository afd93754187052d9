// Keeps virtual lights while their source lights them, and places a few again where they are too far apart.
// [ACRSM §3.2.3, Laine et al. 2007]
//
// This file has the first and the last step: it shares slots out among the sources, and asks which lights of the frame before
// each source still lights; when all lights have their places, it traces those that were placed in this frame, and gives all
// lights their flux.

#input past: SurfacePoints optional // `prev` of `points`: the lights of the frame before. Without it, all are placed in each
    // frame.
#output lights: VirtualLights(count: settings.count) // A light for each slot; dark where it is on no surface.
#output points: SurfacePoints(count: settings.count) // The lights; marked and counted are those that are new in this
    // frame.

#option ALBEDO mean one_of [mean, textured] // Reflectance of what lights lie on. mean: textures are replaced by their means.
    // textured: as they are.
#option PAST false // whether there are lights of the frame before
#option MASKED false // whether triangles do not count where alpha is below their material's cutoff
#option TEXTURED false // whether any material of the scene has a texture

#import "dispatch.wgsl"
#import "domain.wgsl"
#import "horizon.wgsl"
#import "path-vertex.wgsl"
#import "random.wgsl"
#import "ray-tracing.wgsl"
#import "slots.wgsl"
#import "sobol.wgsl"
#import "surface-point.wgsl"
#import "virtual-lights.wgsl"

/// Separates the first places from the probes: where a run has the seed 0, all random numbers are the same.
const FIRST_PLACES: u32 = 0x6669u;

/// Separates the seeds of points from other random numbers.
const POINTS: u32 = 0x706fu;

struct Settings {
    /// Number I of virtual lights. Error falls as I^-½; the time for shadows and gathering rises with I, that for cells with
    /// I². [default: 2048, min: 1, max: 4096]
    count: u32,
    /// The most lights that are placed in a frame; Laine et al. have 4 to 8. More: lights follow their source sooner, and
    /// flicker more. [default: 8, min: 1, max: 256]
    moved: u32,
    /// Directions for each light, by which cells are counted. More: fluxes follow the areas of cells more closely, and the time
    /// for cells grows. [default: 64, min: 1, max: 256]
    probes: u32,
    seed: u32,
}

var<uniform> settings: Settings;
#if PAST
var<storage, read> past: SurfacePoints;
#endif
var<storage, read_write> points: SurfacePoints;
var<storage, read_write> lights: VirtualLights;
/// [scratch, count: settings.count]
var<storage, read_write> shares: array<Share>;
/// [scratch, count: settings.count]
var<storage, read_write> sites: array<Site>;
var<storage, read> cells: array<Cell>;
var<storage, read> choice: Choice;

/// The power of a source, of which all together have a finite sum.
fn bounded_power(source: u32) -> f32 {
    return min(power_of(scene_lights.lights[source]), FAR / f32(scene_lights.count));
}

/// The share of a slot. Every source that shines has a slot, and the rest is shared out by power. Where there are more sources
/// than slots, a slot is of the source at its place in the sum of all powers, and stands for those that have none.
fn share_of(slot: u32) -> Share {
    var total = 0.0;
    var lit = 0u;
    for (var i = 0u; i < scene_lights.count; i++) {
        let power = bounded_power(i);
        total += power;
        lit += select(0u, 1u, power > 0.0);
    }
    let slots = settings.count;
    let is_short = lit > slots;
    var sum = 0.0;
    var before = 0u;
    var first = 0u;
    for (var i = 0u; i < scene_lights.count; i++) {
        let power = bounded_power(i);
        if !(power > 0.0) {
            continue;
        }
        sum += power;
        before++;
        let part = min(sum / total, 1.0);
        var end = before + u32(floor(f32(slots - min(lit, slots)) * part + 0.5));
        if is_short {
            end = u32(max(ceil(f32(slots) * part - 0.5), 0.0));
        }
        if before == lit {
            end = slots;
        }
        if slot < end {
            let own = f32(end - first);
            let weight = select(1.0, own / f32(slots) * (total / power), is_short);
            return Share(i, first, end, weight, own / domain_area(scene_lights.lights[i]));
        }
        first = end;
    }
    return Share(NO_SOURCE, 0u, 0u, 0.0, 0.0);
}

/// Whether light comes to a point from a place of the domain, in which the point lies.
fn is_lit(light: Light, place: vec3<f32>, point: SurfacePoint) -> bool {
    let origin = beam_of(light, place).origin;
    let way = point.position - origin;
    let distance = length(way);
    // A light that was placed where a ray grazes the surface stays, in spite of rounding.
    if !(distance > 0.0 && dot(point.normal, way) <= 1e-4 * distance) {
        return false;
    }
    let size = abs(point.position);
    let rounding = max(max(max(size.x, size.y), size.z), scene_info.extent) * 0x1p-16f;
    return !occluded(origin, way, 1e-6 * scene_info.extent / distance, 1.0 - rounding / distance);
}

/// The site of a light of the frame before: one that waits, where the source does not light it any more.
fn verified(light: Light, point: SurfacePoint) -> Site {
    let lost = Site(NOWHERE, SITE_WAITING);
    if point.triangle == NO_TRIANGLE {
        if all(point.normal == vec3(0.0)) {
            return lost;
        }
        // A ray that met nothing: it keeps its part of the domain dark, as long as it meets nothing.
        var place = -point.normal;
        if light.kind == LIGHT_DIRECTIONAL {
            place = place_towards(light, point.position);
        }
        if !is_in_domain(light, place) {
            return lost;
        }
        let beam = beam_of(light, place);
        let meets = occluded(beam.origin, beam.direction, 1e-6 * scene_info.extent, FAR);
        return Site(select(place, NOWHERE, meets), select(SITE_KEPT, SITE_WAITING, meets));
    }
    let place = place_towards(light, point.position);
    if !is_in_domain(light, place) || !is_lit(light, place, point) {
        return lost;
    }
    return Site(place, SITE_KEPT);
}

/// Begins a frame: which source each slot is of, and which lights stay.
@compute @workgroup_size(64)
fn verify(row: Row) {
    let slot = index_in(row, 64u);
    if slot >= settings.count {
        return;
    }
    var known = 0u;
    var iteration = 0u;
    var point = no_point();
#if PAST
    known = past.header.count;
    iteration = select(0u, past.header.iteration + 1u, known > 0u);
    if slot < known {
        // DEVIATION(moving): lights ride on what moves, and are hidden by it.
        point = followed(past.points[slot]);
    }
#endif
    let share = share_of(slot);
    var site = Site(NOWHERE, SITE_ABSENT);
    if share.source != NO_SOURCE {
        let light = scene_lights.lights[share.source];
        if known == 0u {
            let seed = hash2(hash2(settings.seed, FIRST_PLACES), share.source);
            site = Site(place_of(light, sobol2_of(slot - share.first, seed)), SITE_NEW);
        } else {
            site = verified(light, point);
        }
    }
    if site.state != SITE_KEPT {
        point = no_point();
    }
    point.mark = 0u;
    points.points[slot] = point;
    shares[slot] = share;
    sites[slot] = site;
    if slot == 0u {
        points.header = SurfacePointsHeader(settings.count, iteration, 0u, 0u);
    }
}

/// The point that the ray of a place meets; without a triangle, where the ray begins and the way that it came, if it meets none.
fn met(light: Light, place: vec3<f32>, seed: u32) -> SurfacePoint {
    let beam = beam_of(light, place);
    // A light that lies on a surface shines from it.
    let hit = trace(beam.origin, beam.direction, 1e-6 * scene_info.extent, FAR);
    var point = no_point();
    if hit.triangle == NO_HIT {
        point.position = beam.origin;
        point.normal = -beam.direction;
        point.seed = seed;
    } else {
        point = surface_point(hit.triangle, hit.barycentrics, beam.direction, seed);
    }
    point.mark = 1u;
    return point;
}

/// The share of the light along a direction that a point reflects.
fn reflectance(point: SurfacePoint, direction: vec3<f32>) -> vec3<f32> {
#if ALBEDO == mean
    return mean_albedo(scene_vertices[scene_indices[3u * point.triangle]].material);
#else
    let vertex = path_vertex(Hit(0.0, point.triangle, point.barycentrics), direction);
    let lit = lit_share(vertex.normal, vertex.geometric, -direction);
    // What leaves, without the directions of a horizon: a light stands for the places around it, whose normals bend otherwise.
    return vertex.surface.albedo * lit * share_above(vertex.geometric, vertex.normal);
#endif
}

/// The virtual light of a slot.
fn virtual_light(slot: u32, point: SurfacePoint) -> VirtualLight {
    var light: VirtualLight;
    light.texel = point.triangle;
    light.normal = vec3(0.0, 0.0, 1.0);
    if point.triangle == NO_TRIANGLE {
        return light;
    }
    light.position = point.position;
    light.normal = point.normal;
    let share = shares[slot];
    let source = scene_lights.lights[share.source];
    let way = point.position - source.position;
    var direction = unit(way);
    var distance2 = dot(way, way);
    if source.kind == LIGHT_DIRECTIONAL {
        direction = source.direction;
        distance2 = 1.0;
    }
    // DEVIATION(cells): counted by probes.
    let each = 1.0 / (f32(share.end - share.first) * f32(settings.probes));
    let measure = measure_of(source);
    let cosine = max(-dot(point.normal, direction), 1e-4);
    light.area = min(weight_of(f32(cells[slot].probes) * each * measure * distance2 / cosine), scene_info.area);
    let shine = f32(cells[slot].shine) / f32(shine_unit(settings.count * settings.probes));
    let flux = source.intensity * (shine * each * measure * share.weight) * reflectance(point, direction);
    light.flux = vec3(weight_of(flux.r), weight_of(flux.g), weight_of(flux.b));
    return light;
}

/// Ends a frame: the point and the flux of each light.
@compute @workgroup_size(64)
fn emit(row: Row) {
    let slot = index_in(row, 64u);
    if slot >= settings.count {
        return;
    }
    var point = points.points[slot];
    let site = sites[slot];
    if site.state == SITE_NEW {
        let seed = hash2(hash2(hash2(settings.seed, POINTS), points.header.iteration), slot);
        point = met(scene_lights.lights[shares[slot].source], site.place, seed);
    }
    points.points[slot] = point;
    lights.lights[slot] = virtual_light(slot, point);
    if slot == 0u {
        points.header.marked = choice.new_lights;
        lights.count = settings.count;
    }
}
