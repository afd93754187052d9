// Prefix sums of a buffer, whose length is in another buffer.

#import "algorithms/scan.wgsl"

var<storage, read> count: array<u32>;
var<storage, read> numbers: array<u32>;
var<storage, read_write> sums: array<vec2<u32>>;
var<storage, read_write> total: array<u32>;

fn scan_length() -> u32 {
    return count[0];
}

fn scan_element(i: u32) -> u32 {
    return numbers[i];
}

fn scan_store(i: u32, before: u32, sum: u32) {
    sums[i] = vec2(before, sum);
}

fn scan_total(sum: u32) {
    total[0] = sum;
}
