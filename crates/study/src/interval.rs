//! A figure over seeds.

use metrics::statistics::Summary;

/// A mean over seeds, with how sure it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// How many seeds, at least 1.
    pub seeds: usize,
    /// Their mean.
    pub mean: f64,
    /// Half the width of the 95 % interval of the mean (Student's t); `None` for one seed, and where all seeds agree:
    /// what does not depend on them has no spread to tell.
    pub half: Option<f64>,
}

impl Interval {
    /// Of a value a seed; `None` where there is none.
    pub(crate) fn of(values: &[f64]) -> Option<Interval> {
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
