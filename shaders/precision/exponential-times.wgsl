// Exponentially distributed times, by the uniform number that each is made from.

#import "passes/resample-points/exponential.wgsl"

struct Given {
    x: f32,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    return Given(magnitude * (0.5 + 0.5 * u.x));
}

/// [magnitude: 1e-8 to 0.999, number]
fn probe(given: Given) -> vec4<f32> {
    return vec4(exponential_time(given.x), 0.0, 0.0, 0.0);
}
