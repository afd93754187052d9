// Solid angle of a rectangle on the plane at distance 1, given its middle and its sides, by its size.

#import "beam.wgsl"

struct Given {
    middle: vec2<f32>,
    sides: vec2<f32>,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    let sides = magnitude * (0.5 + 0.5 * u.zw);
    return Given((2.0 * u.xy - 1.0) * (3.75 - 0.5 * sides), sides);
}

/// [magnitude: 1e-5 to 3.75, side of the rectangle, within the widest layer of a light]
fn probe(given: Given) -> vec4<f32> {
    return vec4(rectangle_solid_angle(given.middle, given.sides), 0.0, 0.0, 0.0);
}
