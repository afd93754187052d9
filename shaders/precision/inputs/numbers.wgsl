// Numbers for the inputs of probes.

/// Returns a number in [0, 1), uniform: multiples of the golden ratio, modulo 1.
fn number(i: u32) -> f32 {
    return f32((i * 2654435769u) >> 8u) * 0x1p-24f;
}
