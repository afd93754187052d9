// Levels of a tessellator, which rise with the areas and edges of triangles as they are in this frame (ACRSM Eq. 5.3-5.4).

#import "scene.wgsl"
#import "triangle.wgsl"

struct Measured {
    /// [m²]
    area: f32,
    /// Lengths of the edges from the first vertex to the second, from it to the third, and between these [m].
    edges: vec3<f32>,
}

/// The area and edges of a triangle.
fn measured(index: u32) -> Measured {
    let triangle = triangle_of_scene(index);
    let across = triangle.b - triangle.a;
    let edges = vec3(length(triangle.a), length(triangle.b), length(across));
    return Measured(normal_and_area(triangle.a, triangle.b).w, edges);
}

/// The least and greatest values over all triangles that have an area. If the least is above the greatest, there are
/// none.
struct Bounds {
    /// [m²]
    areas: vec2<f32>,
    /// [m]
    edges: vec2<f32>,
}

struct TessellationLevels {
    /// In the order of `Measured`.
    edges: vec3<u32>,
    inside: u32,
}

/// The levels of a triangle. `factors` are the least and the greatest.
fn tessellation_levels(bounds: Bounds, triangle: Measured, factors: vec2<u32>) -> TessellationLevels {
    let edges = vec3(
        level(bounds.edges, triangle.edges.x, factors),
        level(bounds.edges, triangle.edges.y, factors),
        level(bounds.edges, triangle.edges.z, factors),
    );
    return TessellationLevels(edges, level(bounds.areas, triangle.area, factors));
}

/// The level of a value between two bounds, smoothed. If the bounds are equal, it is the greatest level.
fn level(bounds: vec2<f32>, value: f32, factors: vec2<u32>) -> u32 {
    var smoothed = 1.0;
    if bounds.y > bounds.x {
        let x = clamp((value - bounds.x) / (bounds.y - bounds.x), 0.0, 1.0);
        smoothed = x * x * (3.0 - 2.0 * x);
    }
    return max(u32(ceil(smoothed * f32(factors.y))), factors.x);
}
