//! How long the rest of a study takes.

use crate::record::Cell;
use std::collections::HashMap;
use std::time::Duration;

/// Times of cells so far.
#[derive(Debug, Default)]
pub(crate) struct Remaining {
    /// Seconds and number, by scene and pipeline.
    known: HashMap<(String, String), (f64, usize)>,
}

impl Remaining {
    pub(crate) fn add(&mut self, cell: &Cell) {
        let known = self.known.entry((cell.scene.clone(), cell.pipeline.clone())).or_default();
        known.0 += cell.seconds;
        known.1 += 1;
    }

    /// The time of so many cells, each told by its scene and pipeline: as those of the same took, or else all.
    pub(crate) fn estimate<'a>(&self, cells: impl Iterator<Item = (&'a str, &'a str)>) -> Duration {
        let mean = |(seconds, count): (f64, usize)| seconds / count.max(1) as f64;
        let all = mean(self.known.values().fold((0.0, 0), |sum, one| (sum.0 + one.0, sum.1 + one.1)));
        let of = |(scene, pipeline): (&str, &str)| {
            self.known.get(&(scene.to_owned(), pipeline.to_owned())).map_or(all, |known| mean(*known))
        };
        Duration::try_from_secs_f64(cells.map(of).sum()).unwrap_or(Duration::MAX)
    }
}
