//! Measures the GPU time of each pass, with timestamps at the start of the frame and after the last step of each pass.
//!
//! Timestamps are read in two ways. A frame that is *timed* waits for its own. A frame that is *monitored* writes them
//! into one of a few buffers, which is mapped when the GPU is done and read at the next query: nothing waits, and
//! frames for which no buffer is free are not timed.

use crate::error::ExecutorError;
use crate::gpu::Gpu;
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};
use wgpu::{BufferUsages, QueryType};

/// The GPU time of the passes of a frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Timings {
    /// The number of the frame, as in its [`FrameReport`](crate::FrameReport).
    pub frame: u64,
    /// GPU time in milliseconds, one entry per pass; 0 for passes that did not run.
    pub times: Vec<f64>,
}

/// A buffer for the timestamps of a monitored frame.
#[derive(Debug)]
struct Slot {
    buffer: wgpu::Buffer,
    /// One of the states below; wgpu reports the mapping from any thread that polls.
    state: Arc<AtomicU8>,
    frame: u64,
    /// The passes that left a stamp.
    stamped: Vec<bool>,
}

/// No frame's stamps are in the slot.
const FREE: u8 = 0;
/// The GPU is to write it.
const WAITING: u8 = 1;
/// It is mapped.
const MAPPED: u8 = 2;
/// It could not be mapped.
const REFUSED: u8 = 3;

/// Frames that can be on their way at once, those beyond which are not timed: more than a queue holds as a rule.
const MOST_SLOTS: usize = 4;

/// The place of the timestamps of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TimingTarget {
    /// To be waited for.
    Exact,
    /// Into this slot.
    Slot(usize),
}

/// A timestamp for the start of a frame, and one for the end of each pass of a plan.
#[derive(Debug)]
pub(crate) struct Timers {
    pub(crate) queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    exact: wgpu::Buffer,
    /// Made as they are needed.
    slots: Vec<Slot>,
    newest: Option<Timings>,
    /// Milliseconds a tick.
    period: f64,
    /// Stamps that are read: the last query is for none of them.
    count: u32,
    /// Whether a stamp waits for whatever comes next.
    lazy: bool,
}

impl Timers {
    /// WebGPU's bound on the queries of a set.
    const MAX_QUERIES: u32 = 4096;

