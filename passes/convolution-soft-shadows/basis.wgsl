// The basis images of shadow maps: how heights become depths, and where images are in their buffer.
// [Annen et al. 2007; ACRSM Eq. 3.5]
//
// Each map has a header of one word, the greatest height that it holds [m] (f32), and then its levels from the first, row by
// row: level l has a texel for each 2^l × 2^l texels of the map, fewer at the far edges. A texel has for each order k a word
// with the means of sin(c_k z) and cos(c_k z), c_k = π (2k - 1), in 16 bits each; after those as many words with the means of
// z sin(c_k z) and z cos(c_k z); and the mean of z (f32).

#import "color.wgsl"
#import "paraboloid.wgsl"

/// The greatest order.
const ORDERS: u32 = 16u;

/// Words of a texel.
fn texel_words(order: u32) -> u32 {
    return 2u * order + 1u;
}

/// Side of a level [px].
fn level_side(tile: u32, level: u32) -> u32 {
    return (tile + (1u << level) - 1u) >> level;
}

/// Where a level begins in the words of its map.
fn level_begin(tile: u32, level: u32, order: u32) -> u32 {
    var begin = 1u;
    for (var finer = 1u; finer < level; finer++) {
        let side = level_side(tile, finer);
        begin += side * side * texel_words(order);
    }
    return begin;
}

/// The depth of a height, up to `greatest` at the height `far` and for all that is higher.
// DEVIATION(height): the paper takes the distance from the light, as a share of what its camera sees.
fn depth_of_height(height: f32, far: f32, greatest: f32) -> f32 {
    return select(greatest, height / far * greatest, height < far);
}

/// The greatest depth: the expansion repeats itself with the period 2, and rises again at a distance of 1 from its step.
fn greatest_depth(order: u32, offset: f32) -> f32 {
    return 1.0 - offset / f32(order);
}

/// Cosine and sine of c_1 z.
fn first_order(depth: f32) -> vec2<f32> {
    return vec2(cos(PI * depth), sin(PI * depth));
}

/// Cosine and sine of the sum of two angles, of which those are the cosines and sines.
fn turned(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    return vec2(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x);
}
