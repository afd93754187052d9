//! A mean over seeds, with its confidence interval.

use metrics::statistics::Summary;
use report::Measured;
use serde::Serialize;

/// A mean over seeds, with its 95 % confidence interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Interval {
    /// Number of seeds, at least 1.
    pub seeds: usize,
    /// The mean over the seeds.
    pub mean: f64,
    /// Half the width of the 95 % confidence interval of the mean (Student's t); `None` for one seed, and if
    /// all seeds have the same value, since such a measure does not depend on the seed.
    pub half: Option<f64>,
}

impl Interval {
    /// Returns the mean as it is printed.
    pub(crate) fn measured(&self) -> Measured {
        Measured::new(self.mean, self.half)
    }

    /// Computes the interval of one value per seed; `None` if there are none.
    pub fn of(values: &[f64]) -> Option<Interval> {
        let first = *values.first()?;
        let half = if values.iter().all(|value| *value == first) { None } else { Summary::of(values) };
        Some(match half {
            Some(summary) => {
                Interval { seeds: summary.n, mean: summary.mean, half: Some(summary.half_width_95) }
            }
            None => Interval { seeds: values.len(), mean: first, half: None },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::Interval;

    #[test]
    fn seeds_that_agree_have_no_interval() {
        assert_eq!(Interval::of(&[]), None);
        assert_eq!(Interval::of(&[2.0]), Some(Interval { seeds: 1, mean: 2.0, half: None }));
        assert_eq!(Interval::of(&[0.1; 3]), Some(Interval { seeds: 3, mean: 0.1, half: None }));
        // Two values, one degree of freedom: t = 12.706, standard error 1.
        let of_two = Interval::of(&[1.0, 3.0]).unwrap();
        assert_eq!((of_two.seeds, of_two.mean), (2, 2.0));
        assert!((of_two.half.unwrap() - 12.706).abs() < 1e-3, "{of_two:?}");
    }
}
