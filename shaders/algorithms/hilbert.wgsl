// Hilbert's curve through a box: what is near along it is near in space. (Skilling 2004)

#import "algorithms/summary.wgsl"

/// Bits of each coordinate of a place along the curve.
const HILBERT_BITS: u32 = 10u;

/// Returns where a position is along the curve through the box of a summary, in 30 bits. Positions outside count as those at its side.
fn hilbert_of(position: vec3<f32>, box: Summary) -> u32 {
    // Cells are cubes; positions that are all in one place are in one of them.
    let size = box.high - box.low;
    let longest = max(max(size.x, max(size.y, size.z)), 1e-30);
    let most = (1u << HILBERT_BITS) - 1u;
    var at = vec3<u32>(clamp((position - box.low) / longest, vec3(0.0), vec3(1.0)) * f32(most));
    // From the highest bit down, each octant turns or mirrors what is within it.
    for (var bit = 1u << (HILBERT_BITS - 1u); bit > 1u; bit >>= 1u) {
        let below = bit - 1u;
        for (var axis = 0u; axis < 3u; axis++) {
            if (at[axis] & bit) != 0u {
                at.x ^= below;
            } else {
                let swapped = (at.x ^ at[axis]) & below;
                at.x ^= swapped;
                at[axis] ^= swapped;
            }
        }
    }
    // Gray code: neighbouring octants share a face.
    at.y ^= at.x;
    at.z ^= at.y;
    var parity = 0u;
    for (var bit = 1u << (HILBERT_BITS - 1u); bit > 1u; bit >>= 1u) {
        if (at.z & bit) != 0u {
            parity ^= bit - 1u;
        }
    }
    at ^= vec3(parity);
    var place = 0u;
    for (var bit = HILBERT_BITS; bit > 0u; bit--) {
        let octant = (at >> vec3(bit - 1u)) & vec3(1u);
        place = (place << 3u) | (octant.x << 2u) | (octant.y << 1u) | octant.z;
    }
    return place;
}
