// Combines any number of elements into one, always in the same order: `gpu_algorithms::reduce` dispatches it.
//
// The shader that imports this file gives
//   struct or alias Reduced
//   fn reduce_length() -> u32                         how many elements; from a uniform, or a buffer that is only read
//   fn reduce_element(i: u32) -> Reduced              element i; called once
//   fn reduce_identity() -> Reduced                   what changes nothing
//   fn reduce_both(a: Reduced, b: Reduced) -> Reduced
//   fn reduce_workgroup(thread: u32, own: Reduced) -> Reduced   what 256 threads bring, combined; all of them call it
//   fn reduce_store(result: Reduced)                  called once, by one thread
// For sums of f32, of vec4 and of Scaled, sum-f32.wgsl, sum-vec4.wgsl and sum-scaled.wgsl give all but the first two
// functions and the last; for the box around points, so does summarize.wgsl.

#import "algorithms/workgroup.wgsl"
#import "dispatch.wgsl"

/// [blocks]
var<storage, read_write> reduced_blocks: array<Reduced>;

/// Combines a block of elements in each workgroup, RUN neighbours in each thread.
@compute @workgroup_size(GROUP_SIZE)
fn reduce_blocks(row: Row) {
    let thread = row.local;
    let block = group_in(row);
    let length = reduce_length();
    let first = block * BLOCK_SIZE + thread * RUN;
    var own = reduce_identity();
    for (var i = first; i < first + RUN; i++) {
        if i < length {
            own = reduce_both(own, reduce_element(i));
        }
    }
    own = reduce_workgroup(thread, own);
    if thread == 0u && block < blocks_of(length) {
        reduced_blocks[block] = own;
    }
}

/// Combines the blocks in one workgroup.
@compute @workgroup_size(GROUP_SIZE)
fn reduce_parts(@builtin(local_invocation_index) thread: u32) {
    var own = reduce_identity();
    for (var i = thread; i < blocks_of(reduce_length()); i += GROUP_SIZE) {
        own = reduce_both(own, reduced_blocks[i]);
    }
    own = reduce_workgroup(thread, own);
    if thread == 0u {
        reduce_store(own);
    }
}

/// Combines a few elements in one workgroup, without blocks.
@compute @workgroup_size(GROUP_SIZE)
fn reduce_few(@builtin(local_invocation_index) thread: u32) {
    var own = reduce_identity();
    for (var i = thread; i < reduce_length(); i += GROUP_SIZE) {
        own = reduce_both(own, reduce_element(i));
    }
    own = reduce_workgroup(thread, own);
    if thread == 0u {
        reduce_store(own);
    }
}
