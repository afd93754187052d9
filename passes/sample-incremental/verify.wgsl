// Shares slots out among the sources, and asks which lights of the frame before each source still lights.
// [Laine et al. 2007; ACRSM §3.2.3]

#option PAST false // whether there are lights of the frame before
#option MASKED false // whether triangles do not count where alpha is below their material's cutoff
#option TEXTURED false // whether any material of the scene has a texture

#import "dispatch.wgsl"
#import "domain.wgsl"
#import "ray-tracing.wgsl"
#import "slots.wgsl"
#import "sobol.wgsl"
#import "surface-point.wgsl"

/// Tells the first places from the probes: where a run has the seed 0, all random numbers are the same.
const FIRST_PLACES: u32 = 0x6669u;

struct Settings {
    count: u32,
    seed: u32,
}

var<uniform> settings: Settings;
#if PAST
var<storage, read> past: SurfacePoints;
#endif
var<storage, read_write> points: SurfacePoints;
var<storage, read_write> shares: array<Share>;
var<storage, read_write> sites: array<Site>;

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

@compute @workgroup_size(64)
fn verify(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let slot = row_index(group, groups, local, 64u);
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
