// Sobol's sequence in two dimensions, scrambled.

#import "random.wgsl"

/// Element `index` of Sobol's sequence in two dimensions, in fixed point: 2^-32 is one.
///
/// A (0, 2)-sequence in base 2: of every 2^m elements that start at a multiple of 2^m, exactly one lies in each
/// box of area 2^-m whose sides are aligned to powers of two, for all 2^32 indices.
fn sobol2(index: u32) -> vec2<u32> {
    // Bit i of the second dimension is the sum, modulo 2, of bit j of the index over all j whose bits contain those of
    // i (Pascal's triangle modulo 2). It is computed in one step for each bit of the positions.
    var sums = index;
    sums ^= (sums >> 16u) & 0x0000ffffu;
    sums ^= (sums >> 8u) & 0x00ff00ffu;
    sums ^= (sums >> 4u) & 0x0f0f0f0fu;
    sums ^= (sums >> 2u) & 0x33333333u;
    sums ^= (sums >> 1u) & 0x55555555u;
    return vec2(reverseBits(index), reverseBits(sums));
}

/// Owen's nested scrambling (Laine & Karras 2011, constants of Burley 2020): keeps the stratification of `sobol2`, and
/// removes its pattern.
fn scramble(value: u32, seed: u32) -> u32 {
    var bits = reverseBits(value) + seed;
    bits ^= bits * 0x6c50b47cu;
    bits ^= bits * 0xb82f1e52u;
    bits ^= bits * 0xc7afe638u;
    bits ^= bits * 0x8d22f6e6u;
    return reverseBits(bits);
}

/// Element `index` of a sequence of points in the unit square, in fixed point: 2^-32 is one. The points of one seed are
/// stratified, and independent of those of another seed (padding with a shuffled index, Burley 2020).
fn sobol2_bits_of(index: u32, seed: u32) -> vec2<u32> {
    let point = sobol2(scramble(index, hash2(seed, 0u)));
    return vec2(scramble(point.x, hash2(seed, 1u)), scramble(point.y, hash2(seed, 2u)));
}

/// The same in floats.
fn sobol2_of(index: u32, seed: u32) -> vec2<f32> {
    let bits = sobol2_bits_of(index, seed);
    return vec2(unit_float(bits.x), unit_float(bits.y));
}
