// Puts virtual lights where photons from the scene's lights meet surfaces, bounce after bounce. [SMC-IR §5.1, Keller 1997]
//
// A path owns as many neighbouring places as there are bounces; where it leaves the scene, the rest of them are dark. So lights
// keep their places from frame to frame, and move only as what they were traced from moves.

#input iteration: SurfacePoints optional // Points whose iteration chooses the sequence of photons; where they are a whole fraction of
    // what there is room for, so are the photons. Without it, the sequence is the same in every frame.
#output lights: VirtualLights(count: settings.count) // A light for each photon and bounce; dark where it left the scene.
#lights

#option ITERATION false // whether each iteration has photons of its own
#if ITERATION
#output points: SurfacePoints(count: settings.count) // With `iteration`, the places of the lights; empty where a light is dark.
#endif
#option ALBEDO mean one_of [mean, textured] // Reflectance of what photons meet. mean: textures are replaced by their means, as
    // SMC-IR §5 does. textured: as they are.
#option EMISSIVE false // whether any surface emits
#option MASKED false // whether triangles do not count where alpha is below their material's cutoff
#option TEXTURED false // whether any material of the scene has a texture

#import "algorithms/scaled.wgsl"
#import "color.wgsl"
#import "dispatch.wgsl"
#import "hemisphere.wgsl"
#import "horizon.wgsl"
#import "light-power.wgsl"
#import "lights.wgsl"
#import "path-vertex.wgsl"
#import "sobol.wgsl"
#import "surface-point.wgsl"
#import "tangent-frame.wgsl"
#import "virtual-lights.wgsl"
#if EMISSIVE
#import "emitters.wgsl"

/// Separates the random numbers by which emitters are sampled from those of directions, one sequence a bounce.
const EMITTERS: u32 = 0x656du;
#endif

struct Settings {
#if ITERATION
    iteration_count: u32,
#endif
    /// Number N of virtual lights. Error falls as N^-½; the time for shadows and gathering rises with N. [default: 2048,
    /// min: 1, max: 2097152]
    count: u32,
    /// Bounces of indirect light, each of which has a share of the lights: N / `bounces` photons are traced. More:
    /// brighter, and fewer photons. [default: 3, min: 1, max: 63]
    bounces: u32,
    seed: u32,
}

var<uniform> settings: Settings;
var<storage, read_write> lights: VirtualLights;
#if ITERATION
var<storage, read> iteration: SurfacePoints;
var<storage, read_write> points: SurfacePoints;
#endif

/// The seed of all sequences.
fn seed() -> u32 {
#if ITERATION
    return hash2(settings.seed, iteration.header.iteration);
#else
    return settings.seed;
#endif
}

/// The places of lights in this iteration.
fn places() -> u32 {
#if ITERATION
    let fraction = max(settings.iteration_count / max(iteration.header.count, 1u), 1u);
    // A path at least, where there is room for one.
    return max(settings.count / fraction, min(settings.count, settings.bounces));
#else
    return settings.count;
#endif
}

/// The start of a photon.
struct Emission {
    position: vec3<f32>,
    /// Unit.
    direction: vec3<f32>,
    /// Intensity of the light towards there, over the probability density of the direction [W]; of a directional light,
    /// irradiance times the area that photons begin on; of an emitter, radiance times cosine, over the densities of place and
    /// direction.
    flux: vec3<f32>,
}

// DEVIATION(sequence): Owen-scrambled Sobol' points; Keller has Halton's.
/// A photon of a light, by a place in the unit square.
fn emitted(light: Light, square: vec2<f32>) -> Emission {
    if light.kind == LIGHT_DIRECTIONAL {
        let layer = scene_light_layers[light.first_layer];
        let plane = (2.0 * square - 1.0) * layer.half_extent;
        let at = (layer.world_from_layer * vec4(plane, 0.0, 1.0)).xyz;
        return Emission(at, light.direction, light.intensity * measure_of(light));
    }
    let direction = frame_from_normal(light.direction) * direction_about_z(square.x * light.cap_sampled, square.y);
    return Emission(light.position, direction, light_intensity(light, direction) * measure_of(light));
}

#if EMISSIVE
fn interval_start(emitter: u32) -> u32 {
    return scene_emitters.emitters[emitter].for_photons;
}

