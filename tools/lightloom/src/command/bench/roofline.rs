//! The limits of the adapter, beside what each pass of three frames must move and do.

mod ceiling;
mod clock;
mod kernels;
mod known;
mod report;
mod work;

use super::frames::{Timed, scene};
use super::layout::Machine;
use super::table::Spread;
use super::{Bench, label};
use crate::output::progress;
use anyhow::{Context as _, Result};
use ceiling::{Ceilings, Measured};
use clock::Clock;
use kernels::Kernels;
use renderer::Renderer;
use work::{Quantity, Work};

/// Milliseconds for which a kernel is repeated.
const MEASURED_MS: f64 = 20.0;

/// The same in a quick preview.
const QUICK_MS: f64 = 0.5;

/// A pass with its times and its work.
struct Pass {
    name: String,
    kind: String,
    time: Spread,
    work: Work,
}

/// A frame, pass by pass.
struct Frame {
    name: String,
    time: Spread,
    passes: Vec<Pass>,
}

/// Ceilings and frames, measured in turn.
pub(super) struct Roofline {
    ceilings: Ceilings,
    frames: Vec<Frame>,
    note: String,
    machine: Machine,
}

pub(super) fn measure(bench: &Bench<'_>) -> Result<Roofline> {
    let gpu = bench.timing_gpu()?;
    let clock = Clock::new(&gpu);
    let kernels = Kernels::new(bench, &gpu)?;
    let mut probes = kernels.probes()?;
    let bar = progress(u64::from(bench.args.runs) + 2, "measuring");
    let wanted = if bench.args.quick { QUICK_MS } else { MEASURED_MS };
    probes.iter_mut().try_for_each(|probe| probe.calibrate(&clock, wanted))?;
    bar.inc(1);
    let mut frames = frames(bench)?;
    let mut rates = vec![Vec::new(); probes.len()];
    let mut times = vec![Vec::new(); frames.len()];
    bar.inc(1);
    for _ in 0..bench.args.runs {
        // In turn, so that whatever else the machine does slows both sides.
        for (rates, probe) in rates.iter_mut().zip(&probes) {
            rates.push(probe.rate(&clock)?);
        }
        for (times, (_, timed)) in times.iter_mut().zip(&mut frames) {
            times.push(timed.frame()?);
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    let measured = probes.iter().zip(rates);
    let measured =
        measured.map(|(probe, rates)| Measured { ceiling: probe.ceiling, rate: Spread::of(rates) });
    let note = format!(
        "{} ({} triangles), every pass run again in each frame. Ceilings and frames in turn; a ceiling is repeated for {wanted} ms. At least: what takes longest of all that a pass must move and do, each at its fastest ceiling, as if everything overlapped; resources of the plan once however often they are read, without those of the scene.",
        label(scene(bench)),
        frames[0].1.triangles(),
    );
    let frames = frames.iter_mut().zip(times);
    Ok(Roofline {
        ceilings: Ceilings(measured.collect()),
        frames: frames.map(|((name, timed), times)| frame(name, timed, &times)).collect::<Result<_>>()?,
        note,
        machine: Machine::new(Some(&gpu), bench.args),
    })
}

/// Returns the frames of the figures `ism-frame` and `shadow-maps`.
fn frames(bench: &Bench<'_>) -> Result<Vec<(String, Timed)>> {
    let side = bench.size(256, 32);
    let (lights, map) = (bench.size(1024, 32), bench.size(64, 16));
    let (few, large) = (bench.size(256, 8), bench.size(256, 32));
    let wide = (bench.size(640, 40), bench.size(480, 30));
    let frames =
        [("ism", (side, side), lights, map), ("ism", wide, few, large), ("ism-classic", wide, few, large)];
    let frames = frames.into_iter().map(|(pipeline, size, lights, map)| {
        let mut timed = Timed::new(bench, pipeline, size, &[("lights", lights), ("map", map)])?;
        for (_, name, _) in marked(timed.renderer()) {
            timed.renderer().keep(&name)?;
        }
        // What is kept was made again.
        timed.frame()?;
        Ok((format!("{pipeline}, {lights} maps of {map}², {}×{} pixels", size.0, size.1), timed))
    });
    frames.collect()
}

/// Returns the passes whose atomics are counted in what they leave: index, name of the resource, and the word for none.
fn marked(renderer: &Renderer) -> Vec<(usize, String, u32)> {
    let passes = renderer.plan().map_or(&[][..], |plan| &plan.passes);
    let found = passes.iter().enumerate().filter_map(|(i, pass)| {
        let known::Marked { port, empty } = known::marked(&pass.kind)?;
        Some((i, format!("{}.{port}", pass.name), *empty))
    });
    found.collect()
}

/// Returns a frame with the work of its passes.
fn frame(name: &str, timed: &mut Timed, times: &[Vec<f64>]) -> Result<Frame> {
    let triangles = timed.triangles() as u64;
    let renderer = timed.renderer();
    let compiled = renderer.compiled().context("the frame has a pipeline")?;
    let (plan, steps) = (&compiled.plan, &compiled.steps);
    let passes = plan.passes.iter().zip(steps).enumerate().map(|(i, (planned, steps))| Pass {
        name: planned.name.to_string(),
        kind: planned.kind.to_string(),
        time: Spread::of(times.iter().map(|times| times[i]).collect()),
        work: known::work(plan, planned, steps, triangles),
    });
    let mut passes: Vec<Pass> = passes.collect();
    for (i, name, empty) in marked(renderer) {
        let id = plan.resource(&name).with_context(|| format!("the plan has no `{name}`"))?;
        let bytes = renderer.resource_bytes(id)?;
        let done = bytes.chunks_exact(4).filter(|word| **word != empty.to_le_bytes()).count();
        passes[i].work.add(Quantity::Atomics, done as u64);
    }
    let time = Spread::of(times.iter().map(|times| times.iter().sum()).collect());
    Ok(Frame { name: name.to_owned(), time, passes })
}
