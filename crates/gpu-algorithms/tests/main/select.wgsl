// The number of a rank among those of a buffer.

#import "algorithms/select.wgsl"
#import "algorithms/sort-keys.wgsl"

/// Length and rank.
var<storage, read> count: array<u32>;
var<storage, read> numbers: array<f32>;
var<storage, read_write> found: array<u32>;

fn select_length() -> u32 {
    return count[0];
}

fn select_rank() -> u32 {
    return count[1];
}

fn select_key(i: u32) -> u32 {
    return key_of_f32(numbers[i]);
}

fn select_store(key: u32) {
    found[0] = key;
    found[1] = bitcast<u32>(f32_of_key(key));
}
