// A running sum of many numbers, of which no part grows by more than a few: added one by one to the sum of all before, each would
// lose as many digits as that has more, and equal numbers all to the same side.

/// Parts of a running sum: of the numbers themselves, of sums of CARRIED numbers, and so on. The last takes what is left.
struct CarriedSum {
    parts: vec4<f32>,
    /// The count of numbers.
    count: u32,
}

/// Numbers that a part takes before it is added to the next.
const CARRIED: u32 = 16u;

/// Returns the sum of all numbers so far and of another. For numbers that are not negative it never falls, and with 0 it is what
/// it was with the last number before that was added: each addition keeps the order of what it is given.
fn carried_sum(sum: CarriedSum, x: f32) -> f32 {
    return sum.parts.w + (sum.parts.z + (sum.parts.y + (sum.parts.x + x)));
}

/// Returns the sum with one more number.
fn with_number(sum: CarriedSum, x: f32) -> CarriedSum {
    var parts = sum.parts;
    let count = sum.count + 1u;
    parts.x += x;
    if count % CARRIED == 0u {
        parts.y += parts.x;
        parts.x = 0.0;
    }
    if count % (CARRIED * CARRIED) == 0u {
        parts.z += parts.y;
        parts.y = 0.0;
    }
    if count % (CARRIED * CARRIED * CARRIED) == 0u {
        parts.w += parts.z;
        parts.z = 0.0;
    }
    return CarriedSum(parts, count);
}