/// A photon of an emitter, from either side, by the path's place in the sequences. It is one of `shares` that bring the flux.
fn emitted_by_surface(path: u32, shares: f32) -> Emission {
    let point = sample_emitter(sobol2_bits_of(path, hash2(seed(), EMITTERS)));
    let square = sobol2_of(path, seed());
    let side = select(point.normal, -point.normal, square.x < 0.5);
    let direction = frame_from_normal(side) * by_cosine(vec2(fract(2.0 * square.x), square.y));
    var flux = vec3(0.0);
    if point.density > 0.0 {
        // The direction's density is cosine / 2π: a half on either side. Bounded factors first.
        flux = point.radiance * (2.0 * PI / point.density / shares);
    }
    return Emission(offset_origin(point.position, side), direction, flux);
}
#endif

/// The first photon of a path. Paths are shared out among the lights, and the emitters as one more, by their power.
fn first_photon(path: u32, paths: u32) -> Emission {
    var total = 0.0;
    for (var i = 0u; i < scene_lights.count; i++) {
        total += power_of(scene_lights.lights[i]);
    }
#if EMISSIVE
    let of_emitters = min(scene_emitters.power, MOST_POWER);
    total += of_emitters;
#endif
    if !(total > 0.0) {
        return Emission(vec3(0.0), vec3(0.0, 0.0, 1.0), vec3(0.0));
    }
    let wanted = (f32(path) + 0.5) / f32(paths) * total;
    var sum = 0.0;
    var chosen = 0u;
    var share = 1.0;
    for (var i = 0u; i < scene_lights.count; i++) {
        let power = power_of(scene_lights.lights[i]);
        // Rounding may leave the last paths beyond the sum: they are of the last light that shines.
        if power > 0.0 && sum <= wanted {
            chosen = i;
            share = power / total;
        }
        sum += power;
    }
#if EMISSIVE
    if of_emitters > 0.0 && sum <= wanted {
        return emitted_by_surface(path, of_emitters / total * f32(paths));
    }
#endif
    var photon = emitted(scene_lights.lights[chosen], sobol2_of(path, seed()));
    photon.flux /= share * f32(paths);
    return photon;
}

/// Puts a light of a kind where a photon met a surface.
fn put(place: u32, point: SurfacePoint, flux: vec3<f32>, kind: u32) {
    var light: VirtualLight;
    light.position = point.position;
    light.normal = point.normal;
    light.texel = point.triangle;
    light.flux = weights_of(flux);
    light.kind = kind;
    lights.lights[place] = light;
#if ITERATION
    points.points[place] = point;
#endif
}

/// Leaves a place dark.
fn put_nothing(place: u32) {
    var point = no_point();
    point.normal = vec3(0.0, 0.0, 1.0);
    put(place, point, vec3(0.0), ON_SURFACE);
}

/// Writes the lights of a path.
fn deposit(path: u32, paths: u32) {
    let photon = first_photon(path, paths);
    var origin = photon.position;
    var direction = photon.direction;
    var flux = photon.flux;
    // A light that lies on a surface shines from it.
    var nearest = 1e-6 * scene_info.extent;
    for (var bounce = 0u; bounce < settings.bounces; bounce++) {
        let place = path * settings.bounces + bounce;
        var hit = Hit(0.0, NO_HIT, vec2(0.0));
        if any(flux > vec3(0.0)) {
            hit = trace(origin, direction, nearest, FAR);
        }
        if hit.triangle == NO_HIT {
            flux = vec3(0.0);
            put_nothing(place);
            continue;
        }
        let point = surface_point(hit.triangle, hit.barycentrics, direction, hash2(seed(), place));
        var bent = point.normal;
#if ALBEDO == mean
        flux *= mean_albedo(scene_vertices[scene_indices[3u * hit.triangle]].material);
#else
        let vertex = path_vertex(hit, direction);
        flux *= vertex.surface.albedo * lit_share(vertex.normal, vertex.geometric, -direction);
        bent = vertex.normal;
#endif
        put(place, point, flux, kind_on_surface(point.normal, bent));
        let square = sobol2_of(path, hash2(seed(), bounce + 1u));
        direction = frame_from_normal(point.normal) * by_cosine(square);
        if dot(bent, direction) < 0.0 {
            flux = vec3(0.0);
        }
        origin = offset_origin(point.position, point.normal);
        nearest = 0.0;
    }
}

/// Traces a path in each thread. [threads: settings.count / settings.bounces]
@compute @workgroup_size(64)
fn trace_photons(row: Row) {
    let path = index_in(row, 64u);
    let places = places();
    let paths = places / settings.bounces;
    if path < paths {
        deposit(path, paths);
    }
    if path == 0u {
        lights.count = places;
        for (var rest = paths * settings.bounces; rest < places; rest++) {
            put_nothing(rest);
        }
#if ITERATION
        points.header = SurfacePointsHeader(places, iteration.header.iteration, 0u, 0u);
#endif
    }
}
