// Places of samples that maps take in turn. Of neighbouring samples each map gets one: a stratified subset of all.

#import "random.wgsl"
#import "surface-sample.wgsl"

/// What a sample is among those of all maps.
struct PlaceOfSample {
    /// Whether there is such a sample.
    exists: bool,
    /// The map that it is for.
    map: u32,
    /// Its number among the samples of its map.
    stratum: u32,
    /// Its place among all, as a share in units of 2⁻³¹: sample k of n has the middle of the k-th of n equal parts.
    number: u32,
    /// From one sample to the next, in the same units.
    step: f32,
}

/// A number of at most 2³¹, at least 1, over another: whole part, and fraction in units of 2⁻³².
fn quotient(dividend: u32, divisor: u32) -> vec2<u32> {
    var rest = dividend % divisor;
    var fraction = 0u;
    for (var bit = 0u; bit < 32u; bit++) {
        // The bit that doubling the remainder loses.
        let carry = rest >> 31u;
        rest <<= 1u;
        fraction <<= 1u;
        if carry == 1u || rest >= divisor {
            rest -= divisor;
            fraction |= 1u;
        }
    }
    return vec2(dividend / divisor, fraction);
}

/// The place of sample `index`, where the points ask for `requested` samples of all maps together, and `step` is 2³¹ over this
/// number. Neighbours are near each other, and belong to different maps.
fn place_of_sample(wanted: SamplesWanted, index: u32, requested: u32, step: vec2<u32>) -> PlaceOfSample {
    // Blocks of maps follow one after the other; within a block the maps alternate.
    let bits = wanted.block_bits;
    let row = index >> bits;
    let block = row / wanted.per_map;
    let stratum = row - block * wanted.per_map;
    let map = (block << bits) + (index & ((1u << bits) - 1u));
    let place = stratum * wanted.maps + map;
    let all = wanted.maps * wanted.per_map;
    if map >= wanted.maps || place >= min(requested, all) {
        return PlaceOfSample();
    }
    let between = select(vec2(wanted.step_whole, wanted.step_fraction), step, requested < all);
    let number = place * between.x + multiply_high(place, between.y) + between.x / 2u;
    // Each turn has all samples somewhere else between two of a map, by van der Corput's sequence.
    let shift = multiply_high(reverseBits(wanted.turn), 0x80000000u / wanted.per_map);
    return PlaceOfSample(true, map, stratum, (number + shift) & 0x7fffffffu, f32(between.x) + f32(between.y) * exp2(-32.0));
}
