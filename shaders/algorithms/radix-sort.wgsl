// One pass of a stable radix sort, least significant digit first: `gpu_algorithms::RadixSort` dispatches it for each
// digit of four bits. Between its two entry points radix-offsets.wgsl sums the counts.

#option INDICES false internal // whether the value of an element is its index; else values are given
#option COUNTED false internal // whether the first word of a buffer says how many elements there are

#import "algorithms/workgroup.wgsl"
#import "dispatch.wgsl"

struct Settings {
    /// Elements; with COUNTED, the most there can be.
    sort_length: u32,
    /// Blocks that those fill.
    sort_blocks: u32,
    /// First bit of the digit.
    sort_shift: u32,
}

var<uniform> settings: Settings;
#if COUNTED
var<storage, read> sort_count: array<u32>;
#endif
var<storage, read> sort_keys: array<u32>;
#if !INDICES
var<storage, read> sort_values: array<u32>;
#endif
/// [digits][blocks] How many of a block have a digit; then how many elements come before the first of them.
var<storage, read_write> sort_offsets: array<u32>;
var<storage, read_write> sorted_keys: array<u32>;
var<storage, read_write> sorted_values: array<u32>;

const DIGITS: u32 = 16u;
/// Words that hold a count of 16 bits for each digit.
const WORDS: u32 = DIGITS / 2u;

var<workgroup> digit_counts: array<atomic<u32>, DIGITS>;
/// [words][threads]
var<workgroup> shared_counts: array<u32, WORDS * GROUP_SIZE>;

/// Returns the number of keys that are sorted.
fn length_of_keys() -> u32 {
#if COUNTED
    return min(sort_count[0], settings.sort_length);
#else
    return settings.sort_length;
#endif
}

/// Returns the digit of a key that this pass of the sort looks at.
fn digit_of(key: u32) -> u32 {
    return (key >> settings.sort_shift) % DIGITS;
}

/// Counts the digits of each block.
@compute @workgroup_size(GROUP_SIZE)
fn count_digits(row: Row) {
    let thread = row.local;
    let block = group_in(row);
    let length = length_of_keys();
    for (var k = 0u; k < RUN; k++) {
        let i = block * BLOCK_SIZE + k * GROUP_SIZE + thread;
        if i < length {
            atomicAdd(&digit_counts[digit_of(sort_keys[i])], 1u);
        }
    }
    workgroupBarrier();
    if thread < DIGITS && block < settings.sort_blocks {
        sort_offsets[thread * settings.sort_blocks + block] = atomicLoad(&digit_counts[thread]);
    }
}

/// Moves each element behind those with a smaller digit, and those of its own digit that come before it.
@compute @workgroup_size(GROUP_SIZE)
fn move_elements(row: Row) {
    let thread = row.local;
    let block = group_in(row);
    let first = block * BLOCK_SIZE + thread * RUN;
    let end = min(first + RUN, max(length_of_keys(), first));
    // Two counts of 16 bits in a word: a block has fewer elements than would carry from one into the other.
    var counts: array<u32, WORDS>;
    for (var i = first; i < end; i++) {
        let digit = digit_of(sort_keys[i]);
        counts[digit / 2u] += 1u << (16u * (digit % 2u));
    }
    for (var word = 0u; word < WORDS; word++) {
        shared_counts[word * GROUP_SIZE + thread] = counts[word];
    }
    workgroupBarrier();
    // As `prefix_sum_u32`, of all words at once.
    for (var width = 1u; width < GROUP_SIZE; width *= 2u) {
        if (thread & width) != 0u {
            let lower = (thread & ~(width - 1u)) - 1u;
            for (var word = 0u; word < WORDS; word++) {
                shared_counts[word * GROUP_SIZE + thread] += shared_counts[word * GROUP_SIZE + lower];
            }
        }
        workgroupBarrier();
    }
    for (var word = 0u; word < WORDS; word++) {
        counts[word] = shared_counts[word * GROUP_SIZE + thread] - counts[word];
    }
    for (var i = first; i < end; i++) {
        let key = sort_keys[i];
        let digit = digit_of(key);
        let half = 16u * (digit % 2u);
        let rank = (counts[digit / 2u] >> half) & 0xffffu;
        counts[digit / 2u] += 1u << half;
        let place = sort_offsets[digit * settings.sort_blocks + block] + rank;
        sorted_keys[place] = key;
#if INDICES
        sorted_values[place] = i;
#else
        sorted_values[place] = sort_values[i];
#endif
    }
}
