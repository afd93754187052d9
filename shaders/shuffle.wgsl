// Permutations of any number of elements, element by element, without a table.

#import "random.wgsl"

/// Position of `place` in a permutation of 2^bits elements that the key selects: each operation is invertible.
fn shuffled_in(place: u32, bits: u32, key: u32) -> u32 {
    var shuffled = place;
    var state = key;
    for (var round = 0u; round < 4u; round++) {
        state = hash(state);
        shuffled = (shuffled * (state | 1u) + (state >> 16u)) & ((1u << bits) - 1u);
        shuffled ^= shuffled >> ((bits + 1u) / 2u);
    }
    return shuffled;
}

/// Position of `place` in a permutation of `count` elements: a permutation of the next power of two is repeated until
/// the result is below `count`, which always ends, since `place` itself is below it (cycle walking, Black & Rogaway
/// 2002).
fn shuffled(place: u32, count: u32, key: u32) -> u32 {
    let bits = 32u - countLeadingZeros(count - 1u);
    var shuffled = shuffled_in(place, bits, key);
    while shuffled >= count {
        shuffled = shuffled_in(shuffled, bits, key);
    }
    return shuffled;
}
