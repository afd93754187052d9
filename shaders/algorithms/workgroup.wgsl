// Sums and maxima over a workgroup of 256 threads.
//
// Every thread of the workgroup must call these functions, in uniform control flow.

/// Threads of a workgroup: a multiple of every adapter's subgroup, and the most that WebGPU promises.
const GROUP_SIZE: u32 = 256u;
/// Neighbouring elements of a thread, in algorithms over many elements.
const RUN: u32 = 8u;
/// Elements of a workgroup: a block.
const BLOCK_SIZE: u32 = GROUP_SIZE * RUN;

var<workgroup> shared_numbers: array<f32, GROUP_SIZE>;
var<workgroup> shared_whole_numbers: array<u32, GROUP_SIZE>;
var<workgroup> shared_vectors: array<vec4<f32>, GROUP_SIZE>;

/// Returns the number of blocks that `length` elements fill.
fn blocks_of(length: u32) -> u32 {
    return length / BLOCK_SIZE + select(0u, 1u, length % BLOCK_SIZE > 0u);
}

/// Returns the inclusive prefix sum in x, and the sum of the whole workgroup in y, of values ≥ 0.
///
/// Sklansky's scheme (1960): the upper half of each block adds the last sum of its lower half. For numbers that
/// are not negative the sums are monotone in spite of rounding, since adding the same number to two others
/// keeps their order, and a value of zero gives exactly the sum before it. A cumulative distribution so made
/// never has an interval of negative width, nor one of positive width for a weight of zero. (Hillis and Steele's
/// scheme sums neighbours in different orders and has neither property.)
fn prefix_sum(thread: u32, value: f32) -> vec2<f32> {
    shared_numbers[thread] = value;
    workgroupBarrier();
    for (var width = 1u; width < GROUP_SIZE; width *= 2u) {
        if (thread & width) != 0u {
            shared_numbers[thread] += shared_numbers[(thread & ~(width - 1u)) - 1u];
        }
        workgroupBarrier();
    }
    let sums = vec2(shared_numbers[thread], shared_numbers[GROUP_SIZE - 1u]);
    workgroupBarrier();
    return sums;
}

/// Returns the same of whole numbers, modulo 2³².
fn prefix_sum_u32(thread: u32, value: u32) -> vec2<u32> {
    shared_whole_numbers[thread] = value;
    workgroupBarrier();
    for (var width = 1u; width < GROUP_SIZE; width *= 2u) {
        if (thread & width) != 0u {
            shared_whole_numbers[thread] += shared_whole_numbers[(thread & ~(width - 1u)) - 1u];
        }
        workgroupBarrier();
    }
    let sums = vec2(shared_whole_numbers[thread], shared_whole_numbers[GROUP_SIZE - 1u]);
    workgroupBarrier();
    return sums;
}

/// Returns the greatest value of the workgroup.
fn workgroup_max(thread: u32, value: f32) -> f32 {
    shared_numbers[thread] = value;
    workgroupBarrier();
    for (var width = GROUP_SIZE / 2u; width > 0u; width /= 2u) {
        if thread < width {
            shared_numbers[thread] = max(shared_numbers[thread], shared_numbers[thread + width]);
        }
        workgroupBarrier();
    }
    let greatest = shared_numbers[0];
    workgroupBarrier();
    return greatest;
}

/// Returns the sum of the workgroup, of numbers of either sign: halves are added until one is left.
fn workgroup_sum4(thread: u32, value: vec4<f32>) -> vec4<f32> {
    shared_vectors[thread] = value;
    workgroupBarrier();
    for (var width = GROUP_SIZE / 2u; width > 0u; width /= 2u) {
        if thread < width {
            shared_vectors[thread] += shared_vectors[thread + width];
        }
        workgroupBarrier();
    }
    let sum = shared_vectors[0];
    workgroupBarrier();
    return sum;
}
