//! The uniforms of all steps in one buffer. What can differ between frames is known when a plan is loaded: a frame looks at
//! those words alone, and writes all that differ at once.

use crate::gpu::Gpu;
use crate::step::LoadedStep;
use frame_graph::ResetCause;
use frame_graph::frame::{FrameSchedule, HistorySlot};
use frame_graph::plan::{PassId, Plan};
use pass::{FrameValue, FrameWord, PastFact, pass_seed};
use std::ops::Range;

/// The buffer of a plan's uniforms, and what it holds.
#[derive(Debug)]
pub(crate) struct Uniforms {
    pub(crate) buffer: wgpu::Buffer,
    bytes: Vec<u8>,
    /// The bytes that differ from those in the buffer lie in here.
    unwritten: Range<usize>,
    words: Vec<PlacedWord>,
    /// The sample for which `seeds` are; `None` before the first frame.
    sample: Option<Sample>,
    /// For each pass, its seed in this sample, and that in the first.
    seeds: Vec<[u32; 2]>,
}

/// Which random numbers a frame takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Sample {
    /// The run's seed.
    pub(crate) run_seed: u32,
    /// The number of the sample that the frame is.
    pub(crate) number: u32,
}

impl Sample {
    /// The seed of a sample: that of the run for the first.
    fn seed(self) -> u32 {
        self.run_seed ^ self.number.wrapping_mul(0x9e37_79b9)
    }
}

/// A word that can differ between frames.
#[derive(Debug)]
struct PlacedWord {
    /// Where it lies in the buffer.
    at: usize,
    pass: usize,
    word: FrameWord,
}

impl Uniforms {
    /// Gives every uniform of the steps its place in a new buffer; `None` where there is none.
    pub(crate) fn new(gpu: &Gpu, plan: &Plan, steps: &mut [Vec<LoadedStep>]) -> Option<Uniforms> {
        let limits = gpu.limits();
        let alignment =
            limits.min_uniform_buffer_offset_alignment.max(limits.min_storage_buffer_offset_alignment);
        let mut size = 0;
        for step in steps.iter_mut().flatten() {
            size = step.place_uniforms(size, u64::from(alignment));
        }
        if size == 0 {
            return None;
        }
        let mut uniforms = Uniforms {
            buffer: gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("uniforms"),
                size,
                usage: wgpu::BufferUsages::UNIFORM
                    | wgpu::BufferUsages::STORAGE
                    | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            bytes: vec![0; size as usize],
            unwritten: 0..0,
            words: Vec::new(),
            sample: None,
            seeds: vec![[0; 2]; plan.passes.len()],
        };
        uniforms.fill(steps);
        Some(uniforms)
    }

    /// Takes the values of steps whose uniforms have the same places.
    pub(crate) fn fill(&mut self, steps: &[Vec<LoadedStep>]) {
        self.words.clear();
        for (pass, steps) in steps.iter().enumerate() {
            for (fill, offset) in steps.iter().flat_map(LoadedStep::uniforms) {
                let offset = offset as usize;
                let bytes = fill.bytes(0, |_, _| 0);
                self.bytes[offset..][..bytes.len()].copy_from_slice(&bytes);
                let place = |word: FrameWord| PlacedWord { at: offset + word.offset, pass, word };
                self.words.extend(fill.frame_words().map(place));
            }
        }
        self.unwritten = 0..self.bytes.len();
    }

    /// The passes whose random numbers differ between samples.
    pub(crate) fn seeded_passes(&self) -> impl Iterator<Item = PassId> {
        let is_seeded = |value| matches!(value, FrameValue::Seed | FrameValue::Sample);
        let seeded = self.words.iter().filter(move |word| is_seeded(word.word.value));
        seeded.map(|word| PassId(word.pass as u32))
    }

    /// Writes what differs for the passes that run.
    pub(crate) fn write(&mut self, gpu: &Gpu, plan: &Plan, schedule: &FrameSchedule, sample: Sample) {
        if self.sample != Some(sample) {
            self.sample = Some(sample);
            let seeds = self.seeds.iter_mut().zip(&plan.passes);
            let of_runs = [sample.seed(), sample.run_seed];
            seeds.for_each(|(held, pass)| *held = of_runs.map(|seed| pass_seed(seed, &pass.name)));
        }
        for PlacedWord { at, pass, word } in self.words.iter().filter(|word| schedule.runs[word.pass]) {
            let value = match word.value {
                FrameValue::Seed => self.seeds[*pass][0],
                FrameValue::RunSeed => self.seeds[*pass][1],
                FrameValue::Sample => sample.number,
                FrameValue::Past(history, fact) => past(&schedule.histories[history.0 as usize], fact),
            };
            let (range, bytes) = (*at..at + 4, word.bytes(value));
            if self.bytes[range.clone()] != bytes {
                self.bytes[range.clone()].copy_from_slice(&bytes);
                self.unwritten = match self.unwritten.is_empty() {
                    true => range,
                    false => self.unwritten.start.min(range.start)..self.unwritten.end.max(range.end),
                };
            }
        }
        if !self.unwritten.is_empty() {
            let range = std::mem::take(&mut self.unwritten);
            gpu.queue.write_buffer(&self.buffer, range.start as u64, &self.bytes[range]);
        }
    }
}

fn past(slot: &HistorySlot, fact: PastFact) -> u32 {
    match fact {
        PastFact::Age => slot.age,
        PastFact::Reset => slot.reset.map_or(0, reset_code),
    }
}

fn reset_code(cause: ResetCause) -> u32 {
    match cause {
        ResetCause::FirstFrame => 1,
        ResetCause::Resize => 2,
        ResetCause::Cut => 3,
        ResetCause::Scene => 4,
        ResetCause::Reload => 5,
        ResetCause::Moved | ResetCause::MovedUpstream => 6,
        ResetCause::Setting => 7,
    }
}
