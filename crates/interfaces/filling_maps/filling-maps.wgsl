// The interface FillingMaps: depth maps that go on filling over frames.
//
// What lies in a texel is met either in a triangle, or in the disc of a surfel whose triangle is smaller than what its point stands
// for. The first is there for sure. A disc hides what lies beside its triangle too, so it goes when enough points have fallen onto the
// triangles themselves: until then it takes the place of those that none has met yet.
//
// A texel is kept as a number whose least is what counts: from the highest bit on, 17 bits of the distance as it is stored, the kind of
// what was met in 4 bits, and the next 11 bits of the distance. So of what lies as far but for 1/256, a triangle counts before a
// disc; discs are pushed back by as much.

/// Returns how a distance [bits of a number of metres] is kept. The kind is 0 of what was met in a triangle; of a disc it is the binary
/// logarithm of the number of frames after which the disc goes.
fn kept_distance(distance: u32, kind: u32) -> u32 {
    let coarse = (distance & 0xffff8000u) + select(0u, 0x8000u, kind > 0u);
    return coarse | (kind << 11u) | ((distance >> 4u) & 0x7ffu);
}

/// Returns the bits of the distance that is kept.
fn distance_kept(texel: u32) -> u32 {
    let is_of_disc = (texel & 0x7800u) != 0u;
    return ((texel & 0xffff8000u) - select(0u, 0x8000u, is_of_disc)) | ((texel & 0x7ffu) << 4u);
}

/// Whether a texel is of a disc that goes, where points have fallen for so many frames.
fn is_outdated(texel: u32, frames: u32) -> bool {
    let kind = (texel >> 11u) & 15u;
    return kind > 0u && frames + 1u >= 1u << kind;
}

/// Points that fall onto a triangle, in the mean, before discs in its place go. More: fewer holes, but shadows stay thick longer.
const ENOUGH_POINTS: f32 = 2.0;

/// Returns the kind of a disc in place of triangles of some area, of a point that stands for another [m²].
fn kind_of_disc(triangle: f32, area: f32) -> u32 {
    let frames = ENOUGH_POINTS * area / max(triangle, 1e-30);
    return u32(clamp(ceil(log2(frames)), 1.0, 15.0));
}
