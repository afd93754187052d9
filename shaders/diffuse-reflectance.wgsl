// Reflection at surfaces, and the next direction of paths, if all surfaces are diffuse.

#import "color.wgsl"
#import "path-vertex.wgsl"

/// The bidirectional reflectance [1/sr].
fn reflectance(vertex: PathVertex, to_light: vec3<f32>, leaving: vec3<f32>) -> vec3<f32> {
    return vertex.surface.albedo / PI;
}

/// Density [1/sr] of a direction, unit, that is sampled by its cosine; 0 below the surface.
fn scatter_density(vertex: PathVertex, leaving: vec3<f32>, direction: vec3<f32>) -> f32 {
    return max(dot(vertex.normal, direction), 0.0) / PI;
}
