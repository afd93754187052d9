// Prefix sums of any number of whole numbers, modulo 2³²: `gpu_algorithms::scan` dispatches it.
//
// The shader that imports this file gives
//   fn scan_length() -> u32             how many elements; from a uniform, or a buffer that is only read
//   fn scan_element(i: u32) -> u32      element i; called once
//   fn scan_store(i: u32, before: u32, sum: u32)   takes the sums without and with element i; called once for each
//   fn scan_total(sum: u32)             takes the sum of all; called once, by one thread, also where there is none
//
// No workgroup waits for another: blocks are summed, then the sums of blocks, then both are put together.

#import "algorithms/workgroup.wgsl"
#import "dispatch.wgsl"

/// [blocks][1 + BLOCK_SIZE] The sum of a block, and then of all blocks before it; sums from the first of the block on.
var<storage, read_write> scan_sums: array<u32>;

/// Returns the index in `scan_sums` at which the sums of a block begin.
fn place_of_block(block: u32) -> u32 {
    return block * (BLOCK_SIZE + 1u);
}

/// The prefix sums of RUN neighbours of a thread, from the first element of the block on.
struct Run {
    sums: array<u32, RUN>,
    /// Sum of the block.
    total: u32,
}

/// Returns those of the elements from `first` on. All threads of a workgroup must call it.
fn sums_of_run(thread: u32, first: u32, length: u32) -> Run {
    var run: Run;
    var own = 0u;
    for (var k = 0u; k < RUN; k++) {
        if first + k < length {
            own += scan_element(first + k);
        }
        run.sums[k] = own;
    }
    let sums = prefix_sum_u32(thread, own);
    for (var k = 0u; k < RUN; k++) {
        run.sums[k] += sums.x - own;
    }
    run.total = sums.y;
    return run;
}

/// Sums each block by itself.
@compute @workgroup_size(GROUP_SIZE)
fn scan_blocks(row: Row) {
    let thread = row.local;
    let block = group_in(row);
    let length = scan_length();
    let first = block * BLOCK_SIZE + thread * RUN;
    let run = sums_of_run(thread, first, length);
    for (var k = 0u; k < RUN; k++) {
        if first + k < length {
            scan_sums[place_of_block(block) + 1u + thread * RUN + k] = run.sums[k];
        }
    }
    if thread == 0u && block < blocks_of(length) {
        scan_sums[place_of_block(block)] = run.total;
    }
}

/// Sums the blocks before each block, in one workgroup.
@compute @workgroup_size(GROUP_SIZE)
fn scan_offsets(@builtin(local_invocation_index) thread: u32) {
    let blocks = blocks_of(scan_length());
    var before = 0u;
    for (var first = 0u; first < blocks; first += GROUP_SIZE) {
        let block = first + thread;
        var own = 0u;
        if block < blocks {
            own = scan_sums[place_of_block(block)];
        }
        let sums = prefix_sum_u32(thread, own);
        if block < blocks {
            scan_sums[place_of_block(block)] = before + sums.x - own;
        }
        before += sums.y;
    }
    if thread == 0u {
        scan_total(before);
    }
}

/// Combines both, one thread per element.
@compute @workgroup_size(GROUP_SIZE)
fn scan_place(row: Row) {
    let i = index_in(row, GROUP_SIZE);
    if i >= scan_length() {
        return;
    }
    let place = place_of_block(i / BLOCK_SIZE);
    let offset = scan_sums[place];
    let within = i % BLOCK_SIZE;
    var before = offset;
    if within > 0u {
        before += scan_sums[place + within];
    }
    scan_store(i, before, offset + scan_sums[place + within + 1u]);
}

/// Sums at most one block, without scratch memory.
@compute @workgroup_size(GROUP_SIZE)
fn scan_block(@builtin(local_invocation_index) thread: u32) {
    let length = scan_length();
    let first = thread * RUN;
    let run = sums_of_run(thread, first, length);
    // The last sum of the thread before, which is kept apart from its own.
    shared_whole_numbers[thread] = run.sums[RUN - 1u];
    workgroupBarrier();
    var before = 0u;
    if thread > 0u {
        before = shared_whole_numbers[thread - 1u];
    }
    for (var k = 0u; k < RUN; k++) {
        if first + k < length {
            scan_store(first + k, before, run.sums[k]);
        }
        before = run.sums[k];
    }
    if thread == 0u {
        scan_total(run.total);
    }
}
