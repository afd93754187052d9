//! GPU time of each pass, by timestamps at its first and last step.

use crate::error::ExecutorError;
use crate::gpu::Gpu;
use wgpu::{BufferUsages, QueryType};

/// Two timestamps a pass of a plan.
#[derive(Debug)]
pub(crate) struct Timers {
    pub(crate) queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    readable: wgpu::Buffer,
    passes: u32,
}

impl Timers {
    /// WebGPU's bound on the queries of a set.
    const MAX_PASSES: u32 = 2048;

    /// Timers for so many passes; `None` where the adapter has none.
    pub(crate) fn new(gpu: &Gpu, passes: u32) -> Option<Timers> {
        if !gpu.has_timestamps() || passes == 0 || passes > Self::MAX_PASSES {
            return None;
        }
        let buffer = |label, usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: u64::from(passes) * 16,
                usage,
                mapped_at_creation: false,
            })
        };
        Some(Timers {
            queries: gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("pass timers"),
                ty: QueryType::Timestamp,
                count: passes * 2,
            }),
            resolved: buffer("timestamps", BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC),
            readable: buffer("timestamps to read", BufferUsages::COPY_DST | BufferUsages::MAP_READ),
            passes,
        })
    }

    /// Copies the timestamps to where they can be read, at the end of a frame.
    pub(crate) fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.resolve_query_set(&self.queries, 0..self.passes * 2, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.readable, 0, self.resolved.size());
    }

    /// Waits, and gives the milliseconds of each pass; 0 for those that did not run.
    ///
    /// A pass lasts from the end of the one before it to its own end: so the times add up to the frame's, and
    /// they are right on lavapipe too, which may execute the timestamp at a pass's begin only at its end.
    pub(crate) fn read(&self, gpu: &Gpu, ran: &[bool]) -> Result<Vec<f64>, ExecutorError> {
        let bytes = crate::readback::map(gpu, &self.readable, "timestamps")?;
        let ticks: Vec<u64> =
            bytes.chunks_exact(8).map(|b| u64::from_le_bytes(b.try_into().unwrap_or_default())).collect();
        let period = f64::from(gpu.queue.get_timestamp_period()) * 1e-6;
        let mut last = None;
        let spans = ticks.chunks_exact(2).zip(ran).map(|(pair, ran)| {
            if !ran {
                return 0.0;
            }
            let begin = last.replace(pair[1]).unwrap_or(pair[0]);
            pair[1].saturating_sub(begin) as f64 * period
        });
        Ok(spans.collect())
    }
}
