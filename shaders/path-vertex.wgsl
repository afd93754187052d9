// The surface that a ray meets.

#import "ray-tracing.wgsl"
#import "vertex-on-triangle.wgsl"

/// Returns the vertex where a ray along `direction` hit. Textures are read at their finest level.
fn path_vertex(hit: Hit, direction: vec3<f32>) -> PathVertex {
    return vertex_on_triangle(hit.triangle, hit.barycentrics, direction);
}
