// Quotients and comparisons of weights, which may be farther apart than the range of f32.

#import "algorithms/scaled.wgsl"

/// a / b, with a value in [1, 2); 0 where one of both is.
fn quotient(a: Scaled, b: Scaled) -> Scaled {
    if a.value == 0.0 || b.value == 0.0 {
        return Scaled(0.0, 0);
    }
    let exponent = magnitude(a) - magnitude(b);
    let value = in_units(a, magnitude(a)) / in_units(b, magnitude(b));
    if value < 1.0 {
        return Scaled(2.0 * value, exponent - 1);
    }
    return Scaled(value, exponent);
}

/// Whether a weight is not below a threshold: then its point is certain to be taken.
fn is_certain(weight: Scaled, threshold: Scaled) -> bool {
    let unit = magnitude(weight);
    if unit != magnitude(threshold) {
        return unit > magnitude(threshold);
    }
    return in_units(weight, unit) >= in_units(threshold, unit);
}
