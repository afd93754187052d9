// The triangles of the scene, and the shape of one.

#import "scene.wgsl"

/// The corners of a triangle, in world space [m].
struct Triangle {
    /// The first vertex.
    corner: vec3<f32>,
    /// The edge from it to the second.
    a: vec3<f32>,
    /// The edge from it to the third.
    b: vec3<f32>,
}

/// Returns a triangle of the scene in world space [m].
fn triangle_of_scene(index: u32) -> Triangle {
    let corner = scene_vertices[scene_indices[3u * index]].position;
    let a = scene_vertices[scene_indices[3u * index + 1u]].position - corner;
    let b = scene_vertices[scene_indices[3u * index + 2u]].position - corner;
    return Triangle(corner, a, b);
}

/// Geometric normal, unit, in xyz, and area [m²] in w of the triangle with these edges [m]; zeros where it has no area.
/// The edges are scaled first: the squares of their product leave the range of f32 in scenes of 1e-3 or 1e6 m.
fn normal_and_area(a: vec3<f32>, b: vec3<f32>) -> vec4<f32> {
    let longest = max(abs(a), abs(b));
    let scale = max(longest.x, max(longest.y, longest.z));
    if scale == 0.0 {
        return vec4(0.0);
    }
    let across = cross(a / scale, b / scale);
    let length = length(across);
    if length == 0.0 {
        return vec4(0.0);
    }
    return vec4(across / length, 0.5 * length * scale * scale);
}
