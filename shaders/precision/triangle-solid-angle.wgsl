// Solid angle of a triangle on the plane at distance 1, by its size, where the volume that it spans is known.

#import "beam.wgsl"

struct Given {
    corner: vec2<f32>,
    sides: vec2<f32>,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    return Given(2.0 * u.xy - 1.0, magnitude * (0.5 + 0.5 * u.zw));
}

/// [magnitude: 1e-5 to 1e4, side of the triangle]
fn probe(given: Given) -> vec4<f32> {
    let a = vec3(given.corner, 1.0);
    let b = vec3(given.corner.x + given.sides.x, given.corner.y, 1.0);
    let c = vec3(given.corner + given.sides, 1.0);
    return vec4(triangle_solid_angle(a, b, c, given.sides.x * given.sides.y), 0.0, 0.0, 0.0);
}
