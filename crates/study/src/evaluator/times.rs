//! GPU time of passes, phases and frames.

use crate::description::Phase;
use crate::record::PassTime;
use metrics::statistics::median;

/// Collects the GPU times of frames.
pub(super) struct Times<'a> {
    phases: &'a [Phase],
    /// One value per frame for each pass \[ms\].
    passes: Vec<(String, Vec<f64>)>,
    totals: Vec<f64>,
    /// For each phase, one value for each frame in which some of its passes ran.
    sums: Vec<Vec<f64>>,
}

impl<'a> Times<'a> {
    pub(super) fn new(phases: &'a [Phase]) -> Times<'a> {
        Times { phases, passes: Vec::new(), totals: Vec::new(), sums: vec![Vec::new(); phases.len()] }
    }

    /// Adds a frame; does nothing if the frame was not timed.
    pub(super) fn add(&mut self, passes: &[(String, f64)]) {
        if passes.is_empty() {
            return;
        }
        if self.passes.is_empty() {
            self.passes = passes.iter().map(|(name, _)| (name.clone(), Vec::new())).collect();
        }
        for ((_, column), (_, ms)) in self.passes.iter_mut().zip(passes) {
            column.push(*ms);
        }
        self.totals.push(passes.iter().map(|(_, ms)| ms).sum());
        for (phase, sums) in self.phases.iter().zip(&mut self.sums) {
            let times: Vec<f64> =
                passes.iter().filter(|(pass, _)| phase.has(pass)).map(|(_, ms)| *ms).collect();
            // If none of its passes ran, a phase has no value.
            if !times.is_empty() {
                sums.push(times.iter().sum());
            }
        }
    }

    /// Returns the GPU time of a frame: the median, or the sum of all frames.
    pub(super) fn total(&self, over_frames: bool) -> Option<f64> {
        of(&self.totals, over_frames)
    }

    /// Returns the GPU time of each phase with its key: the median over frames, or the sum of all.
    pub(super) fn phases(&self, over_frames: bool) -> impl Iterator<Item = (String, Option<f64>)> {
        self.phases.iter().zip(&self.sums).map(move |(phase, sums)| (phase.key(), of(sums, over_frames)))
    }

    /// Returns the GPU time of the last frame.
    pub(super) fn last_total(&self) -> Option<f64> {
        self.totals.last().copied()
    }

    /// Returns the GPU time of each phase in the last frame, with its key.
    pub(super) fn last_phases(&self) -> impl Iterator<Item = (String, Option<f64>)> {
        self.phases.iter().zip(&self.sums).map(|(phase, sums)| (phase.key(), sums.last().copied()))
    }

    /// Returns the median of each pass, in the order of the plan.
    pub(super) fn medians(&self) -> Vec<PassTime> {
        let time = |(pass, ms): &(String, Vec<f64>)| PassTime {
            pass: pass.clone(),
            gpu_ms: median(&mut ms.clone()).unwrap_or(0.0),
        };
        self.passes.iter().map(time).collect()
    }
}

fn of(frames: &[f64], over_frames: bool) -> Option<f64> {
    if over_frames {
        return (!frames.is_empty()).then(|| frames.iter().sum());
    }
    median(&mut frames.to_vec())
}

#[cfg(test)]
mod tests {
    use super::Times;
    use crate::description::{At, Phase};
    use frame_graph::{Source, Span};

    fn phase(name: &str, passes: &[&str]) -> Phase {
        let span = Span { source: Source::new("x.ron", ""), start: 0, end: 0 };
        let at = |text: &&str| At { value: (*text).to_owned(), span: span.clone() };
        Phase { name: at(&name), passes: passes.iter().map(at).collect() }
    }

    #[test]
    fn a_phase_is_the_median_of_sums() {
        let phases = [phase("both", &["a", "part/b", "part"]), phase("b", &["part"]), phase("none", &["c"])];
        let mut times = Times::new(&phases);
        for (a, b) in [(1.0, 9.0), (2.0, 1.0), (9.0, 2.0)] {
            times.add(&[("a".to_owned(), a), ("part/b".to_owned(), b), ("rest".to_owned(), 100.0)]);
        }
        // Sums 10, 3, 11; the medians of a and b, 2 and 2, would give 4. A pass that two entries name counts once.
        let found = |over_frames| -> Vec<(String, Option<f64>)> { times.phases(over_frames).collect() };
        let expected = |values: [Option<f64>; 3]| {
            ["gpu-ms:both", "gpu-ms:b", "gpu-ms:none"].map(str::to_owned).into_iter().zip(values)
        };
        assert!(found(false).into_iter().eq(expected([Some(10.0), Some(2.0), None])), "{:?}", found(false));
        assert!(found(true).into_iter().eq(expected([Some(24.0), Some(12.0), None])), "{:?}", found(true));
        let last: Vec<_> = times.last_phases().map(|(_, ms)| ms).collect();
        assert_eq!(last, [Some(11.0), Some(2.0), None]);
        assert_eq!((times.total(false), times.last_total()), (Some(110.0), Some(111.0)));
    }
}
