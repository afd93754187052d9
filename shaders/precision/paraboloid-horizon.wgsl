// The height above the horizon of a point near the edge of the paraboloid map.

#import "paraboloid.wgsl"

struct Given {
    at: vec2<f32>,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    let radius = 1.0 - 0.5 * magnitude * (0.5 + 0.5 * u.x);
    return Given(radius * vec2(cos(6.283185307 * u.y), sin(6.283185307 * u.y)));
}

/// [magnitude: 1e-5 to 1, distance from the edge of the map, in its radii, times two]
fn probe(given: Given) -> vec4<f32> {
    return vec4(direction_from_paraboloid(given.at).z, paraboloid_density(given.at), 0.0, 0.0);
}
