// Computes the radiosity of points on surfaces by paths from them, and keeps what it knows. [SMC-IR §3.2.3]
//
// It is the direct light of the scene's lights, and the mean over paths of what else arrives. Paths have next-event estimation
// at each of their surfaces, of the lights and of the surfaces that emit; a point has that of the latter for each of its paths.
// All surfaces are diffuse (SMC-IR §3.1). The random numbers of a point come from its own seed alone: neither its index nor the
// frame changes what it is.

#input points: SurfacePoints // The points whose radiosity is computed.
#input past: Radiosity optional // The radiosity that is known: `prev` of the output, reset by `Scene`, `Reload`, `Setting` and `Moved`.
#output radiosity: Radiosity(count: points.count) // The radiosity of each point.
#lights

#option PAST false // whether there are radiosities of earlier frames
#option ALBEDO mean one_of [mean, textured] // Reflectance of surfaces that paths meet. mean: textures are replaced by their
    // means, as SMC-IR §5 does. textured: as they are.
#option EMISSIVE false // whether any surface emits
#option MASKED false // whether triangles do not count where alpha is below their material's cutoff
#option TEXTURED false // whether any material of the scene has a texture

#import "diffuse-reflectance.wgsl"
#import "dispatch.wgsl"
#import "hemisphere.wgsl"
#import "point-radiosity.wgsl"
#import "reflected-light.wgsl"
#import "sobol.wgsl"
#import "surface-point.wgsl"
#import "tangent-frame.wgsl"
#if EMISSIVE
#import "emitted-light.wgsl"

/// Segments of a path beyond those of its bounces: the last may meet what emits.
const EMITTED_SEGMENTS: u32 = 1u;
/// Separates the random numbers by which emitters are sampled from those of directions, one sequence a segment each.
const EMITTERS: u32 = 0x656du;
#else
const EMITTED_SEGMENTS: u32 = 0u;
#endif

struct Settings {
    /// Number N of paths of a point. More: less noise, which falls as N^-½; time grows with N. [default: 16, min: 1, max: 1024]
    paths: u32,
    /// Bounces of light, from the lights of the scene to where it leaves the points: 1 is direct light that they
    /// reflect. More: brighter, and more time. [default: 3, min: 1, max: 63]
    bounces: u32,
}

var<uniform> settings: Settings;
var<storage, read> points: SurfacePoints;
#if PAST
var<storage, read> past: PointRadiosities;
#endif
/// Radiance that arrives along each path, times π [W/m²]: the paths of a point are neighbours.
/// [scratch, count: points.count * settings.paths]
var<storage, read_write> arriving: array<vec4<f32>>;
var<storage, read_write> radiosity: PointRadiosities;

/// Segments of a path: one for each bounce but the first, and one more where surfaces emit.
fn segments() -> u32 {
    return settings.bounces - 1u + EMITTED_SEGMENTS;
}

/// The key of a point: its radiosity follows from it while neither lights nor geometry move. No point has the key 0.
fn key_of(point: SurfacePoint) -> u32 {
    return max(hash2(hash2(point.seed, settings.paths), settings.bounces), 1u);
}

/// Whether the radiosity of a point is known from an earlier frame.
fn is_kept(index: u32, point: SurfacePoint) -> bool {
#if PAST
    return index < arrayLength(&past.radiosities) && past.radiosities[index].key == key_of(point);
#else
    return false;
#endif
}

/// The surface where a path is, as it scatters light.
fn diffuse_vertex(hit: Hit, direction: vec3<f32>) -> PathVertex {
    var vertex = path_vertex(hit, direction);
#if ALBEDO == mean
    vertex.surface.albedo = mean_albedo(scene_vertices[scene_indices[3u * hit.triangle]].material);
#endif
    return vertex;
}

/// A point as the beginning of a path.
fn diffuse_point(point: SurfacePoint, albedo: vec3<f32>) -> PathVertex {
    return PathVertex(point.position, point.normal, point.normal, Surface(albedo, vec3(0.0), 1.0, vec3(0.0)));
}

