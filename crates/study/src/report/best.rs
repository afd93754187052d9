//! The best values of a column, by the paired test that decides claims.

use crate::Better;
use crate::claim::{Seeds, is_less, mean};
use crate::interval::Interval;

/// Returns for each of some values over seeds whether it is the best, or is not distinguishable from that: the best has the best
/// mean, and another is worse where that holds seed by seed, beyond the 95 % interval, or where the intervals of both
/// are apart: few seeds in common decide little. `floor` is the error of the
/// reference itself: errors below it are alike. None is the best where no direction is better, and where all are alike;
/// nor is a value whose interval is wider than its mean.
pub(super) fn best(better: Better, values: &[Option<Seeds>], floor: Option<f64>) -> Vec<bool> {
    let none = vec![false; values.len()];
    let floor = floor.filter(|_| better == Better::Lower);
    let costs =
        |seeds: &Seeds| -> Seeds { seeds.iter().map(|(seed, x)| (*seed, cost(better, *x))).collect() };
    let all: Vec<Option<Seeds>> = values.iter().map(|seeds| seeds.as_ref().map(costs)).collect();
    let least = values
        .iter()
        .zip(&all)
        .filter_map(|(seeds, costs)| Some((cost(better, mean(seeds.as_ref()?)?), costs.as_ref()?)));
    let Some((_, first)) = least.min_by(|a, b| a.0.total_cmp(&b.0)) else { return none };
    let is_worse = |costs: &Seeds| is_less(first, costs, floor) || are_apart(first, costs, floor);
    let alike = |costs: &Option<Seeds>| costs.as_ref().map(|costs| !is_worse(costs));
    let alike: Vec<Option<bool>> = all.iter().map(alike).collect();
    if better == Better::Neither || !alike.contains(&Some(false)) {
        return none;
    }
    let is_known = |seeds: &Option<Seeds>| seeds.as_ref().is_some_and(|seeds| !is_wide(seeds));
    values.iter().zip(alike).map(|(seeds, alike)| alike == Some(true) && is_known(seeds)).collect()
}

/// Whether the interval of one mean ends below that of another, and not below `floor`.
fn are_apart(less: &Seeds, more: &Seeds, floor: Option<f64>) -> bool {
    let (Some(less), Some(more)) = (interval(less), interval(more)) else { return false };
    let ends = (less.mean + less.half.unwrap_or(0.0), more.mean - more.half.unwrap_or(0.0));
    ends.0 < ends.1 && floor.is_none_or(|floor| more.mean >= floor)
}

/// Whether half the interval of a mean exceeds it.
fn is_wide(seeds: &Seeds) -> bool {
    interval(seeds).is_some_and(|interval| interval.half.is_some_and(|half| half > interval.mean.abs()))
}

fn interval(seeds: &Seeds) -> Option<Interval> {
    Interval::of(&seeds.values().copied().collect::<Vec<f64>>())
}

/// The cost of a value: the lower, the better.
fn cost(better: Better, value: f64) -> f64 {
    match better {
        Better::Lower | Better::Neither => value,
        Better::Higher => -value,
        Better::One => (value - 1.0).abs(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn marked(better: Better, values: &[&[f64]], floor: Option<f64>) -> Vec<bool> {
        let seeds = |values: &&[f64]| Some((1..).zip(values.iter().copied()).collect());
        best(better, &values.iter().map(seeds).collect::<Vec<_>>(), floor)
    }

    #[test]
    fn seeds_tell_apart_what_intervals_do_not() {
        // Intervals of 3 ± 2.5 overlap; from seed to seed, the second is worse by 0.1.
        let (a, b, c) = ([2.0, 3.0, 4.0], [2.1, 3.1, 4.1], [1.9, 3.2, 4.0]);
        assert_eq!(marked(Better::Lower, &[&a, &b, &c], None), [true, false, true]);
        assert_eq!(marked(Better::Higher, &[&a, &b, &c], None), [false, true, true]);
        assert_eq!(marked(Better::Lower, &[&a, &c], None), [false; 2], "both are alike");
        assert_eq!(marked(Better::Neither, &[&a, &b, &c], None), [false; 3]);
        assert_eq!(marked(Better::Lower, &[&[1.0], &[1.1]], None), [true, false], "one seed has no interval");
    }

    #[test]
    fn what_two_seeds_do_not_tell_apart_intervals_may() {
        // One seed in common has no interval; two have one of 12.7 deviations.
        let best_of_two: Option<Seeds> = Some([(1, 0.0011), (2, 0.0012)].into());
        let worse: Option<Seeds> = Some([(1, 0.055), (2, 0.0625), (3, 0.0595)].into());
        assert_eq!(best(Better::Lower, &[best_of_two, worse], None), [true, false]);
    }

    #[test]
    fn what_is_wider_than_its_mean_is_not_the_best() {
        let (noisy, good, bad) = ([40.0, 37.0, 2300.0], [49.0, 45.0, 55.0], [80.0, 85.0, 90.0]);
        assert_eq!(marked(Better::Lower, &[&noisy, &good, &bad], None), [false, true, false]);
    }

    #[test]
    fn nearness_to_one_has_two_sides() {
        let (near, beyond, far) = ([0.98, 0.97, 0.99], [1.03, 1.01, 1.02], [0.9, 0.91, 0.89]);
        assert_eq!(marked(Better::One, &[&near, &beyond, &far], None), [true, true, false]);
    }

    #[test]
    fn errors_below_that_of_the_reference_are_alike() {
        let values: [&[f64]; 3] = [&[0.001, 0.0011], &[0.003, 0.0031], &[0.006, 0.0061]];
        assert_eq!(marked(Better::Lower, &values, Some(0.004)), [true, true, false]);
        assert_eq!(marked(Better::Lower, &values, Some(0.0001)), [true, false, false]);
        assert_eq!(marked(Better::Lower, &values, Some(0.1)), [false; 3]);
    }
}
