// Vectors scaled to length 1, by the length that they have.

#import "surface.wgsl"

struct Given {
    v: vec3<f32>,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    return Given(magnitude * (2.0 * u.xyz - 1.0));
}

/// [magnitude: 1e-37 to 1e38, greatest component]
/// [compared: vector]
fn probe(given: Given) -> vec4<f32> {
    return vec4(unit(given.v), 0.0);
}
