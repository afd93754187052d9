// The light of emitters that the surfaces along a path reflect: by sampling emitters, and by paths that meet them. What both may
// find is weighted by the balance heuristic. [Veach & Guibas 1995]
//
// A file that imports this one imports also how surfaces reflect and where paths go on: scatter.wgsl, or
// diffuse-reflectance.wgsl where all are diffuse.

#import "emitters.wgsl"
#import "reflected-light.wgsl"

/// Returns the number in [0, 1] at which the interval of an emitter begins.
fn interval_start(emitter: u32) -> u32 {
    return scene_emitters.emitters[emitter].for_paths;
}

/// A density over the area of an emitter [1/m²] as one over solid angle [1/sr], seen from `distance` along a direction.
fn over_solid_angle(density: f32, distance: f32, direction: vec3<f32>, normal: vec3<f32>) -> f32 {
    return min(density * distance * distance / max(abs(dot(direction, normal)), 1e-20), FAR);
}

/// Radiance that a surface reflects of the emitters [W/(m² sr)], by one point of them: that share of it which `met_share`
/// leaves. `leaving` points to where it goes, unit.
fn reflected_emission(vertex: PathVertex, leaving: vec3<f32>, place: vec2<u32>) -> vec3<f32> {
    if !emitters_are_sampled() {
        return vec3(0.0);
    }
    let point = sample_emitter(place);
    let offset = point.position - vertex.position;
    let to_light = unit(offset);
    let cosine = dot(vertex.normal, to_light);
    let sampled = over_solid_angle(point.density, dot(offset, to_light), to_light, point.normal);
    // Also where the two coincide, and have no direction.
    if !(cosine > 0.0 && dot(vertex.geometric, to_light) > 0.0 && sampled > 0.0) {
        return vec3(0.0);
    }
    // The factors before the radiance are bounded, whatever it is.
    let weight = cosine / (sampled + scatter_density(vertex, leaving, to_light));
    let reflected = reflectance(vertex, to_light, leaving) * weight * point.radiance;
    if !any(reflected > vec3(0.0)) {
        return vec3(0.0);
    }
    let origin = offset_origin(vertex.position, vertex.geometric);
    // The ray ends before the emitter, on the side that is seen.
    let end = offset_origin(point.position, facing(point.normal, -to_light));
    if occluded(origin, end - origin, 0.0, 1.0) {
        return vec3(0.0);
    }
    return reflected;
}

/// The share of its emission that counts where a path from `before` met a surface along a direction that it had scattered
/// into with this density [1/sr].
fn met_share(triangle: u32, met: PathVertex, before: vec3<f32>, direction: vec3<f32>, density: f32) -> f32 {
    let of_area = density_of_triangle(triangle);
    if of_area == 0.0 {
        return 1.0;
    }
    let distance = dot(met.position - before, direction);
    return density / (density + over_solid_angle(of_area, distance, direction, met.geometric));
}
