//! Renders points, and keeps what was measured.

use super::super::blame::{bounces, reference, reference_values};
use super::Args;
use super::space::Space;
use crate::context::Context;
use anyhow::{Context as _, Result, anyhow};
use frame_graph::{CompileOptions, LinkContext, Overrides};
use indicatif::ProgressBar;
use metrics::statistics::median;
use metrics::{Image, Pair};
use renderer::{Compiled, FrameOptions, Gpu, Renderer, SharedScene, compile_options};
use serde_json::json;
use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::Write as _;
use std::ops::ControlFlow;
use std::sync::Arc;
use tune::{Evaluate, Measured, Point};
use xxhash_rust::xxh3::xxh3_128;

/// The seed of references: far from those of pictures.
const REFERENCE_SEED: u32 = 0x5eed_0001;

/// The frames whose median time counts, or fewer where they take this long together \[ms\].
const TIMED_FRAMES: usize = 5;
const ENOUGH_MS: f64 = 400.0;

/// A scene with its reference, and the renderer of the point that was measured last.
struct Scene {
    shared: SharedScene,
    link: LinkContext,
    reference: Option<Image>,
    renderer: Option<(u128, Renderer)>,
}

/// Measures points of a grid.
pub(super) struct Measurer<'a> {
    context: &'a Context,
    args: &'a Args,
    space: &'a Space,
    bar: &'a ProgressBar,
    scenes: Vec<Scene>,
    adapter: String,
    /// What was measured before, by picture and seed.
    known: BTreeMap<String, Measured>,
    log: File,
    seen: BTreeSet<Point>,
}

impl<'a> Measurer<'a> {
    pub(super) fn new(
        context: &'a Context,
        args: &'a Args,
        space: &'a Space,
        bar: &'a ProgressBar,
    ) -> Result<Measurer<'a>> {
        let gpu = Gpu::open()?.with_shared_pipelines();
        let adapter = gpu.describe();
        let mut scenes = Vec::new();
        for name in &args.scenes {
            let scene = renderer::load_scene(&context.catalog, name)?;
            let link = LinkContext { frame: args.size, traits: scene.traits() };
            scenes.push(Scene {
                shared: SharedScene::new(&gpu, scene)?,
                link,
                reference: None,
                renderer: None,
            });
        }
        let path = args.out.join("cells.jsonl");
        let known = std::fs::read_to_string(&path).unwrap_or_default();
        // A line that was cut off as the program ended is measured again.
        let known = known.lines().filter_map(|line| {
            let row: serde_json::Value = serde_json::from_str(line).ok()?;
            let measured = serde_json::from_value(row["measured"].clone()).ok()?;
            Some((row["key"].as_str()?.to_owned(), measured))
        });
        let known = known.collect();
        let log = File::options().append(true).create(true).open(&path);
        let log = log.with_context(|| format!("{} cannot be written", path.display()))?;
        Ok(Measurer { context, args, space, bar, scenes, adapter, known, log, seen: BTreeSet::new() })
    }

    pub(super) fn adapter(&self) -> String {
        self.adapter.clone()
    }

    fn measure(&mut self, at: usize, point: &Point, seed: u32) -> Result<Option<Measured>> {
        let link = self.scenes[at].link.clone();
        let Some((overrides, resolved)) = self.space.pipeline(self.context, self.args, point, &link)? else {
            return Ok(None);
        };
        let variants = [resolved];
        let options = CompileOptions { outputs: self.outputs(&overrides)?, ..compile_options() };
        let Ok(compiled) = Compiled::united(&self.context.catalog, &variants, &link, &options) else {
            return Ok(None);
        };
        let scene = self.scenes[at].shared.scene().hash;
        let shaders = compiled.steps.iter().flatten().map(|step| step.shader.hash);
        let picture = shaders
            .fold(format!("{} {scene:032x} {}", compiled.plan.id, self.adapter), |text, hash| {
                format!("{text} {hash:032x}")
            });
        let picture = xxh3_128(picture.as_bytes());
        let Args { samples, frame, measure, .. } = self.args;
        let key = format!("{picture:032x} {seed} {samples} {frame} {measure:?}");
        if let Some(measured) = self.known.get(&key) {
            return Ok(Some(*measured));
        }
        let reference = self.reference(at)?;
        let (args, context) = (self.args, self.context);
        let scene = &mut self.scenes[at];
        if scene.renderer.as_ref().is_none_or(|(known, _)| *known != picture) {
            let mut renderer = Renderer::with_scene(Arc::clone(&context.catalog), &scene.shared, args.size);
            renderer.set_frame_options(FrameOptions { timed: true, ..FrameOptions::default() });
            let [resolved] = variants;
            renderer.set_variants(&args.pipeline, &overrides, vec![resolved], options.outputs)?;
            // The first frame includes what the driver compiles.
            render(&mut renderer, args, seed)?;
            scene.renderer = Some((picture, renderer));
        }
        let (_, renderer) = scene.renderer.as_mut().context("a renderer was made")?;
        let ms = render(renderer, args, seed)?;
        let picture = renderer.output(&args.output)?;
        let error = self.args.measure.of(&Pair::new(&picture, &reference)?);
        let measured = Measured { error: error.unwrap_or(f64::INFINITY), ms };
        let line = json!({ "key": key, "values": self.space.words(point), "measured": measured });
        writeln!(self.log, "{line}").context("what was measured cannot be kept")?;
        self.known.insert(key, measured);
        Ok(Some(measured))
    }

    /// The outputs that are rendered.
    fn outputs(&self, overrides: &Overrides) -> Result<Vec<String>> {
        let own = frame_graph::resolve(&self.args.pipeline, self.context.catalog.pipelines(), overrides)?;
        let has_progress = own.outputs().any(|output| *output == *"progress");
        Ok(std::iter::once(self.args.output.clone())
            .chain(has_progress.then(|| "progress".to_owned()))
            .collect())
    }

    fn reference(&mut self, at: usize) -> Result<Image> {
        let (args, context) = (self.args, self.context);
        if let Some(reference) = &self.scenes[at].reference {
            return Ok(reference.clone());
        }
        let scene = &self.scenes[at];
        let own =
            frame_graph::resolve(&args.pipeline, context.catalog.pipelines(), &args.values.overrides())?;
        let values = Overrides(reference_values(bounces(context, &own), args.samples));
        let frame = (args.size, args.frame, REFERENCE_SEED);
        let outputs = std::slice::from_ref(&args.output);
        let picture = reference(context, &scene.shared, frame, &values, outputs)?.swap_remove(0);
        self.scenes[at].reference = Some(picture.clone());
        Ok(picture)
    }
}

