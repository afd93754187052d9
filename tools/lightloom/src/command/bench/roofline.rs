//! The limits of the adapter, and the passes of three frames, each beside what it must move and do.

mod ceiling;
mod kernels;
mod known;
mod probe;
mod work;

use super::table::{Goal, Row, Section, Spread};
use super::{Bench, label};
use anyhow::{Context as _, Result};
use ceiling::{Ceilings, Measured};
use frame_graph::{Overrides, Value};
use kernels::Kernels;
use renderer::{FrameOptions, Renderer};
use std::sync::Arc;
use work::{Quantity, Work};

/// Milliseconds for which a kernel is repeated.
const MEASURED_MS: f64 = 20.0;

/// The same in a quick preview.
const QUICK_MS: f64 = 0.5;

pub(super) fn measure(bench: &Bench<'_>) -> Result<Section> {
    let gpu = bench.timing_gpu()?;
    let kernels = Kernels::new(bench, &gpu)?;
    let mut probes = kernels.probes()?;
    let wanted = if bench.args.quick { QUICK_MS } else { MEASURED_MS };
    probes.iter_mut().try_for_each(|probe| probe.calibrate(&gpu, wanted))?;
    let mut frames = frames(bench)?;
    let mut rates = vec![Vec::new(); probes.len()];
    let mut times = vec![Vec::new(); frames.len()];
    for _ in 0..bench.args.runs {
        // In turn, so that whatever else the machine does slows both sides.
        for (rates, probe) in rates.iter_mut().zip(&probes) {
            rates.push(probe.rate(&gpu)?);
        }
        for (times, (_, renderer)) in times.iter_mut().zip(&mut frames) {
            times.push(frame(renderer)?);
        }
    }
    let measured = probes.iter().zip(rates);
    let ceilings = Ceilings(
        measured.map(|(probe, rates)| Measured { ceiling: probe.ceiling, rate: Spread::of(rates) }).collect(),
    );
    let mut rows: Vec<Row> = ceilings.0.iter().map(|ceiling| ceiling.row()).collect();
    for ((name, renderer), times) in frames.iter().zip(times) {
        rows.extend(passes(name, renderer, &times, &ceilings)?);
    }
    let note = format!(
        "{} ({} triangles), every pass run again in each frame. Ceilings and frames in turn; a ceiling is repeated for {wanted} ms. The goal of a pass is no less than it can take: what takes longest of all that it must move and do, each at its fastest ceiling, as if everything overlapped; resources of the plan once however often they are read, without those of the scene.",
        label(scene(bench)),
        frames[0].1.scene().triangles(),
    );
    Ok(Section { rows, note })
}

/// Returns the first scene that is given, or the atrium, which has about the structure of Sponza.
fn scene<'a>(bench: &'a Bench<'_>) -> &'a str {
    bench.args.scene.first().map_or("atrium", String::as_str)
}

/// Runs all passes, and returns the milliseconds of each.
fn frame(renderer: &mut Renderer) -> Result<Vec<f64>> {
    renderer.run_everything();
    Ok(renderer.frame()?.times.clone())
}

/// Returns the frames, each run once.
fn frames(bench: &Bench<'_>) -> Result<Vec<(String, Renderer)>> {
    let side = bench.size(256, 32);
    let (lights, map) = (bench.size(1024, 32), bench.size(64, 16));
    let (few, large) = (bench.size(256, 8), bench.size(256, 32));
    let wide = (bench.size(640, 40), bench.size(480, 30));
    let frames =
        [("ism", (side, side), lights, map), ("ism", wide, few, large), ("ism-classic", wide, few, large)];
    let frames = frames.into_iter().map(|(pipeline, size, lights, map)| {
        let loaded = renderer::load_scene(bench.catalog(), scene(bench))?;
        let mut timed = Renderer::new(bench.timing_gpu()?, Arc::clone(bench.catalog()), loaded, size)?;
        let values = [("lights", lights), ("map", map)];
        let values = values.map(|(name, value)| (name.to_owned(), Value::U32(value)));
        timed.set_pipeline(pipeline, &Overrides(values.into()))?;
        timed.set_frame_options(FrameOptions { timed: true, ..FrameOptions::default() });
        for (_, name, _) in marked(&timed) {
            timed.keep(&name)?;
        }
        frame(&mut timed)?;
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

/// Returns a row for each pass of a frame, with its work and the time that this takes at least, and one for the frame.
fn passes(name: &str, renderer: &Renderer, times: &[Vec<f64>], ceilings: &Ceilings) -> Result<Vec<Row>> {
    let triangles = renderer.scene().triangles() as u64;
    let compiled = renderer.compiled().context("the frame has a pipeline")?;
    let (plan, steps) = (&compiled.plan, &compiled.steps);
    let planned = plan.passes.iter().zip(steps);
    let mut work: Vec<Work> =
        planned.map(|(planned, steps)| known::work(plan, planned, steps, triangles)).collect();
    for (i, resource, empty) in marked(renderer) {
        let id = plan.resource(&resource).with_context(|| format!("the plan has no `{resource}`"))?;
        let bytes = renderer.resource_bytes(id)?;
        let done = bytes.chunks_exact(4).filter(|word| **word != empty.to_le_bytes()).count();
        work[i].add(Quantity::Atomics, done as u64);
    }
    let whole = Spread::of(times.iter().map(|times| times.iter().sum()).collect());
    // Passes run one after the other.
    let least = work.iter().filter_map(|work| work.bound(ceilings)).map(|(_, least)| least).sum();
    let mut rows = vec![Row::new(name, whole, "ms").goal(Goal::AtLeast(least), "all passes")];
    for (i, (pass, work)) in plan.passes.iter().zip(work).enumerate() {
        let time = Spread::of(times.iter().map(|times| times[i]).collect());
        let row = Row::new(format!("{name}: {}", pass.name), time, "ms").counts(work.counts().collect());
        rows.push(match work.bound(ceilings) {
            Some((quantity, least)) => row.goal(Goal::AtLeast(least), quantity.name()),
            None => row,
        });
    }
    Ok(rows)
}
