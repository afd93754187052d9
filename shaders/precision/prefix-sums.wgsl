// Cumulative sums in the order of shaders/algorithms/segmented-scan.wgsl, by the number of elements: the last of all. Half of
// the sums are of equal elements: all roundings of such a sum are to the same side. Blocks beyond the sixteenth have the elements of
// those before.

#import "algorithms/carried-sum.wgsl"
#import "algorithms/workgroup.wgsl"
#import "inputs/numbers.wgsl"

struct Given {
    least: f32,
    spread: f32,
    count: u32,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    return Given(0.1 + u.x, select(0.0, 1.0, u.y < 0.5), u32(magnitude));
}

/// Blocks with elements of their own.
const DIFFERENT: u32 = 16u;

/// Returns the result of `prefix_sum` in the last thread: the upper half of each block adds the sum of its lower half.
fn block_sum(given: Given, first: u32) -> f32 {
    var values: array<f32, GROUP_SIZE>;
    for (var thread = 0u; thread < GROUP_SIZE; thread++) {
        if first + thread < given.count {
            values[thread] = given.least + given.spread * number(first + thread);
        }
    }
    for (var width = 1u; width < GROUP_SIZE; width *= 2u) {
        for (var last = 2u * width - 1u; last < GROUP_SIZE; last += 2u * width) {
            values[last] += values[last - width];
        }
    }
    return values[GROUP_SIZE - 1u];
}

/// [magnitude: 10 to 4194304, elements]
/// [samples: 4]
/// [bound: 8]
fn probe(given: Given) -> vec4<f32> {
    var sums: array<f32, DIFFERENT>;
    for (var block = 0u; block < min(DIFFERENT, (given.count - 1u) / GROUP_SIZE + 1u); block++) {
        sums[block] = block_sum(given, block * GROUP_SIZE);
    }
    var before: CarriedSum;
    for (var block = 0u; block * GROUP_SIZE < given.count; block++) {
        before = with_number(before, sums[block % DIFFERENT]);
    }
    return vec4(carried_sum(before, 0.0), 0.0, 0.0, 0.0);
}
