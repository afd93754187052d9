// Keeps some elements in their order, without gaps: a scan of ones and zeros, which `gpu_algorithms::scan` dispatches.
//
// The shader that imports this file gives
//   fn scan_length() -> u32             how many elements; from a uniform, or a buffer that is only read
//   fn compact_keeps(i: u32) -> bool    whether element i stays
//   fn compact_move(i: u32, place: u32) takes where element i goes; called once for each that stays
//   fn compact_count(count: u32)        takes how many stay; called once, by one thread

#import "algorithms/scan.wgsl"

/// Returns 1 where element `i` is kept, else 0.
fn scan_element(i: u32) -> u32 {
    return select(0u, 1u, compact_keeps(i));
}

/// Moves element `i`, where it is kept, behind the kept ones before it.
fn scan_store(i: u32, before: u32, sum: u32) {
    if sum != before {
        compact_move(i, before);
    }
}

/// Hands on the number of elements that are kept.
fn scan_total(sum: u32) {
    compact_count(sum);
}
