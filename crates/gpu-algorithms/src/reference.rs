//! CPU references of the algorithms, and of WGSL that several passes share: what results are compared with, in double
//! precision or integers.

pub mod clustering;
pub mod disc_shadow;
pub mod paraboloid;
pub mod paraboloid_lookup;
pub mod triangle_samples;

/// Returns the sum.
pub fn sum(weights: impl IntoIterator<Item = f64>) -> f64 {
    weights.into_iter().sum()
}

/// Returns the sums without each element, and with it; modulo 2³².
pub fn scan(numbers: &[u32]) -> Vec<(u32, u32)> {
    let mut sum = 0_u32;
    numbers
        .iter()
        .map(|number| {
            let before = sum;
            sum = sum.wrapping_add(*number);
            (before, sum)
        })
        .collect()
}

/// Returns the prefix sums of each segment of `length` weights, and the segments' totals.
pub fn segmented_scan(weights: &[f64], length: usize) -> (Vec<f64>, Vec<f64>) {
    let mut sums = Vec::with_capacity(weights.len());
    let mut totals = Vec::new();
    for segment in weights.chunks_exact(length) {
        let mut sum = 0.0;
        sums.extend(segment.iter().map(|weight| {
            sum += weight;
            sum
        }));
        totals.push(sum);
    }
    (sums, totals)
}

/// Returns the numbers of the elements that stay.
pub fn compact(length: u32, keeps: impl Fn(u32) -> bool) -> Vec<u32> {
    (0..length).filter(|i| keeps(*i)).collect()
}

/// Returns pairs of key and value in the order of their keys; pairs with equal keys keep their order.
pub fn sort(pairs: &[(u32, u32)]) -> Vec<(u32, u32)> {
    let mut sorted = pairs.to_vec();
    sorted.sort_by_key(|(key, _)| *key);
    sorted
}

/// Returns the key of a rank, from 0 for the smallest; the greatest where the rank is beyond all, `u32::MAX` of none.
pub fn select(keys: &[u32], rank: u32) -> u32 {
    let mut sorted = keys.to_vec();
    sorted.sort_unstable();
    sorted.get(rank as usize).or(sorted.last()).copied().unwrap_or(u32::MAX)
}

/// Replaces the values of a workgroup by their prefix sums in single precision, in the order of `prefix_sum` in
/// `shaders/algorithms/workgroup.wgsl` (Sklansky 1960): what that order promises can be tested without a GPU.
pub fn workgroup_prefix_sum(values: &mut [f32]) {
    let mut width = 1;
    while width < values.len() {
        for thread in (0..values.len()).filter(|thread| thread & width != 0) {
            values[thread] += values[(thread & !(width - 1)) - 1];
        }
        width *= 2;
    }
}
