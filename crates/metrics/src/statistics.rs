//! Statistics over several runs: means with confidence intervals.

use serde::Serialize;

/// A mean over independent values, such as one measure over several seeds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Summary {
    /// Number of values, at least 2.
    pub n: usize,
    /// The mean.
    pub mean: f64,
    /// The standard deviation, with the denominator n − 1.
    pub standard_deviation: f64,
    /// Half the width of the 95 % confidence interval of the mean: t · deviation / √n, where t is the 0.975
    /// quantile of Student's distribution with n − 1 degrees of freedom. It is valid for values that are
    /// normally distributed, or for many values.
    pub half_width_95: f64,
}

impl Summary {
    /// Summarises `values`; `None` for fewer than two, which have no spread, or if one is NaN or infinite.
    pub fn of(values: &[f64]) -> Option<Self> {
        if values.len() < 2 || !values.iter().all(|value| value.is_finite()) {
            return None;
        }
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0);
        let standard_deviation = variance.sqrt();
        let half_width_95 = student_t_975(values.len() - 1) * standard_deviation / n.sqrt();
        Some(Self { n: values.len(), mean, standard_deviation, half_width_95 })
    }
}

/// Sorts values and returns their median: the middle one, or the mean of the two in the middle; `None` if
/// there are none.
pub fn median(values: &mut [f64]) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let last = values.len().checked_sub(1)?;
    Some(0.5 * (values[last / 2] + values[last.div_ceil(2)]))
}

/// Returns the 0.975 quantile of Student's distribution with `freedom` degrees of freedom, at least 1. It is
/// found by bisection of θ = atan(t / √freedom).
fn student_t_975(freedom: usize) -> f64 {
    let (mut low, mut high) = (0.0, std::f64::consts::FRAC_PI_2);
    for _ in 0..f64::MANTISSA_DIGITS {
        let middle = 0.5 * (low + high);
        if probability_below(middle, freedom) < 0.95 { low = middle } else { high = middle }
    }
    low.tan() * (freedom as f64).sqrt()
}

/// Returns P(|T| < t) for θ = atan(t / √freedom), as a finite sum (Abramowitz and Stegun, 26.7.3 and 26.7.4).
/// O(freedom).
fn probability_below(theta: f64, freedom: usize) -> f64 {
    let (sin, cos) = theta.sin_cos();
    let odd = freedom % 2 == 1;
    // Odd: cos + 2/3 cos³ + 2·4/(3·5) cos⁵ …; even: 1 + 1/2 cos² + 1·3/(2·4) cos⁴ …; the last is
    // cos^(freedom − 2).
    let (mut term, first) = if odd { (cos, 3) } else { (1.0, 2) };
    let mut sum = 0.0;
    for below in (first..=freedom).step_by(2) {
        sum += term;
        term *= cos * cos * (below - 1) as f64 / below as f64;
    }
    if odd { std::f64::consts::FRAC_2_PI * (theta + sin * sum) } else { sin * sum }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn by_hand() {
        // 1 2 3 6: mean 3, squares 4 1 0 9, deviation √(14/3); t for 3 degrees is 3.182446.
        let summary = Summary::of(&[1.0, 2.0, 3.0, 6.0]).unwrap();
        assert_eq!((summary.n, summary.mean), (4, 3.0));
        let deviation = (14.0_f64 / 3.0).sqrt();
        assert!((summary.standard_deviation - deviation).abs() < 1e-12);
        assert!((summary.half_width_95 - 3.182_446 * deviation / 2.0).abs() < 1e-5, "{summary:?}");
        assert_eq!(Summary::of(&[1.0]), None);
        assert_eq!(Summary::of(&[]), None);
        assert_eq!(Summary::of(&[1.0, f64::NAN]), None);
    }

    #[test]
    fn the_median_is_the_middle_or_the_mean_of_two() {
        let mut values = [3.0, 10.0, 2.0];
        assert_eq!(median(&mut values), Some(3.0));
        assert_eq!(values, [2.0, 3.0, 10.0]);
        assert_eq!(median(&mut [4.0, 1.0, 9.0, 2.0]), Some(3.0));
        assert_eq!(median(&mut []), None);
    }

    #[test]
    fn quantiles_are_those_of_tables() {
        // One and two degrees have closed forms; the others are printed in every table.
        let one = (0.475 * std::f64::consts::PI).tan();
        let two = 0.95 * (2.0 / (1.0 - 0.95_f64.powi(2))).sqrt();
        assert!((student_t_975(1) / one - 1.0).abs() < 1e-12, "{}", student_t_975(1));
        assert!((student_t_975(2) / two - 1.0).abs() < 1e-12, "{}", student_t_975(2));
        for (freedom, t) in [(3, 3.182), (4, 2.776), (9, 2.262), (10, 2.228), (30, 2.042), (120, 1.980)] {
            assert!((student_t_975(freedom) - t).abs() < 5e-4, "{freedom}: {}", student_t_975(freedom));
        }
        // It converges to the normal distribution.
        assert!((student_t_975(100_000) - 1.959_964).abs() < 5e-5, "{}", student_t_975(100_000));
    }
}
