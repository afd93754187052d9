//! Times commands on the GPU, and repeats kernels that are too short to be timed.

use super::ceiling::Ceiling;
use anyhow::{Result, bail};
use executor::Gpu;
use executor::wgpu::{
    Buffer, BufferDescriptor, BufferUsages, CommandEncoder, ComputePassDescriptor,
    ComputePassTimestampWrites, DeviceType, QuerySet, QuerySetDescriptor, QueryType,
};

/// Stamps before and after commands. As the executor does for passes, each is the end of an empty pass, and on a CPU
/// another one follows, at which lavapipe takes the first: it would take it later otherwise.
pub(super) struct Clock {
    gpu: Gpu,
    queries: QuerySet,
    resolved: Buffer,
    readable: Buffer,
    /// Milliseconds a tick.
    period: f64,
}

/// Stamps that are read; one more is taken for lavapipe.
const STAMPS: u32 = 2;

const STAMP_BYTES: u64 = 8 * STAMPS as u64;

impl Clock {
    pub(super) fn new(gpu: &Gpu) -> Clock {
        let buffer = |label, usage| {
            let desc =
                BufferDescriptor { label: Some(label), size: STAMP_BYTES, usage, mapped_at_creation: false };
            gpu.device.create_buffer(&desc)
        };
        Clock {
            queries: gpu.device.create_query_set(&QuerySetDescriptor {
                label: Some("stamps"),
                ty: QueryType::Timestamp,
                count: STAMPS + 1,
            }),
            resolved: buffer("stamps", BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC),
            readable: buffer("stamps to read", BufferUsages::COPY_DST | BufferUsages::MAP_READ),
            period: f64::from(gpu.queue.get_timestamp_period()) * 1e-6,
            gpu: gpu.clone(),
        }
    }

    /// Runs commands alone, and returns the milliseconds that they take on the GPU.
    pub(super) fn milliseconds(&self, record: impl FnOnce(&mut CommandEncoder)) -> Result<f64> {
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.stamp(&mut encoder, 0);
        record(&mut encoder);
        self.stamp(&mut encoder, 1);
        encoder.resolve_query_set(&self.queries, 0..STAMPS, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.readable, 0, STAMP_BYTES);
        self.gpu.submit(Some(encoder.finish()));
        if let Some(fault) = self.gpu.take_fault() {
            bail!("a ceiling could not be measured: {fault}");
        }
        let bytes = executor::map_buffer(&self.gpu, &self.readable, "stamps")?;
        let ticks: Vec<u64> =
            bytes.chunks_exact(8).map(|b| u64::from_le_bytes(b.try_into().unwrap_or_default())).collect();
        Ok(ticks[1].saturating_sub(ticks[0]) as f64 * self.period)
    }

    fn stamp(&self, encoder: &mut CommandEncoder, query: u32) {
        let lazy = self.gpu.info.device_type == DeviceType::Cpu;
        for query in std::iter::once(query).chain(lazy.then_some(STAMPS)) {
            encoder.begin_compute_pass(&ComputePassDescriptor {
                label: Some("stamp"),
                timestamp_writes: Some(ComputePassTimestampWrites {
                    query_set: &self.queries,
                    beginning_of_pass_write_index: None,
                    end_of_pass_write_index: Some(query),
                }),
            });
        }
    }
}

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
    pub(super) fn calibrate(&mut self, clock: &Clock, wanted: f64) -> Result<()> {
        self.time(clock)?;
        loop {
            let time = self.time(clock)?;
            if time >= 0.5 * wanted || self.repeats == MOST_REPEATS {
                return Ok(());
            }
            // Not at once: what is first measured is the start, of which there is one however often it is repeated.
            let factor = (wanted / time.max(1e-6)).ceil().clamp(2.0, 16.0);
            self.repeats = (self.repeats * factor as u32).min(MOST_REPEATS);
        }
    }

    /// Returns the rate of its work per second.
    pub(super) fn rate(&self, clock: &Clock) -> Result<f64> {
        let time = self.time(clock)?;
        Ok(self.amount * f64::from(self.repeats) / (1e-3 * time.max(1e-6)))
    }

    fn time(&self, clock: &Clock) -> Result<f64> {
        clock.milliseconds(|encoder| (self.record)(encoder, self.repeats))
    }
}
