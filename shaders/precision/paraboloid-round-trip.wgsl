// A direction to the paraboloid map and back, by its angle above the horizon.

#import "paraboloid.wgsl"

struct Given {
    direction: vec3<f32>,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    let z = magnitude * (0.5 + 0.5 * u.x);
    let radius = sqrt(max((1.0 - z) * (1.0 + z), 0.0));
    return Given(vec3(radius * cos(6.283185307 * u.y), radius * sin(6.283185307 * u.y), z));
}

/// [magnitude: 1e-4 to 1, sine of the angle above the horizon]
/// [compared: vector]
fn probe(given: Given) -> vec4<f32> {
    let at = paraboloid_from_direction(given.direction);
    return vec4(direction_from_paraboloid(at), paraboloid_density(at));
}