    /// Timers for this many passes; `None` where the adapter has none.
    pub(crate) fn new(gpu: &Gpu, passes: u32) -> Option<Timers> {
        let count = passes + 1;
        let queries = count + 1;
        if !gpu.has_timestamps() || queries > Self::MAX_QUERIES {
            return None;
        }
        let size = u64::from(queries) * 8;
        Some(Timers {
            queries: gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("pass timers"),
                ty: QueryType::Timestamp,
                count: queries,
            }),
            resolved: buffer(gpu, "timestamps", size, BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC),
            exact: buffer(gpu, "timestamps to read", size, BufferUsages::COPY_DST | BufferUsages::MAP_READ),
            slots: Vec::new(),
            newest: None,
            period: f64::from(gpu.queue.get_timestamp_period()) * 1e-6,
            count,
            lazy: gpu.info.device_type == wgpu::DeviceType::Cpu,
        })
    }

    /// The query for the end of a pass.
    pub(crate) fn end_of(pass: usize) -> u32 {
        pass as u32 + 1
    }

    /// Stamps the start of a frame: the end of an empty pass, before which there is nothing to wait for.
    pub(crate) fn start(&self, encoder: &mut wgpu::CommandEncoder) {
        self.stamp(encoder, "start of the frame", 0);
        self.take(encoder);
    }

    /// Makes the driver take a stamp that was just encoded. lavapipe takes a stamp not where it stands but where it next has to wait, which may
    /// be after the dispatches that follow, if they need nothing of those before: another stamp is such a place.
    pub(crate) fn take(&self, encoder: &mut wgpu::CommandEncoder) {
        if self.lazy {
            self.stamp(encoder, "take the stamp", self.count);
        }
    }

    fn stamp(&self, encoder: &mut wgpu::CommandEncoder, label: &str, query: u32) {
        encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(label),
            timestamp_writes: Some(wgpu::ComputePassTimestampWrites {
                query_set: &self.queries,
                beginning_of_pass_write_index: None,
                end_of_pass_write_index: Some(query),
            }),
        });
    }

    /// Copies the timestamps to where they can be read, at the end of a frame.
    pub(crate) fn resolve(&self, encoder: &mut wgpu::CommandEncoder, target: TimingTarget) {
        encoder.resolve_query_set(&self.queries, 0..self.count, &self.resolved, 0);
        let readable = match target {
            TimingTarget::Exact => &self.exact,
            TimingTarget::Slot(index) => &self.slots[index].buffer,
        };
        encoder.copy_buffer_to_buffer(&self.resolved, 0, readable, 0, self.resolved.size());
    }

    /// Waits, and puts the milliseconds of each pass into `times`; 0 for those that left no stamp.
    pub(crate) fn read(
        &mut self,
        gpu: &Gpu,
        frame: u64,
        stamped: impl Iterator<Item = bool>,
        times: &mut Vec<f64>,
    ) -> Result<(), ExecutorError> {
        let bytes = crate::readback::map(gpu, &self.exact, "timestamps")?;
        spans(&bytes, stamped, self.period, times);
        let newest = self.newest.get_or_insert_default();
        newest.frame = frame;
        newest.times.clone_from(times);
        Ok(())
    }

    /// Finds a slot for a frame to come; `None` where all wait for the GPU.
    pub(crate) fn free_slot(&mut self, gpu: &Gpu) -> Option<TimingTarget> {
        self.collect(gpu);
        let free = self.slots.iter().position(|slot| slot.state.load(Ordering::Acquire) == FREE);
        if free.is_none() && self.slots.len() < MOST_SLOTS {
            let usage = BufferUsages::COPY_DST | BufferUsages::MAP_READ;
            self.slots.push(Slot {
                buffer: buffer(gpu, "timestamps of a monitored frame", self.resolved.size(), usage),
                state: Arc::new(AtomicU8::new(FREE)),
                frame: 0,
                stamped: Vec::new(),
            });
            return Some(TimingTarget::Slot(self.slots.len() - 1));
        }
        free.map(TimingTarget::Slot)
    }

    /// Asks for a slot to be mapped when the frame that was just submitted is done.
    pub(crate) fn request(&mut self, index: usize, frame: u64, stamped: impl Iterator<Item = bool>) {
        let slot = &mut self.slots[index];
        slot.frame = frame;
        slot.stamped.clear();
        slot.stamped.extend(stamped);
        slot.state.store(WAITING, Ordering::Release);
        let state = Arc::clone(&slot.state);
        slot.buffer.map_async(wgpu::MapMode::Read, .., move |result| {
            state.store(if result.is_ok() { MAPPED } else { REFUSED }, Ordering::Release);
        });
    }

    /// Returns the times of the newest frame whose stamps have come.
    pub(crate) fn newest(&mut self, gpu: &Gpu) -> Option<&Timings> {
        self.collect(gpu);
        self.newest.as_ref()
    }

    /// Reads the slots that have come, without waiting for the others.
    fn collect(&mut self, gpu: &Gpu) {
        if self.slots.iter().all(|slot| slot.state.load(Ordering::Acquire) == FREE) {
            return;
        }
        // The next frame reports a lost device.
        let _ = gpu.poll(wgpu::PollType::Poll);
        for slot in &self.slots {
            let state = slot.state.load(Ordering::Acquire);
            if state == MAPPED {
                let newer = self.newest.as_ref().is_none_or(|newest| newest.frame < slot.frame);
                if newer && let Ok(bytes) = slot.buffer.get_mapped_range(..) {
                    let newest = self.newest.get_or_insert_default();
                    newest.frame = slot.frame;
                    spans(&bytes, slot.stamped.iter().copied(), self.period, &mut newest.times);
                }
                slot.buffer.unmap();
            }
            if matches!(state, MAPPED | REFUSED) {
                slot.state.store(FREE, Ordering::Release);
            }
        }
    }
}

/// Runs commands alone, and returns the milliseconds that they take on the GPU; `None` where the adapter has no timestamps.
///
/// # Errors
/// Those of [`map_buffer`](crate::map_buffer). Errors of the commands are left to [`Gpu::take_fault`].
pub fn milliseconds(
    gpu: &Gpu,
    record: impl FnOnce(&mut wgpu::CommandEncoder),
) -> Result<Option<f64>, ExecutorError> {
    let Some(mut timers) = Timers::new(gpu, 1) else { return Ok(None) };
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    timers.start(&mut encoder);
    record(&mut encoder);
    timers.stamp(&mut encoder, "end of the commands", Timers::end_of(0));
    timers.take(&mut encoder);
    timers.resolve(&mut encoder, TimingTarget::Exact);
    gpu.submit(Some(encoder.finish()));
    let mut times = Vec::new();
    timers.read(gpu, 0, std::iter::once(true), &mut times)?;
    Ok(times.first().copied())
}

fn buffer(gpu: &Gpu, label: &str, size: u64, usage: BufferUsages) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage,
        mapped_at_creation: false,
    })
}

/// Puts the milliseconds of each pass into `times`.
///
/// A pass lasts from the end of the one before it to its own end: so the times add up to the frame's, and
/// they are right on lavapipe too, which may execute the timestamp at a pass's begin only at its end.
fn spans(bytes: &[u8], stamped: impl Iterator<Item = bool>, period: f64, times: &mut Vec<f64>) {
    let mut ticks = bytes.chunks_exact(8).map(|b| u64::from_le_bytes(b.try_into().unwrap_or_default()));
    let mut last = ticks.next().unwrap_or_default();
    times.clear();
    times.extend(ticks.zip(stamped).map(|(end, stamped)| {
        if !stamped {
            return 0.0;
        }
        end.saturating_sub(std::mem::replace(&mut last, end)) as f64 * period
    }));
}
