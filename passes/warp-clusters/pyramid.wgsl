// A pyramid of sums of importance over squares of texels, each twice as wide as those of the finer level, and how its levels
// lie in one buffer. Each level has as few squares as cover the map: what would lie beyond its edges is 0. [ACRSM §4.5]
//
// The shader that imports this file has `var<storage, …> pyramid: array<Scaled>`.
//
// Sums are `Scaled`, and not f32: a map of 512² texels of 1e34 leaves the range of f32. To divide by the greatest value first
// would take another reading of all importance, which is what costs time, to save half of a third of its bytes.

#import "algorithms/scaled.wgsl"
#import interface "importance"

var rsm_position: texture_2d_array<f32>;

/// Columns and rows of a level; level 0 is the texels.
fn size_at(level: u32) -> vec2<u32> {
    return (textureDimensions(rsm_position) + (1u << level) - 1u) >> vec2(level);
}

/// Place in the buffer of the first sum of a level ≥ 1. Texels are not stored: the importance is asked for them.
fn begin_of(level: u32) -> u32 {
    var begin = 0u;
    for (var finer = 1u; finer < level; finer++) {
        let size = size_at(finer);
        begin += size.x * size.y * textureNumLayers(rsm_position);
    }
    return begin;
}

fn place_of(level: u32, layer: u32, square: vec2<u32>) -> u32 {
    let size = size_at(level);
    return begin_of(level) + (layer * size.y + square.y) * size.x + square.x;
}

/// Importance of a texel; NaN and what is negative count as 0.
fn importance_of_texel(layer: u32, texel: vec2<u32>) -> f32 {
    // DEVIATION(unlit): whatever the importance says of a texel that the light does not reach, there is nothing to sample.
    if textureLoad(rsm_position, texel, layer, 0).w == 0.0 {
        return 0.0;
    }
    return weight_of(importance(layer, texel));
}

/// The sum over a square of any level; 0 beyond the edges.
fn sum_at(level: u32, layer: u32, square: vec2<u32>) -> Scaled {
    if any(square >= size_at(level)) {
        return Scaled(0.0, 0);
    }
    if level == 0u {
        return scaled_weight(importance_of_texel(layer, square));
    }
    return pyramid[place_of(level, layer, square)];
}
