//! Further seeds of a picture whose energy is off. Few lights or few pixels vary much from seed to seed, which is no defect;
//! the mean distinguishes the two.

use metrics::statistics::Summary;
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// Seeds that are rendered before anything is concluded: a rare bright one may be missing among fewer.
const FEWEST: u32 = 16;

/// The most seeds of a cell.
pub(crate) const MOST: u32 = 64;

/// The energy of a cell by several seeds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Seeds {
    /// Number of seeds without that of the first picture, which was chosen for being off.
    pub count: u32,
    /// Mean of their energies, as [`Cell::energy`](crate::Cell::energy) counts them.
    pub energy: f64,
    /// Half the width of the 95 % confidence interval of the mean.
    pub half_width: f64,
    /// The energy of the first picture.
    pub first: f64,
}

impl Seeds {
    /// Summarizes the energies of at least two seeds.
    pub(crate) fn of(first: f64, energies: &[f64]) -> Option<Seeds> {
        let Summary { n, mean, half_width_95, .. } = Summary::of(energies)?;
        Some(Seeds { count: n as u32, energy: mean, half_width: half_width_95, first })
    }

    /// Returns whether no more seeds are needed: the interval lies inside the allowed range, or outside.
    pub(crate) fn is_decided(&self, allowed: &RangeInclusive<f64>) -> bool {
        let (low, high) = (self.energy - self.half_width, self.energy + self.half_width);
        let within = allowed.contains(&low) && allowed.contains(&high);
        let beyond = high < *allowed.start() || low > *allowed.end();
        self.count >= FEWEST && (within || beyond)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_decides_once_it_is_within_what_is_allowed_or_beyond() {
        let decided = |energy, half_width, count| {
            Seeds { count, energy, half_width, first: 0.3 }.is_decided(&(0.5..=2.0))
        };
        assert!(decided(1.0, 0.4, FEWEST) && decided(0.3, 0.1, FEWEST) && decided(2.5, 0.1, FEWEST));
        assert!(!decided(0.6, 0.2, FEWEST) && !decided(0.4, 0.2, FEWEST) && !decided(1.9, 0.2, FEWEST));
        assert!(!decided(1.0, 0.0, FEWEST - 1), "of too few seeds");
    }
}
