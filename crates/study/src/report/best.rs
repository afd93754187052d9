//! The best values of a column, within their intervals.

use crate::{Better, Interval};

/// The values that are not known to be worse than the best one.
pub(super) struct Best {
    better: Better,
    /// The cost of a value that is just as good as the best may be.
    bound: f64,
}

impl Best {
    /// Returns the best of some values: that with the best mean, and all whose 95 % intervals overlap its own.
    /// `floor` is the error of the reference itself: errors below it are alike. `None` if that is all values, or no
    /// direction is better.
    pub(super) fn of(better: Better, values: &[Interval], floor: Option<f64>) -> Option<Best> {
        if better == Better::Neither {
            return None;
        }
        let mean = |value: &&Interval| costs(better, &Interval { half: None, ..**value }).0;
        let best = values.iter().min_by(|a, b| mean(a).total_cmp(&mean(b)))?;
        let bound = costs(better, best).1;
        let bound = floor.filter(|_| better == Better::Lower).map_or(bound, |floor| bound.max(floor));
        let best = Best { better, bound };
        (!values.iter().all(|value| best.includes(value))).then_some(best)
    }

    /// Returns whether a value is the best, or is not distinguishable from it.
    pub(super) fn includes(&self, value: &Interval) -> bool {
        costs(self.better, value).0 <= self.bound
    }
}

/// Returns the least and the greatest cost in an interval: the lower, the better.
fn costs(better: Better, value: &Interval) -> (f64, f64) {
    let half = value.half.unwrap_or(0.0);
    let (low, high) = (value.mean - half, value.mean + half);
    match better {
        Better::Lower | Better::Neither => (low, high),
        Better::Higher => (-high, -low),
        Better::One => {
            let (a, b) = ((low - 1.0).abs(), (high - 1.0).abs());
            (if (low..=high).contains(&1.0) { 0.0 } else { a.min(b) }, a.max(b))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns for each value, mean and half width, whether it is among the best.
    fn best(better: Better, values: &[(f64, f64)], floor: Option<f64>) -> Vec<bool> {
        let half = |half: f64| (half > 0.0).then_some(half);
        let values: Vec<Interval> =
            values.iter().map(|&(mean, width)| Interval { seeds: 3, mean, half: half(width) }).collect();
        let best = Best::of(better, &values, floor);
        values.iter().map(|value| best.as_ref().is_some_and(|best| best.includes(value))).collect()
    }

    #[test]
    fn what_overlaps_the_best_is_as_good() {
        let values = [(1.0, 0.1), (1.15, 0.1), (1.3, 0.1), (0.5, 0.0)];
        assert_eq!(best(Better::Lower, &values[..3], None), [true, true, false]);
        assert_eq!(best(Better::Lower, &values, None), [false, false, false, true], "without an interval");
        assert_eq!(best(Better::Higher, &values, None), [false, true, true, false]);
        assert_eq!(
            best(Better::Lower, &values[..2], None),
            [false, false],
            "all are alike: none is the best"
        );
        assert_eq!(best(Better::Neither, &values, None), [false; 4]);
    }

    #[test]
    fn nearness_to_one_has_two_sides() {
        let values = [(0.98, 0.005), (1.03, 0.02), (0.9, 0.02), (1.04, 0.01)];
        assert_eq!(best(Better::One, &values, None), [true, true, false, false]);
        assert_eq!(best(Better::One, &[(0.9, 0.2), (1.05, 0.0), (1.2, 0.01)], None), [true, true, false]);
    }

    #[test]
    fn errors_below_that_of_the_reference_are_alike() {
        let values = [(0.001, 0.0001), (0.003, 0.0001), (0.006, 0.0001)];
        assert_eq!(best(Better::Lower, &values, Some(0.004)), [true, true, false]);
        assert_eq!(best(Better::Lower, &values, Some(0.0001)), [true, false, false]);
        assert_eq!(best(Better::Lower, &values, Some(0.1)), [false; 3]);
    }
}
