// The interface Reprojection: where what pixels show was in the frame before. Here are the bits of its member `texels`.

/// All four texels around the place.
const ALL_TEXELS: u32 = 15u;
/// Neither camera nor lights nor geometry have moved.
const STANDS_STILL: u32 = 16u;
