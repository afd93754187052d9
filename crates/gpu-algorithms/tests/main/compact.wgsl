// Keeps the odd numbers.

#import "algorithms/compact.wgsl"

var<storage, read> count: array<u32>;
var<storage, read> numbers: array<u32>;
var<storage, read_write> kept: array<u32>;
var<storage, read_write> total: array<u32>;

fn scan_length() -> u32 {
    return count[0];
}

fn compact_keeps(i: u32) -> bool {
    return numbers[i] % 2u == 1u;
}

fn compact_move(i: u32, place: u32) {
    kept[place] = i;
}

fn compact_count(count: u32) {
    total[0] = count;
}
