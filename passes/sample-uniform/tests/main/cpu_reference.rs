//! `sample-uniform.wgsl` in double precision.

/// Returns the texel `(layer, x, y)` that three numbers in [0, 1) select among `layers` layers of `size`
/// texels.
pub(crate) fn texel(numbers: [f64; 3], size: (u32, u32), layers: u32) -> (u32, u32, u32) {
    let pick = |number: f64, of: u32| ((number * f64::from(of)) as u32).min(of - 1);
    (pick(numbers[0], layers), pick(numbers[1], size.0), pick(numbers[2], size.1))
}

/// Returns the factor by which the flux of a sampled texel is multiplied: 1 / (N p) for `count` lights.
pub(crate) fn weight(size: (u32, u32), layers: u32, count: u32) -> f64 {
    f64::from(size.0) * f64::from(size.1) * f64::from(layers) / f64::from(count)
}
