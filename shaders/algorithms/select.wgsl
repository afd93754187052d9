// Finds the element of a rank without sorting, digit by digit from the highest: `gpu_algorithms::select` dispatches it.
//
// The shader that imports this file gives
//   fn select_length() -> u32           how many elements; from a uniform, or a buffer that is only read
//   fn select_rank() -> u32             of the key that is wanted: 0 is the smallest; the greatest where it is beyond all
//   fn select_key(i: u32) -> u32        of element i; called four times
//   fn select_store(key: u32)           takes the key of that rank, 0xffffffff where there is no element; called once

#import "algorithms/selection.wgsl"
#import "algorithms/workgroup.wgsl"
#import "dispatch.wgsl"

var<storage, read_write> selection: Selection;

var<workgroup> select_counts: array<atomic<u32>, SELECT_DIGITS>;

/// Begins with the highest digit.
@compute @workgroup_size(GROUP_SIZE)
fn select_begin(@builtin(local_invocation_index) thread: u32) {
    atomicStore(&selection.counts[thread], 0u);
    if thread == 0u {
        selection.key = 0u;
        selection.shift = 24u;
        selection.rank = min(select_rank(), max(select_length(), 1u) - 1u);
    }
}

/// Counts the digits of the elements that may be the one.
@compute @workgroup_size(GROUP_SIZE)
fn select_count(row: Row) {
    let thread = row.local;
    let block = group_in(row);
    let length = select_length();
    for (var k = 0u; k < RUN; k++) {
        let i = block * BLOCK_SIZE + k * GROUP_SIZE + thread;
        if i < length {
            let key = select_key(i) >> selection.shift;
            if key >> 8u == (selection.key >> selection.shift) >> 8u {
                atomicAdd(&select_counts[key % SELECT_DIGITS], 1u);
            }
        }
    }
    workgroupBarrier();
    let count = atomicLoad(&select_counts[thread]);
    if count > 0u {
        atomicAdd(&selection.counts[thread], count);
    }
}

/// Finds the digit, in one workgroup, and goes on to the next.
@compute @workgroup_size(GROUP_SIZE)
fn select_narrow(@builtin(local_invocation_index) thread: u32) {
    let count = atomicLoad(&selection.counts[thread]);
    let rank = selection.rank;
    let shift = selection.shift;
    let known = selection.key;
    let sums = prefix_sum_u32(thread, count);
    storageBarrier();
    let before = sums.x - count;
    if rank >= before && rank < sums.x {
        let key = known | (thread << shift);
        selection.key = key;
        selection.rank = rank - before;
        if shift > 0u {
            selection.shift = shift - 8u;
        } else {
            select_store(key);
        }
    } else if thread == 0u && sums.y == 0u && shift == 24u {
        select_store(0xffffffffu);
    }
    atomicStore(&selection.counts[thread], 0u);
}
