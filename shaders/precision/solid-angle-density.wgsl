// A density over area as one over solid angle, by distance.

#import "diffuse-reflectance.wgsl"
#import "emitted-light.wgsl"
#import "inputs/directions.wgsl"

struct Given {
    density: f32,
    distance: f32,
    direction: vec3<f32>,
    normal: vec3<f32>,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    let direction = unit_direction(u.xy);
    // An emitter of that extent.
    return Given((0.5 + u.z) / magnitude / magnitude, magnitude, direction, direction_beside(direction, 1.5 * u.w, u.z));
}

/// [magnitude: 1e-18 to 1e18, distance [m]]
fn probe(given: Given) -> vec4<f32> {
    return vec4(over_solid_angle(given.density, given.distance, given.direction, given.normal), 0.0, 0.0, 0.0);
}
