// The sum over the samples of a pixel, in the order of passes/path-tracer/path-tracer.wgsl with 64 samples per frame, by how
// many samples there are. Half of the sums are of equal samples: all roundings of such a sum are to the same side.

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

/// [magnitude: 1 to 8192, samples]
/// [samples: 6]
/// [bound: 16]
fn probe(given: Given) -> vec4<f32> {
    var past = 0.0;
    for (var frame = 0u; frame < given.samples; frame += PER_FRAME) {
        var sum = 0.0;
        for (var s = frame; s < min(given.samples, frame + PER_FRAME); s++) {
            sum += given.least + given.spread * number(s);
        }
        past += sum;
    }
    return vec4(past, 0.0, 0.0, 0.0);
}
