//! The CPU reference of shaders/random.wgsl and shuffle.wgsl, in `f64`.

/// Returns a permutation of 32 bits (Jarzynski & Olano 2020).
pub fn hash(value: u32) -> u32 {
    let state = value.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

/// Returns a hash of two numbers.
pub fn hash2(a: u32, b: u32) -> u32 {
    hash(a ^ hash(b.wrapping_add(0x9e37_79b9)))
}

/// Maps to \[0, 1), from the upper 24 bits.
pub fn unit_float(bits: u32) -> f64 {
    f64::from(bits >> 8) / 16_777_216.0
}

/// Returns element `index` of van der Corput's sequence.
pub fn radical_inverse(base: u32, index: u32) -> f64 {
    let (mut rest, mut reversed, mut scale) = (index, 0_u64, 1_u64);
    while rest > 0 {
        reversed = reversed * u64::from(base) + u64::from(rest % base);
        scale *= u64::from(base);
        rest /= base;
    }
    reversed as f64 / scale as f64
}

/// Returns element `index` of Halton's sequence in bases 2, 3, 5, shifted by the seed modulo 1; seed 0 is the plain
/// one.
pub fn halton3(index: u32, seed: u32) -> [f64; 3] {
    [(2, 0), (3, 1), (5, 2)].map(|(base, dimension)| {
        let shift = if seed == 0 { 0.0 } else { unit_float(hash2(seed, dimension)) };
        (radical_inverse(base, index) + shift).fract()
    })
}

/// Returns the position of `place` in a permutation of `count` elements that the key selects.
pub fn shuffled(place: u32, count: u32, key: u32) -> u32 {
    let bits = 32 - (count - 1).leading_zeros();
    let within_power_of_two = |mut place: u32| {
        let mut state = key;
        for _ in 0..4 {
            state = hash(state);
            place = place.wrapping_mul(state | 1).wrapping_add(state >> 16) & ((1 << bits) - 1);
            place ^= place >> bits.div_ceil(2);
        }
        place
    };
    let mut shuffled = within_power_of_two(place);
    while shuffled >= count {
        shuffled = within_power_of_two(shuffled);
    }
    shuffled
}
