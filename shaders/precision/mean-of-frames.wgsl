// The mean over frames as passes/accumulate/accumulate.wgsl takes it, by how many frames there are. Half of the means are of
// equal frames: all roundings of their sum would be to the same side. The mean of others is rounded once in each frame, to either
// side, so its error grows as the square root of their number.

#import "inputs/numbers.wgsl"

struct Given {
    least: f32,
    spread: f32,
    frames: u32,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    return Given(0.1 + u.x, select(0.0, 1.0, u.y < 0.5), u32(magnitude));
}

/// [magnitude: 1 to 32768, frames]
/// [samples: 2]
/// [bound: 64]
fn probe(given: Given) -> vec4<f32> {
    var mean = 0.0;
    for (var frame = 0u; frame < given.frames; frame++) {
        mean += (given.least + given.spread * number(frame) - mean) / f32(frame + 1u);
    }
    return vec4(mean, 0.0, 0.0, 0.0);
}
