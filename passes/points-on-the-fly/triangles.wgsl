// The areas and edges on which the number of a triangle's points depends, of the triangles as they are in this frame.

#import "scene.wgsl"
#import "triangle.wgsl"

struct Measured {
    /// [m²]
    area: f32,
    /// [m]
    edges: vec3<f32>,
}

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
