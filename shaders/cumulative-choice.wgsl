// A choice by a cumulative distribution: the inverse transform method.
//
// The shader that imports this file gives
//   struct Distribution                                   names one of its distributions
//   fn cumulated(which: Distribution, i: u32) -> f32      the sum of its weights from 0 to i

struct Choice {
    index: u32,
    probability: f32,
    /// Position of the number in the chosen interval, in [0, 1): as uniform as the number was (Shirley & Wang 1991).
    rest: f32,
}

/// The first of `count` entries whose sum exceeds number · total; total must not be 0.
///
/// The probability is the width of the interval that the search sees, not weight / total: so the estimator has no bias
/// from the rounding of the sums, whichever way they were computed.
fn choose(which: Distribution, count: u32, number: f32) -> Choice {
    let total = cumulated(which, count - 1u);
    // number · total can round up to total; below it, the last entry with a weight is found.
    let sought = min(number * total, bitcast<f32>(bitcast<u32>(total) - 1u));
    var low = 0u;
    var high = count - 1u;
    while low < high {
        let middle = (low + high) / 2u;
        if cumulated(which, middle) > sought {
            high = middle;
        } else {
            low = middle + 1u;
        }
    }
    var before = 0.0;
    if low > 0u {
        before = cumulated(which, low - 1u);
    }
    let width = cumulated(which, low) - before;
    // An interval that 24-bit numbers can hit at all is hit as often as one of 2^-24:
    // otherwise a weight of 1e-30 at the start of a row would give a light 1e30 times too bright.
    let probability = max(width / total, 1.0 / 16777216.0);
    return Choice(low, probability, clamp((sought - before) / width, 0.0, 0.99999994));
}
