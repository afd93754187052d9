// Directions distributed by the cosine, near the normal and near the horizon, by the random number that decides it.

#import "hemisphere.wgsl"

struct Given {
    near_normal: vec2<f32>,
    near_horizon: vec2<f32>,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    return Given(vec2(magnitude * (0.5 + 0.5 * u.x), u.y), vec2(1.0 - magnitude * (0.5 + 0.5 * u.x), u.y));
}

/// [magnitude: 1e-6 to 1, random number, or one less it]
fn probe(given: Given) -> vec4<f32> {
    let a = by_cosine(given.near_normal);
    let b = by_cosine(given.near_horizon);
    return vec4(length(a.xy), a.z, length(b.xy), b.z);
}
