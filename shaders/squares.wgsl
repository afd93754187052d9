// Squares of pixels or texels that a workgroup takes: each thread has several, for all of which it reads once what they share.

/// Side of a workgroup.
const GROUP_SIDE: u32 = 8u;

/// Threads of a workgroup.
const TILE: u32 = GROUP_SIDE * GROUP_SIDE;

/// Places of a thread along each side of a square.
const SPAN: u32 = 2u;

/// Side of the square.
const SQUARE: u32 = GROUP_SIDE * SPAN;

/// Place i of a thread, from its first: they are GROUP_SIDE apart, so that threads beside each other have places beside each other.
fn place_in_square(i: u32) -> vec2<u32> {
    return GROUP_SIDE * vec2(i % SPAN, i / SPAN);
}
