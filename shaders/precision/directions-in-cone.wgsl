// Directions in the cone of a spot, by 1 - cos.

#import "hemisphere.wgsl"

struct Given {
    cap: f32,
    turns: f32,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    return Given(magnitude * u.x, u.y);
}

/// [magnitude: 1e-12 to 2, 1 - cos of the half angle]
/// [compared: vector]
fn probe(given: Given) -> vec4<f32> {
    return vec4(direction_about_z(given.cap, given.turns).xy, 0.0, 0.0);
}
