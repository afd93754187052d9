// The sum of what a thread takes of the texels of a cluster, in the order of passes/average-clusters/average-clusters.wgsl, by how many
// texels there are. Half of the sums are of equal texels: all roundings of such a sum are to the same side.

#import "algorithms/workgroup.wgsl"
#import "inputs/numbers.wgsl"

struct Given {
    least: f32,
    spread: f32,
    texels: u32,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    return Given(0.1 + u.x, select(0.0, 1.0, u.y < 0.5), u32(magnitude));
}

const PART: u32 = 64u;

/// [magnitude: 256 to 1e6, texels of the window]
/// [samples: 6]
/// [bound: 16]
fn probe(given: Given) -> vec4<f32> {
    var sum = 0.0;
    for (var first = 0u; first < given.texels; first += PART * GROUP_SIZE) {
        var part = 0.0;
        for (var i = first; i < min(given.texels, first + PART * GROUP_SIZE); i += GROUP_SIZE) {
            part += given.least + given.spread * number(i);
        }
        sum += part;
    }
    return vec4(sum, 0.0, 0.0, 0.0);
}
