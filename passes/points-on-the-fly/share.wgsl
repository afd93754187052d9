// How many points each triangle is amplified into (TCAS §5.2): its share of the weights as a whole number, and the prefix sum
// of the shares. The points themselves are made by shaders/points-on-the-fly.wgsl.
//
// DEVIATION(maps-in-turn): the papers draw the map of a point at random.
// DEVIATION(one-map-a-point): ACRSM splats a point into several.

#import "algorithms/scan.wgsl"
#import "amplification.wgsl"
#import "random.wgsl"
#import "surface-sample.wgsl"
#import "weights.wgsl"

struct Settings {
    /// Binary logarithm of the entries of the guide.
    guide_bits: u32,
    min_factor: u32,
    max_factor: u32,
    seed: u32,
}

/// All that is shared out: half of what a u32 holds, so that rounding cannot carry the sum beyond it.
const WHOLE: u32 = 0x80000000u;

var<uniform> settings: Settings;
var<storage, read> total_weight: f32;
var<storage, read_write> points: Amplification;

fn scan_length() -> u32 {
    return scene_info.triangles;
}

/// A triangle's share of WHOLE, rounded at random so that the roundings of many do not add up.
fn scan_element(triangle: u32) -> u32 {
    let weight = weight_of_triangle(triangle);
    if !(weight > 0.0) {
        return 0u;
    }
    let share = weight / total_weight * f32(WHOLE);
    return u32(share + unit_float(hash2(settings.seed, triangle)));
}

/// The last interval ends where all do.
fn scan_store(triangle: u32, before: u32, sum: u32) {
    points.starts[triangle + 1u] = select(min(sum, WHOLE), WHOLE, triangle + 1u == scene_info.triangles);
}

fn scan_total(sum: u32) {
    points.starts[0] = 0u;
#if TESSELLATION
    // The conversion ends at the greatest number.
    points.requested = u32(total_weight);
#else
    points.requested = ANY_NUMBER;
#endif
    points.guide_bits = settings.guide_bits;
    points.step = whole_over(max(points.requested, 1u));
}

/// WHOLE over a number: whole part, and fraction in units of 2⁻³².
fn whole_over(divisor: u32) -> vec2<u32> {
    var rest = WHOLE % divisor;
    var fraction = 0u;
    for (var bit = 0u; bit < 32u; bit++) {
        // The bit that the doubled rest loses.
        let carry = rest >> 31u;
        rest <<= 1u;
        fraction <<= 1u;
        if carry == 1u || rest >= divisor {
            rest -= divisor;
            fraction |= 1u;
        }
    }
    return vec2(WHOLE / divisor, fraction);
}
