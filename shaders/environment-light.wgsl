// The light of the environment that the surfaces along a path reflect: by sampling the environment, and by paths that leave the
// scene. What both may find is weighted by the balance heuristic. [Veach & Guibas 1995]
//
// A file that imports this one imports also how surfaces reflect and where paths go on: scatter.wgsl.

#import "environment-samples.wgsl"
#import "path-vertex.wgsl"

/// Radiance that a surface reflects of the environment [W/(m² sr)], by one direction: that share of it which `leaving_share`
/// leaves. `leaving` points to where it goes, unit.
fn reflected_environment(vertex: PathVertex, leaving: vec3<f32>, place: vec2<u32>) -> vec3<f32> {
    let sample = sample_environment(place);
    let cosine = dot(vertex.normal, sample.direction);
    if !(cosine > 0.0 && dot(vertex.geometric, sample.direction) > 0.0 && sample.density > 0.0) {
        return vec3(0.0);
    }
    // The factors before the radiance are bounded, whatever it is.
    let weight = cosine / (sample.density + scatter_density(vertex, leaving, sample.direction));
    let reflected = reflectance(vertex, sample.direction, leaving) * weight * sample.radiance;
    if !any(reflected > vec3(0.0)) {
        return vec3(0.0);
    }
    if occluded(offset_origin(vertex.position, vertex.geometric), sample.direction, 0.0, FAR) {
        return vec3(0.0);
    }
    return reflected;
}

/// Radiance that arrives where a path leaves the scene along a direction that it had scattered into with this density [1/sr]: the
/// share that counts.
fn met_environment(direction: vec3<f32>, density: f32) -> vec3<f32> {
    return density / (density + density_of_environment(direction)) * environment_radiance(direction);
}
