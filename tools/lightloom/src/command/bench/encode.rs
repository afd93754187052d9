//! The cost of a frame on the CPU, beside the same calls of wgpu made by hand.

use super::Bench;
use super::graph::{chain, milliseconds};
use super::running::Running;
use super::table::{Goal, Row, Section, Spread};
use anyhow::{Context as _, Result, ensure};
use executor::wgpu::{BindGroup, Buffer, BufferDescriptor, BufferUsages, ComputePipeline};
use executor::{Executor, FrameOptions, Gpu};
use frame_graph::Overrides;
use frame_graph::plan::{PassId, Plan};
use scene_upload::Frame;

/// Factor of the number of runs, since frames are short; no greater one, since lavapipe keeps some of the
/// memory of each dispatch.
const REPEATS: u32 = 10;

/// Passes of the chain before those that are dispatched here: G-buffer, reflective shadow map, lights.
const BEFORE: u32 = 3;

/// The size of frames: of few pixels, so that encoding takes most of the time.
const SIZE: (u32, u32) = (8, 8);

pub(super) fn measure(bench: &Bench<'_>) -> Result<Section> {
    let count = bench.size(1000, 50);
    let scene = renderer::load_scene(bench.catalog(), "cornell-box")?;
    let (device, text) = ((bench.gpu()?, &**bench.catalog()), chain(count + BEFORE));
    let pipeline = (text.as_str(), &Overrides::default());
    let mut framework = Running::new(device, pipeline, (&scene, scene.traits()), SIZE)?;
    let measured = measured(&framework.plan).context("the chain begins with a gather")?;
    // The first frame runs everything, the second only what is measured, whose bind groups are there then.
    framework.frame(None, FrameOptions::default())?;
    let report = framework.frame(Some(&measured), FrameOptions::default())?;
    let ran = report.ran.iter().filter(|ran| **ran).count();
    ensure!(ran == count as usize, "{ran} passes ran and not {count}");
    let hand = Hand::new(&framework.executor);
    ensure!(hand.dispatches.len() == count as usize, "{} dispatches were encoded", hand.dispatches.len());
    let gpu = framework.executor.gpu().clone();
    let mut frames = Vec::new();
    let (mut recorded, mut finished, mut submitted, mut by_hand) = (vec![], vec![], vec![], vec![]);
    for run in 0..=bench.args.runs * REPEATS {
        // In turn, and each first in every second run, so that whatever else the machine does slows both.
        for of_hand in [run % 2 == 0, run % 2 == 1] {
            let start = std::time::Instant::now();
            if of_hand {
                let [record, finish, submit] = hand.frame(&gpu);
                recorded.push(record);
                finished.push(finish);
                submitted.push(submit);
                by_hand.push(milliseconds(start));
            } else {
                framework.frame(Some(&measured), FrameOptions::default())?;
                frames.push(milliseconds(start));
            }
            gpu.wait()?;
        }
    }
    let [frames, recorded, finished, submitted, by_hand] =
        [frames, recorded, finished, submitted, by_hand].map(|times| Spread::of(times[1..].to_vec()));
    let rows = vec![
        Row::new(format!("{count} dispatches, a frame"), frames, "ms"),
        Row::new(format!("{count} dispatches, by hand"), by_hand, "ms"),
        Row::new("by hand: recorded", recorded, "ms"),
        Row::new("by hand: finished", finished, "ms"),
        Row::new("by hand: submitted", submitted, "ms"),
        Row::new("a frame over the same by hand", frames.over(by_hand), "×")
            .goal(Goal::AtMost(1.1), "own, two cores"),
    ];
    let note = format!(
        "a chain of blurs at {}×{} pixels, each a dispatch with three textures to read, one to write and two uniforms. A frame: scene data, what is to run, encoding, submission. By hand: the same calls of wgpu, which write the number of the frame and dispatch with the same pipelines and bind groups in one compute pass. {} of each in turn, the GPU idle before. Where the adapter is the CPU, its driver's threads have the same cores.",
        SIZE.0,
        SIZE.1,
        bench.args.runs * REPEATS
    );
    Ok(Section { rows, note })
}

/// The gather and the blurs after it, in the order of the plan.
fn measured(plan: &Plan) -> Option<Vec<PassId>> {
    let first = plan.pass("blur-4")?;
    Some((first.0..plan.passes.len() as u32).map(PassId).collect())
}

/// The calls of wgpu of a frame, without the framework.
struct Hand {
    dispatches: Vec<(ComputePipeline, BindGroup, [u32; 3])>,
    /// In place of the buffer that holds the frame's number.
    frame: Buffer,
}

impl Hand {
    /// Takes what the executor encoded last.
    fn new(executor: &Executor) -> Hand {
        let dispatches = executor
            .dispatches()
            .map(|dispatch| (dispatch.pipeline.clone(), dispatch.bind_group.clone(), dispatch.workgroups));
        let frame = executor.gpu().device.create_buffer(&BufferDescriptor {
            label: Some("frame by hand"),
            size: size_of::<Frame>() as u64,
            usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Hand { dispatches: dispatches.collect(), frame }
    }

    /// Runs a frame, and returns the milliseconds for recording, finishing and submitting it.
    fn frame(&self, gpu: &Gpu) -> [f64; 3] {
        let start = std::time::Instant::now();
        gpu.queue.write_buffer(&self.frame, 0, &[0; size_of::<Frame>()]);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        let mut set = None;
        for (pipeline, bind_group, [x, y, z]) in &self.dispatches {
            if set != Some(pipeline) {
                pass.set_pipeline(pipeline);
                set = Some(pipeline);
            }
            pass.set_bind_group(0, bind_group, &[]);
            pass.dispatch_workgroups(*x, *y, *z);
        }
        drop(pass);
        let recorded = milliseconds(start);
        let commands = encoder.finish();
        let finished = milliseconds(start);
        gpu.queue.submit([commands]);
        [recorded, finished - recorded, milliseconds(start) - finished]
    }
}
