//! Times of passes over the last frames.

use std::collections::VecDeque;

/// Frames that are remembered.
const WINDOW: usize = 120;

/// The times of one pass, or of whole frames, over the last frames in which it ran \[ms\].
#[derive(Clone, Debug, Default)]
pub(crate) struct PassTimes {
    gpu: VecDeque<f32>,
    cpu: f32,
}

impl PassTimes {
    /// Adds a time on the GPU.
    pub(crate) fn add(&mut self, ms: f64) {
        if self.gpu.len() == WINDOW {
            self.gpu.pop_front();
        }
        self.gpu.push_back(ms as f32);
    }

    /// Sets the time that the newest frame took to encode it.
    pub(crate) fn set_cpu(&mut self, ms: f64) {
        self.cpu = ms as f32;
    }

    /// Returns the newest time on the GPU.
    pub(crate) fn last(&self) -> Option<f32> {
        self.gpu.back().copied()
    }

    /// Returns the time to encode it in the newest frame.
    pub(crate) fn cpu(&self) -> f32 {
        self.cpu
    }

    /// Returns the mean.
    pub(crate) fn mean(&self) -> Option<f32> {
        let count = self.gpu.len();
        (count > 0).then(|| self.gpu.iter().sum::<f32>() / count as f32)
    }

    /// Returns the standard deviation; `None` for fewer than two.
    pub(crate) fn deviation(&self) -> Option<f32> {
        let mean = self.mean().filter(|_| self.gpu.len() > 1)?;
        let squares: f32 = self.gpu.iter().map(|ms| (ms - mean).powi(2)).sum();
        Some((squares / (self.gpu.len() - 1) as f32).sqrt())
    }

    /// Returns all times, the oldest first.
    pub(crate) fn all(&self) -> impl ExactSizeIterator<Item = f32> {
        self.gpu.iter().copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_and_deviation_are_those_of_the_window() {
        let mut times = PassTimes::default();
        assert_eq!((times.mean(), times.deviation()), (None, None));
        for i in 0..10 * WINDOW {
            times.add(if i < 9 * WINDOW { 1e6 } else { 1.0 + (i % 2) as f64 });
        }
        assert_eq!(times.all().len(), WINDOW);
        assert!((times.mean().unwrap() - 1.5).abs() < 1e-6);
        let expected = (0.25 * WINDOW as f32 / (WINDOW - 1) as f32).sqrt();
        assert!((times.deviation().unwrap() - expected).abs() < 1e-6);
    }
}
