//! Repeats kernels that are too short to be timed.

use super::ceiling::Ceiling;
use anyhow::{Context as _, Result, bail};
use executor::wgpu::CommandEncoder;
use executor::{Gpu, milliseconds};

/// Records a kernel a number of times.
pub(super) type Record = Box<dyn Fn(&mut CommandEncoder, u32)>;

/// A kernel with the amount of its work.
pub(super) struct Probe {
    pub(super) ceiling: Ceiling,
    /// Bytes, operations or pieces each time.
    amount: f64,
    record: Record,
    /// Number of repetitions that take long enough.
    repeats: u32,
}

/// The most times that a kernel is recorded: far more commands than a frame has.
const MOST_REPEATS: u32 = 4096;

impl Probe {
    pub(super) fn new(ceiling: Ceiling, amount: f64, record: Record) -> Probe {
        Probe { ceiling, amount, record, repeats: 1 }
    }

    /// Compiles the kernel, which drivers do when it first runs, and repeats it until it takes so many milliseconds: a
    /// stamp is a matter of microseconds, and a clock of a processor takes some time to rise.
    pub(super) fn calibrate(&mut self, gpu: &Gpu, wanted: f64) -> Result<()> {
        self.time(gpu)?;
        loop {
            let time = self.time(gpu)?;
            if time >= 0.5 * wanted || self.repeats == MOST_REPEATS {
                return Ok(());
            }
            // Not at once: what is first measured is the start, of which there is one however often it is repeated.
            let factor = (wanted / time.max(1e-6)).ceil().clamp(2.0, 16.0);
            self.repeats = (self.repeats * factor as u32).min(MOST_REPEATS);
        }
    }

    /// Returns the rate of its work per second.
    pub(super) fn rate(&self, gpu: &Gpu) -> Result<f64> {
        let time = self.time(gpu)?;
        Ok(self.amount * f64::from(self.repeats) / (1e-3 * time.max(1e-6)))
    }

    fn time(&self, gpu: &Gpu) -> Result<f64> {
        let time = milliseconds(gpu, |encoder| (self.record)(encoder, self.repeats))?;
        if let Some(fault) = gpu.take_fault() {
            bail!("a ceiling could not be measured: {fault}");
        }
        time.context("the adapter has no timestamps")
    }
}
