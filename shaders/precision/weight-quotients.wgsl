// Weights as quotients of radiosity and density, by the magnitude of both.

#import "passes/resample-points/weights.wgsl"

struct Given {
    radiosity: f32,
    density: f32,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    return Given(magnitude * (0.1 + u.x), (0.1 + u.y) / magnitude);
}

/// [magnitude: 1e-30 to 1e30, radiosity, and one over the density]
fn probe(given: Given) -> vec4<f32> {
    let weight = quotient(scaled_weight(given.radiosity), scaled_weight(given.density));
    // Its value may lie beyond f32: both parts by themselves.
    return vec4(weight.value * exp2(f32(weight.exponent) / 256.0), 0.0, 0.0, 0.0);
}
