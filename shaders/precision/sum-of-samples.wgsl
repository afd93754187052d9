// The mean over the samples of a pixel, in the order of passes/path-tracer/path-tracer.wgsl with 64 samples per frame, by how many
// samples there are. Half of the means are of equal samples: all roundings of their sum would be to the same side. The mean of others
// is rounded once in each frame, to either side, so its error grows as the square root of their number. Frames differ by as much as
// means of 64 random numbers do.

#import "inputs/numbers.wgsl"

struct Given {
    least: f32,
    spread: f32,
    samples: u32,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    return Given(0.1 + u.x, select(0.0, 1.0, u.y < 0.5), u32(magnitude));
}

const PER_FRAME: u32 = 64u;

/// The sum over the first samples.
fn sum_of_first(given: Given, count: u32) -> f32 {
    var sum = 0.0;
    for (var s = 0u; s < count; s++) {
        sum += given.least + given.spread * number(s);
    }
    return sum;
}

/// [magnitude: 1 to 1048576, samples]
/// [samples: 6]
/// [bound: 64]
fn probe(given: Given) -> vec4<f32> {
    let first = sum_of_first(given, min(given.samples, PER_FRAME)) / f32(min(given.samples, PER_FRAME));
    var mean = 0.0;
    for (var before = 0u; before < given.samples; before += PER_FRAME) {
        let count = f32(min(given.samples - before, PER_FRAME));
        let of_frame = first + given.spread * 0.125 * number(before / PER_FRAME);
        mean += (of_frame - mean) * (count / (f32(before) + count));
    }
    return vec4(mean, 0.0, 0.0, 0.0);
}
