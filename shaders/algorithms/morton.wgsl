// Places in a square along the Z-shaped curve of Morton (1966): what is near along the curve is near in the square.

/// Every second bit of a number, from bit 0 on.
fn even_bits(number: u32) -> u32 {
    var bits = number & 0x55555555u;
    bits = (bits | bits >> 1u) & 0x33333333u;
    bits = (bits | bits >> 2u) & 0x0f0f0f0fu;
    bits = (bits | bits >> 4u) & 0x00ff00ffu;
    return (bits | bits >> 8u) & 0xffffu;
}

/// The place with a number along the curve; the first n² numbers fill a square whose side n is a power of two.
fn place_on_curve(number: u32) -> vec2<u32> {
    return vec2(even_bits(number), even_bits(number >> 1u));
}

/// The place with a number in a square of any side. Threads that run together take places beside each other where they can.
fn place_in_turn(number: u32, side: u32) -> vec2<u32> {
    if (side & (side - 1u)) == 0u {
        return place_on_curve(number);
    }
    return vec2(number % side, number / side);
}
