// Traces the lights that were placed in this frame, and gives all lights their flux. [Laine et al. 2007; ACRSM §3.2.3]

#option ALBEDO mean one_of [mean, textured] // Reflectance of what lights lie on. mean: textures are replaced by their means. textured: as they are.
#option MASKED false // whether triangles do not count where alpha is below their material's cutoff
#option TEXTURED false // whether any material of the scene has a texture

#import "dispatch.wgsl"
#import "domain.wgsl"
#import "path-vertex.wgsl"
#import "random.wgsl"
#import "slots.wgsl"
#import "surface-point.wgsl"
#import "virtual-lights.wgsl"

/// Tells the seeds of points from other random numbers.
const POINTS: u32 = 0x706fu;

struct Settings {
    count: u32,
    probes: u32,
    seed: u32,
}

var<uniform> settings: Settings;
var<storage, read> shares: array<Share>;
var<storage, read> sites: array<Site>;
var<storage, read> cells: array<Cell>;
var<storage, read> choice: Choice;
var<storage, read_write> points: SurfacePoints;
var<storage, read_write> lights: VirtualLights;

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

fn reflectance(point: SurfacePoint, direction: vec3<f32>) -> vec3<f32> {
#if ALBEDO == mean
    return mean_albedo(scene_vertices[scene_indices[3u * point.triangle]].material);
#else
    return path_vertex(Hit(0.0, point.triangle, point.barycentrics), direction).surface.albedo;
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

@compute @workgroup_size(64)
fn emit(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let slot = row_index(group, groups, local, 64u);
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
