//! GPU time of each pass, by timestamps at the start of the frame and after the last step of each.

use crate::error::ExecutorError;
use crate::gpu::Gpu;
use wgpu::{BufferUsages, QueryType};

/// A timestamp for the start of a frame, and one for the end of each pass of a plan.
#[derive(Debug)]
pub(crate) struct Timers {
    pub(crate) queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    readable: wgpu::Buffer,
    /// Stamps that are read: the last query is for none of them.
    count: u32,
    /// Whether a stamp waits for whatever comes next.
    lazy: bool,
}

impl Timers {
    /// WebGPU's bound on the queries of a set.
    const MAX_QUERIES: u32 = 4096;

    /// Timers for so many passes; `None` where the adapter has none.
    pub(crate) fn new(gpu: &Gpu, passes: u32) -> Option<Timers> {
        let count = passes + 1;
        let queries = count + 1;
        if !gpu.has_timestamps() || queries > Self::MAX_QUERIES {
            return None;
        }
        let buffer = |label, usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: u64::from(queries) * 8,
                usage,
                mapped_at_creation: false,
            })
        };
        Some(Timers {
            queries: gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("pass timers"),
                ty: QueryType::Timestamp,
                count: queries,
            }),
            resolved: buffer("timestamps", BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC),
            readable: buffer("timestamps to read", BufferUsages::COPY_DST | BufferUsages::MAP_READ),
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
        self.settle(encoder);
    }

    /// To be called after a stamp. lavapipe takes a stamp not where it stands but where it next has to wait, which may be
    /// after the dispatches that follow, if they need nothing of those before: another stamp is such a place.
    pub(crate) fn settle(&self, encoder: &mut wgpu::CommandEncoder) {
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
    pub(crate) fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.resolve_query_set(&self.queries, 0..self.count, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.readable, 0, self.resolved.size());
    }

    /// Waits, and gives the milliseconds of each pass; 0 for those that left no stamp.
    ///
    /// A pass lasts from the end of the one before it to its own end: so the times add up to the frame's, and
    /// they are right on lavapipe too, which may execute the timestamp at a pass's begin only at its end.
    pub(crate) fn read(&self, gpu: &Gpu, stamped: &[bool]) -> Result<Vec<f64>, ExecutorError> {
        let bytes = crate::readback::map(gpu, &self.readable, "timestamps")?;
        let mut ticks = bytes.chunks_exact(8).map(|b| u64::from_le_bytes(b.try_into().unwrap_or_default()));
        let period = f64::from(gpu.queue.get_timestamp_period()) * 1e-6;
        let mut last = ticks.next().unwrap_or_default();
        let spans = ticks.zip(stamped).map(|(end, stamped)| {
            if !stamped {
                return 0.0;
            }
            end.saturating_sub(std::mem::replace(&mut last, end)) as f64 * period
        });
        Ok(spans.collect())
    }
}
