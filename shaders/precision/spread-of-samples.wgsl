// The sum of squared deviations of samples from their mean, in two frames of eight, by how much they differ.

#import "inputs/numbers.wgsl"
#import "passes/path-tracer/deviations.wgsl"

struct Given {
    samples: array<f32, 16>,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    var samples: array<f32, 16>;
    for (var i = 0u; i < 16u; i++) {
        samples[i] = 1.0 + magnitude * number(u32(u.x * 16777216.0) + i);
    }
    return Given(samples);
}

/// [magnitude: 1e-5 to 100, difference over the least sample]
fn probe(given: Given) -> vec4<f32> {
    var first: Deviations;
    var second: Deviations;
    for (var i = 0u; i < 8u; i++) {
        first = with_sample(first, given.samples[i]);
        second = with_sample(second, given.samples[8u + i]);
    }
    return vec4(of_both(first, second).squares, 0.0, 0.0, 0.0);
}