/// Light that arrives along one path at a point, but for that of the scene's lights: π times the radiance [W/m²].
fn arriving_along(point: SurfacePoint, path: u32) -> vec3<f32> {
    var sum = vec3(0.0);
    var throughput = vec3(1.0);
    // Its reflectance is that of all paths together.
    var vertex = diffuse_point(point, vec3(1.0));
    for (var segment = 1u; segment <= segments(); segment++) {
#if EMISSIVE
        let place = sobol2_bits_of(path, hash2(point.seed, EMITTERS + segment));
        sum += throughput * PI * reflected_emission(vertex, vertex.normal, place);
#endif
        throughput *= vertex.surface.albedo;
        if !any(throughput > vec3(0.0)) {
            break;
        }
        let square = sobol2_of(path, hash2(point.seed, segment));
        let direction = frame_from_normal(vertex.normal) * by_cosine(square);
        // Light arrives from the side of the surface, not of a bent normal alone.
        if dot(vertex.geometric, direction) <= 0.0 {
            break;
        }
        let hit = trace(offset_origin(vertex.position, vertex.geometric), direction, 0.0, FAR);
        if hit.triangle == NO_HIT {
            break;
        }
        let met = diffuse_vertex(hit, direction);
        // With directions by the cosine, the mean of π times the radiance that arrives is the irradiance.
#if EMISSIVE
        if any(met.surface.emission > vec3(0.0)) {
            let density = scatter_density(vertex, vertex.normal, direction);
            let share = met_share(hit.triangle, met, vertex.position, direction, density);
            sum += throughput * PI * (share * met.surface.emission);
        }
#endif
        if segment < settings.bounces {
            sum += throughput * PI * reflected_light(met, -direction);
        }
        vertex = met;
    }
    return sum;
}

/// Traces a path in each thread, where paths have segments.
/// [threads: points.count * settings.paths, repeat: min(1, settings.bounces - 1 + EMITTED_SEGMENTS)]
@compute @workgroup_size(64)
fn trace_paths(row: Row) {
    let index = index_in(row, 64u);
    let owner = index / settings.paths;
    if owner >= min(points.header.count, arrayLength(&points.points)) {
        return;
    }
    let point = points.points[owner];
    if point.triangle == NO_TRIANGLE || is_kept(owner, point) {
        return;
    }
    arriving[index] = vec4(arriving_along(point, index % settings.paths), 0.0);
}

@compute @workgroup_size(64)
fn collect(row: Row) {
    let index = index_in(row, 64u);
    if index >= arrayLength(&radiosity.radiosities) {
        return;
    }
    var known = PointRadiosity();
    if index < min(points.header.count, arrayLength(&points.points)) {
        let point = points.points[index];
#if PAST
        if is_kept(index, point) {
            radiosity.radiosities[index] = past.radiosities[index];
            return;
        }
#endif
        if point.triangle != NO_TRIANGLE {
            known = PointRadiosity(radiosity_of(index, point), key_of(point));
        }
    }
    radiosity.radiosities[index] = known;
}

/// Radiosity of a point [W/m²] by the lights of the scene and its paths.
fn radiosity_of(index: u32, point: SurfacePoint) -> vec3<f32> {
    var sum = vec3(0.0);
    if segments() > 0u {
        // A bound that is no uniform: lavapipe compiles a dispatch again to unroll loops that a uniform ends.
        let first = index * settings.paths;
        let end = min(first + settings.paths, arrayLength(&arriving));
        for (var path = first; path < end; path++) {
            sum += arriving[path].rgb;
        }
    }
    let albedo = albedo_of(point);
    // DEVIATION(direct): the paper's paths have each an estimate of their own.
    return albedo * sum / f32(settings.paths) + PI * reflected_light(diffuse_point(point, albedo), point.normal);
}
