//! Tests whether counts follow a distribution.

/// Returns the value that chi squared of this many degrees of freedom exceeds once in a million (Wilson & Hilferty
/// 1931).
pub fn chi_squared_limit(freedom: f64) -> f64 {
    let ninth = 2.0 / (9.0 * freedom);
    freedom * (1.0 - ninth + 4.753 * ninth.sqrt()).powi(3)
}

/// Computes chi squared of counts and its degrees of freedom. Cells with an expectation below five are merged into one.
pub fn chi_squared(observed: &[u32], expected: &[f64]) -> (f64, f64) {
    let (mut statistic, mut freedom, mut rest) = (0.0, -1.0, (0.0, 0.0));
    for (n, expected) in std::iter::zip(observed, expected) {
        if *expected >= 5.0 {
            statistic += (f64::from(*n) - expected).powi(2) / expected;
            freedom += 1.0;
        } else {
            rest = (rest.0 + expected, rest.1 + f64::from(*n));
        }
    }
    if rest.0 > 0.0 {
        statistic += f64::powi(rest.1 - rest.0, 2) / rest.0;
        freedom += 1.0;
    }
    (statistic, freedom)
}

/// Asserts by chi squared that counts are those of independent samples. Stratified samples do better.
///
/// # Panics
/// Where they are not.
pub fn assert_follows(observed: &[u32], expected: &[f64]) {
    let (statistic, freedom) = chi_squared(observed, expected);
    let limit = chi_squared_limit(freedom);
    assert!(
        statistic < limit,
        "chi squared is {statistic}, of {freedom} degrees of freedom: more than {limit}"
    );
}

/// Returns the mean, and the standard deviation of the mean.
pub fn spread(values: impl Iterator<Item = f32>) -> (f64, f64) {
    let values: Vec<f64> = values.map(f64::from).collect();
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}
