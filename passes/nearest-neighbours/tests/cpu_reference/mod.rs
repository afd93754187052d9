//! Densities by definition, in double precision.

use std::f64::consts::PI;

/// Returns k of SMC-IR Eq. 8 for `count` points, at most 32.
pub(crate) fn consistent_k(count: u32) -> u32 {
    let mut k = 1;
    while k < 32 && u64::from(32 * (k + 1)).pow(2) <= u64::from(count) {
        k += 1;
    }
    k
}

/// Returns p of SMC-IR Eq. 7 \[1/m²\] of a point, by the squared distances \[m²\] to its neighbours among `count` points. Those
/// that are 0 are left out; where fewer than k are left, the farthest counts, and where none is, the area of the scene \[m²\].
pub(crate) fn density(squared: impl IntoIterator<Item = f64>, k: u32, count: u32, scene_area: f64) -> f64 {
    let mut squared: Vec<f64> = squared.into_iter().filter(|squared| *squared > 0.0).collect();
    squared.sort_by(f64::total_cmp);
    squared.truncate(k as usize);
    match squared.last() {
        Some(farthest) => squared.len() as f64 / (f64::from(count) * PI * farthest),
        None => 1.0 / scene_area,
    }
}
