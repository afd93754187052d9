// Points on the triangles that emit, sampled by one of the tables of scene_emitters.
//
// A file that imports this one says by which: it defines where the numbers of an emitter begin, `fn interval_start(emitter:
// u32) -> u32`, for all emitters and for what follows the last. The table is of the scene at rest; areas are those of now.

#option MASKED false // whether triangles do not count where alpha is below their material's cutoff
#option TEXTURED false // whether any material of the scene has a texture

#import "path-vertex.wgsl"
#import "random.wgsl"
#import "triangle-samples.wgsl"
#import "triangle.wgsl"

struct EmitterPoint {
    /// World space [m].
    position: vec3<f32>,
    /// Unit normal of the triangle. Its sign means nothing: both sides emit.
    normal: vec3<f32>,
    /// Index of the triangle.
    triangle: u32,
    /// [1/m²] 0 where there is nothing to sample.
    density: f32,
    /// Emitted radiance [W/(m² sr)].
    radiance: vec3<f32>,
}

/// Whether any emitter is sampled.
fn emitters_are_sampled() -> bool {
    return interval_start(scene_emitters.count) > 0u;
}

/// Density [1/m²] with which points of an emitter of this area are sampled.
fn density_of_emitter(emitter: u32, area: f32) -> f32 {
    if !(area > 0.0) {
        return 0.0;
    }
    let probability = f32(interval_start(emitter + 1u) - interval_start(emitter)) * 0x1p-32f;
    return min(probability / area, FAR);
}

/// Density [1/m²] with which points of a triangle are sampled; 0 where it is no emitter.
fn density_of_triangle(triangle: u32) -> f32 {
    var low = 0u;
    var high = scene_emitters.count;
    while low < high {
        let middle = (low + high) / 2u;
        if scene_emitters.emitters[middle].triangle < triangle {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    // After the last emitter stands an entry of no triangle.
    if scene_emitters.emitters[low].triangle != triangle {
        return 0.0;
    }
    let edges = triangle_of_scene(triangle);
    return density_of_emitter(low, normal_and_area(edges.a, edges.b).w);
}

/// A point of an emitter, by a place in the unit square in fixed point, where `emitters_are_sampled`.
fn sample_emitter(place: vec2<u32>) -> EmitterPoint {
    // Tables end at 2^32 - 1, which is in no interval.
    let number = min(place.x, 0xfffffffeu);
    let emitter = triangle_at(number, 0u, scene_emitters.count - 1u);
    let start = interval_start(emitter);
    let width = max(interval_start(emitter + 1u) - start, 1u);
    let within = min((f32(number - start) + 0.5) / f32(width), 1.0);
    let barycentrics = triangle_from_square(vec2(within, unit_float(place.y)));

    let triangle = scene_emitters.emitters[emitter].triangle;
    let edges = triangle_of_scene(triangle);
    let shape = normal_and_area(edges.a, edges.b);
    var point: EmitterPoint;
    point.position = edges.corner + edges.a * barycentrics.x + edges.b * barycentrics.y;
    point.normal = shape.xyz;
    point.triangle = triangle;
    point.density = density_of_emitter(emitter, shape.w);
    let material = scene_vertices[scene_indices[3u * triangle]].material;
    let uv = uv_on_triangle(triangle, barycentrics);
    point.radiance = surface(material, uv, vec2(0.0), vec2(0.0)).emission;
#if MASKED
    if !surface_exists(material, uv) {
        point.radiance = vec3(0.0);
    }
#endif
    return point;
}
