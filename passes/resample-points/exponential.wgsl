// Exponentially distributed times from uniform numbers.

/// A time of rate 1 from a number in [0, 1): -log(1 - x).
fn exponential_time(x: f32) -> f32 {
    // The difference has lost digits where x is small, and so has a logarithm near 0. There: 2 artanh(z) in powers of z.
    let z = x / (2.0 - x);
    let z2 = z * z;
    let series = 2.0 * z * (1.0 + z2 * (1.0 / 3.0 + z2 * (0.2 + z2 * (1.0 / 7.0))));
    return select(-log(1.0 - x), series, x < 0.25);
}
