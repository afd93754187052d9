//! Further seeds of a picture whose energy is off. Few lights or few pixels vary much from seed to seed, which is no defect;
//! the mean distinguishes the two.

use std::ops::RangeInclusive;
use study::Interval;

/// Seeds that are rendered before anything is concluded: a rare bright one may be missing among fewer.
pub(crate) const FEWEST: u32 = 16;

/// The most seeds of a cell.
pub(crate) const MOST: u32 = 64;

/// Returns whether no more seeds are needed: the interval lies inside the allowed range, or outside.
pub(crate) fn is_decided(mean: &Interval, allowed: &RangeInclusive<f64>) -> bool {
    let half = mean.half.unwrap_or(0.0);
    let (low, high) = (mean.mean - half, mean.mean + half);
    let within = allowed.contains(&low) && allowed.contains(&high);
    let beyond = high < *allowed.start() || low > *allowed.end();
    mean.seeds >= FEWEST as usize && (within || beyond)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_decides_once_it_is_within_what_is_allowed_or_beyond() {
        let decided =
            |mean, half, seeds| is_decided(&Interval { seeds, mean, half: Some(half) }, &(0.5..=2.0));
        assert!(decided(1.0, 0.4, 16) && decided(0.3, 0.1, 16) && decided(2.5, 0.1, 16));
        assert!(!decided(0.6, 0.2, 16) && !decided(0.4, 0.2, 16) && !decided(1.9, 0.2, 16));
        assert!(!decided(1.0, 0.0, 15), "of too few seeds");
    }
}
