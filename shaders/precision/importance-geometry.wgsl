// The geometry term of importance between a virtual light and a sample of the view, by distance.

#import "view-sample.wgsl"
#import "inputs/directions.wgsl"

struct Given {
    position: vec3<f32>,
    normal: vec3<f32>,
    at: vec3<f32>,
    at_normal: vec3<f32>,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    let way = unit_direction(u.xy);
    // The light is at the origin: the difference of two places is off by the rounding of the places.
    return Given(vec3(0.0), direction_beside(way, 1.3 * u.z, u.w), magnitude * way, direction_beside(-way, 1.3 * u.w, u.z));
}

/// [magnitude: 1e-8 to 1, distance [extents of the scene]]
fn probe(given: Given) -> vec4<f32> {
    let sample = ViewSample(given.at, given.at_normal, vec3(1.0));
    return vec4(sample_geometry(given.position, given.normal, sample, 0.01), 0.0, 0.0, 0.0);
}
