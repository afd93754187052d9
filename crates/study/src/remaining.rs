//! Estimates the remaining time of a study.

use crate::record::Cell;
use std::collections::HashMap;
use std::time::Duration;

/// Times of finished cells.
#[derive(Debug, Default)]
pub(crate) struct Remaining {
    /// Seconds and number of cells, by scene and pipeline.
    known: HashMap<(String, String), (f64, usize)>,
}

impl Remaining {
    pub(crate) fn add(&mut self, cell: &Cell) {
        let known = self.known.entry((cell.scene.clone(), cell.pipeline.clone())).or_default();
        known.0 += cell.seconds;
        known.1 += 1;
    }

    /// Returns an estimate of the time of these cells, each given by its scene and pipeline: from finished
    /// cells with the same scene and pipeline, or otherwise from all.
    pub(crate) fn estimate<'a>(&self, cells: impl Iterator<Item = (&'a str, &'a str)>) -> Duration {
        let mean = |(seconds, count): (f64, usize)| seconds / count.max(1) as f64;
        let all = mean(self.known.values().fold((0.0, 0), |sum, one| (sum.0 + one.0, sum.1 + one.1)));
        let of = |(scene, pipeline): (&str, &str)| {
            self.known.get(&(scene.to_owned(), pipeline.to_owned())).map_or(all, |known| mean(*known))
        };
        Duration::try_from_secs_f64(cells.map(of).sum()).unwrap_or(Duration::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell(pipeline: &str, seconds: f64) -> Cell {
        let (scene, pipeline) = ("box".to_owned(), pipeline.to_owned());
        Cell { scene, pipeline, seconds, ..Cell::default() }
    }

    #[test]
    fn cells_take_as_long_as_their_like_or_as_all() {
        let mut remaining = Remaining::default();
        assert_eq!(remaining.estimate([("box", "slow")].into_iter()), Duration::ZERO, "nothing is known");
        for (pipeline, seconds) in [("slow", 10.0), ("slow", 14.0), ("fast", 3.0)] {
            remaining.add(&cell(pipeline, seconds));
        }
        // 12 and 3, and of another pipeline the mean of all: 27 / 3.
        let left = remaining.estimate([("box", "slow"), ("box", "fast"), ("box", "new")].into_iter());
        assert_eq!(left, Duration::from_secs(24));
    }
}
