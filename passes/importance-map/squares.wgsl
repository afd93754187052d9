// Squares of texels, or of blocks, that a workgroup compares with samples of the view.

/// Texels, or blocks, per thread along each side of a square, GROUP_SIDE apart: each sample is read once for all of them.
const SPAN: u32 = 2u;
const GROUP_SIDE: u32 = 8u;
/// Side of the square that a workgroup measures.
const SQUARE: u32 = GROUP_SIDE * SPAN;
/// Threads of a workgroup, each of which reads a sample for all.
const TILE: u32 = GROUP_SIDE * GROUP_SIDE;
