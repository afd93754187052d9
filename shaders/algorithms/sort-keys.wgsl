// Numbers as keys of radix-sort.wgsl and select.wgsl.

/// Returns a key that is in the order of its number: -∞ first, then -1, -0, 0, 1, ∞. NaN comes before or behind all.
fn key_of_f32(x: f32) -> u32 {
    let bits = bitcast<u32>(x);
    return bits ^ select(0x80000000u, 0xffffffffu, bits >= 0x80000000u);
}

/// Returns the number of a key.
fn f32_of_key(key: u32) -> f32 {
    return bitcast<f32>(key ^ select(0xffffffffu, 0x80000000u, key >= 0x80000000u));
}
