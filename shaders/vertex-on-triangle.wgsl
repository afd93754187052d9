// A point of a triangle as a ray meets it: where it is, which way it faces, what it is made of.

#option TEXTURED false // whether any material of the scene has a texture

#import "surface.wgsl"

struct PathVertex {
    /// World space [m].
    position: vec3<f32>,
    /// Unit normal of the triangle, on the side from which the ray came. Light arrives and leaves on this side alone.
    geometric: vec3<f32>,
    /// For shading, unit, on the same side.
    normal: vec3<f32>,
    surface: Surface,
}

/// Returns the vertex on a triangle, at these weights of its second and third corner, where a ray along `direction` meets it.
/// Textures are read at their finest level.
fn vertex_on_triangle(triangle: u32, barycentrics: vec2<f32>, direction: vec3<f32>) -> PathVertex {
    let a = scene_vertices[scene_indices[3u * triangle]];
    let b = scene_vertices[scene_indices[3u * triangle + 1u]];
    let c = scene_vertices[scene_indices[3u * triangle + 2u]];
    let weights = vec3(1.0 - barycentrics.x - barycentrics.y, barycentrics);
    let to_b = b.position - a.position;
    let to_c = c.position - a.position;
    var vertex: PathVertex;
    // From the triangle, not along the ray: as exact as the triangle itself, however far the ray came.
    vertex.position = a.position + to_b * weights.y + to_c * weights.z;
    vertex.geometric = unit(cross(unit(to_b), unit(to_c)));
    if dot(vertex.geometric, direction) > 0.0 {
        vertex.geometric = -vertex.geometric;
    }
    let uv = weights.x * a.uv + weights.y * b.uv + weights.z * c.uv;
    vertex.surface = surface(a.material, uv, vec2(0.0), vec2(0.0));
    let interpolated = weights.x * a.normal + weights.y * b.normal + weights.z * c.normal;
    let change = Change(to_b, to_c, b.uv - a.uv, c.uv - a.uv);
    vertex.normal =
        shading_normal_on_triangle(a.material, smooth_normal(interpolated, vertex.geometric), uv, change);
    // A surface whose shading normal turns away reflects nothing to where the ray came from.
    if dot(vertex.normal, direction) >= 0.0 {
        vertex.surface.albedo = vec3(0.0);
        vertex.surface.specular = vec3(0.0);
    }
    return vertex;
}
