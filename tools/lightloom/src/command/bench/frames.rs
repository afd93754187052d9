//! Frames of pipelines, pass by pass.

use super::table::{Goal, Row, Section, Spread};
use super::{Bench, Figure, label};
use anyhow::Result;
use frame_graph::{Overrides, Value};
use renderer::{FrameOptions, Renderer};
use std::sync::Arc;

/// The first scene that is given, or the atrium, which has about the structure of Sponza.
fn scene<'a>(bench: &'a Bench<'_>) -> &'a str {
    bench.args.scene.first().map_or("atrium", String::as_str)
}

/// A pipeline whose passes are all run and timed in each frame. One frame has been.
struct Timed(Renderer);

impl Timed {
    fn new(bench: &Bench<'_>, pipeline: &str, frame: (u32, u32), values: &[(&str, u32)]) -> Result<Timed> {
        let gpu = bench.timing_gpu()?;
        let loaded = renderer::load_scene(bench.catalog, scene(bench))?;
        let mut renderer = Renderer::new(gpu, Arc::clone(bench.catalog), loaded, frame)?;
        let values = values.iter().map(|(name, value)| ((*name).to_owned(), Value::U32(*value)));
        renderer.set_pipeline(pipeline, &Overrides(values.collect()))?;
        renderer.set_frame_options(FrameOptions { timed: true, poison: false });
        let mut timed = Timed(renderer);
        timed.frame()?;
        Ok(timed)
    }

    /// Milliseconds of each pass.
    fn frame(&mut self) -> Result<Vec<f64>> {
        self.0.run_everything();
        Ok(self.0.frame()?.times)
    }

    fn passes(&self) -> Vec<String> {
        let passes = self.0.plan().map_or(&[][..], |plan| &plan.passes);
        passes.iter().map(|pass| pass.name.to_string()).collect()
    }

    fn triangles(&self) -> usize {
        self.0.scene().triangles()
    }
}

/// The pass `shadows`, or those of the part of that name.
fn makes_maps(pass: &str) -> bool {
    pass == "shadows" || pass.starts_with("shadows/")
}

pub(super) fn shadow_maps(bench: &Bench<'_>) -> Result<Section> {
    let (lights, map) = (bench.size(256, 8), bench.size(256, 32));
    let frame = (bench.size(640, 40), bench.size(480, 30));
    let values = [("lights", lights), ("map", map)];
    let mut pair =
        [Timed::new(bench, "ism-classic", frame, &values)?, Timed::new(bench, "ism", frame, &values)?];
    // In turn, so that whatever else the machine does slows both.
    let mut maps = [Vec::new(), Vec::new()];
    let mut frames = [Vec::new(), Vec::new()];
    for _ in 0..bench.args.runs {
        for (i, timed) in pair.iter_mut().enumerate() {
            let times = timed.frame()?;
            let names = timed.passes();
            let of_maps = names.iter().zip(&times).filter(|(name, _)| makes_maps(name));
            maps[i].push(of_maps.map(|(_, time)| time).sum());
            frames[i].push(times.iter().sum());
        }
    }
    let [classic, imperfect] = maps.map(Spread::of);
    let [classic_frame, imperfect_frame] = frames.map(Spread::of);
    let what = format!("{lights} maps of {map}²");
    let rows = vec![
        Row::new(format!("imperfect against classic, {what}: maps"), classic.over(imperfect), "×")
            .goal(Goal::AtLeast(30.0), "ISM §5"),
        Row::new(
            format!("imperfect against classic, {what}: frame"),
            classic_frame.over(imperfect_frame),
            "×",
        )
        .goal(Goal::AtLeast(10.0), "ISM §5"),
        Row::new(format!("{what}, classic"), classic, "ms"),
        Row::new(format!("{what}, imperfect"), imperfect, "ms"),
        Row::new(format!("frame with {what}, classic"), classic_frame, "ms"),
        Row::new(format!("frame with {what}, imperfect"), imperfect_frame, "ms"),
    ];
    let note = format!(
        "`ism-classic` against `ism` on {} ({} triangles), {}×{} pixels; imperfect maps with their points, splats and pull-push. Ratios of medians, frames in turn.",
        label(scene(bench)),
        pair[0].triangles(),
        frame.0,
        frame.1,
    );
    Ok(Section { figure: Figure::ShadowMaps, rows, note })
}

pub(super) fn ism_frame(bench: &Bench<'_>) -> Result<Section> {
    let (lights, map, side) = (bench.size(1024, 32), bench.size(64, 16), bench.size(256, 32));
    let mut timed = Timed::new(bench, "ism", (side, side), &[("lights", lights), ("map", map)])?;
    let frames = (0..bench.args.runs).map(|_| timed.frame()).collect::<Result<Vec<_>>>()?;
    let whole = Spread::of(frames.iter().map(|times| times.iter().sum()).collect());
    let name = format!("ism, {lights} lights, maps of {map}², {side}² pixels");
    let mut rows = vec![Row::new(name, whole, "ms").goal(Goal::Below(90.0), "own, two cores, Sponza")];
    for (i, pass) in timed.passes().iter().enumerate() {
        let times = Spread::of(frames.iter().map(|times| times[i]).collect());
        rows.push(Row::new(format!("ism: {pass}"), times, "ms"));
    }
    let note = format!(
        "on {} ({} triangles); GPU time, every pass run anew in each frame.",
        label(scene(bench)),
        timed.triangles()
    );
    Ok(Section { figure: Figure::IsmFrame, rows, note })
}