/// Renders the frame with a seed; returns its GPU time \[ms\]: the median of some, or of all frames together where a pipeline
/// repeats it until it has converged.
fn render(renderer: &mut Renderer, args: &Args, seed: u32) -> Result<f64> {
    let remembers = renderer.plan().is_some_and(|plan| !plan.histories.is_empty());
    if remembers {
        let scene = renderer.shared_scene().clone();
        renderer.set_shared_scene(&scene)?;
    }
    renderer.set_seed(seed);
    renderer.set_frame_index(args.frame);
    renderer.run_everything();
    let mut times = Vec::new();
    if renderer.plan().is_some_and(|plan| plan.output("progress").is_some()) {
        renderer.frame_until_done(|report, _| {
            times.extend((!report.times.is_empty()).then(|| report.times.iter().sum::<f64>()));
            ControlFlow::Continue(())
        })?;
        times = times.into_iter().reduce(|a, b| a + b).into_iter().collect();
    } else {
        // A frame that follows from the ones before is another one the second time.
        let most = if remembers { 1 } else { TIMED_FRAMES };
        while times.len() < most && times.iter().sum::<f64>() < ENOUGH_MS {
            renderer.set_seed(seed);
            renderer.set_frame_index(args.frame);
            renderer.run_everything();
            let frame = &renderer.frame()?.times;
            if frame.is_empty() {
                break;
            }
            times.push(frame.iter().sum());
        }
    }
    median(&mut times).context("the adapter measures no times, by which settings are chosen")
}

impl Evaluate for Measurer<'_> {
    type Error = anyhow::Error;

    fn evaluate(&mut self, point: &Point, seed: u32) -> Result<Option<Measured>> {
        let (mut error, mut ms) = (0.0, 0.0);
        for at in 0..self.scenes.len() {
            let Some(found) = self.measure(at, point, seed)? else { return Ok(None) };
            error += found.error;
            ms += found.ms;
        }
        if self.seen.insert(point.clone()) {
            self.bar.inc(1);
        }
        let scenes = self.scenes.len() as f64;
        if scenes == 0.0 {
            return Err(anyhow!("there is no scene"));
        }
        Ok(Some(Measured { error: error / scenes, ms: ms / scenes }))
    }
}
