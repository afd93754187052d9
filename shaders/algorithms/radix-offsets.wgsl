// The scan of a radix sort: from how many elements of each block have a digit to where the first of them goes.

#import "algorithms/scan.wgsl"

struct Settings {
    sort_blocks: u32,
}

var<uniform> settings: Settings;
/// [digits][blocks]
var<storage, read_write> sort_offsets: array<u32>;

/// Returns the number of counts: one for each digit and block.
fn scan_length() -> u32 {
    return 16u * settings.sort_blocks;
}

/// Returns a count.
fn scan_element(i: u32) -> u32 {
    return sort_offsets[i];
}

/// Replaces a count by the sum of those before it.
fn scan_store(i: u32, before: u32, sum: u32) {
    sort_offsets[i] = before;
}

/// Ignores the sum of all, which is the number of keys.
fn scan_total(sum: u32) {}
