//! Frames of pipelines, pass by pass.

use super::table::{Goal, Row, Section, Spread};
use super::{Bench, Figure, label};
use anyhow::Result;
use frame_graph::{Overrides, Value};
use renderer::{FrameOptions, Renderer};
use std::sync::Arc;

/// Returns the first scene that is given, or the atrium, which has about the structure of Sponza.
pub(super) fn scene<'a>(bench: &'a Bench<'_>) -> &'a str {
    bench.args.scene.first().map_or("atrium", String::as_str)
}

/// A pipeline whose passes are all run and timed in each frame. One frame has been.
pub(super) struct Timed(Renderer);

impl Timed {
    pub(super) fn new(
        bench: &Bench<'_>,
        pipeline: &str,
        frame: (u32, u32),
        values: &[(&str, u32)],
    ) -> Result<Timed> {
        let gpu = bench.timing_gpu()?;
        let loaded = renderer::load_scene(bench.catalog, scene(bench))?;
        let mut renderer = Renderer::new(gpu, Arc::clone(bench.catalog), loaded, frame)?;
        let values = values.iter().map(|(name, value)| ((*name).to_owned(), Value::U32(*value)));
        renderer.set_pipeline(pipeline, &Overrides(values.collect()))?;
        renderer.set_frame_options(FrameOptions { timed: true, ..FrameOptions::default() });
        let mut timed = Timed(renderer);
        timed.frame()?;
        Ok(timed)
    }

    /// Returns the milliseconds of each pass.
    pub(super) fn frame(&mut self) -> Result<Vec<f64>> {
        self.0.run_everything();
        Ok(self.0.frame()?.times.clone())
    }

    fn passes(&self) -> Vec<String> {
        let passes = self.0.plan().map_or(&[][..], |plan| &plan.passes);
        passes.iter().map(|pass| pass.name.to_string()).collect()
    }

    pub(super) fn triangles(&self) -> usize {
        self.0.scene().triangles()
    }

    pub(super) fn renderer(&mut self) -> &mut Renderer {
        &mut self.0
    }
}

/// Passes that a figure takes together.
type Phase = fn(&str) -> bool;

/// Returns the times of phases in two pipelines, whose frames run in turn, so that other work of the machine slows both.
fn in_turn<const PHASES: usize>(
    bench: &Bench<'_>,
    pair: &mut [Timed; 2],
    phases: [Phase; PHASES],
) -> Result<[[Spread; 2]; PHASES]> {
    let mut times = phases.map(|_| [Vec::new(), Vec::new()]);
    for _ in 0..bench.args.runs {
        for (i, timed) in pair.iter_mut().enumerate() {
            let frame = timed.frame()?;
            let names = timed.passes();
            for (phase, times) in phases.iter().zip(&mut times) {
                let passes = names.iter().zip(&frame).filter(|(name, _)| phase(name));
                times[i].push(passes.map(|(_, time)| time).sum());
            }
        }
    }
    Ok(times.map(|pair| pair.map(Spread::of)))
}

/// Returns whether a pass is `shadows`, or one of the sub-graph of that name.
fn makes_maps(pass: &str) -> bool {
    pass == "shadows" || pass.starts_with("shadows/")
}

fn time(name: String, time: Spread) -> Row {
    Row::new(name, time, "ms")
}

/// Returns the ratio of two times.
fn ratio(name: String, [over, under]: [Spread; 2]) -> Row {
    Row::new(name, over.over(under), "×")
}

pub(super) fn shadow_maps(bench: &Bench<'_>) -> Result<Section> {
    let (lights, map) = (bench.size(256, 8), bench.size(256, 32));
    let frame = (bench.size(640, 40), bench.size(480, 30));
    let values = [("lights", lights), ("map", map)];
    let mut pair =
        [Timed::new(bench, "ism-classic", frame, &values)?, Timed::new(bench, "ism", frame, &values)?];
    let [[classic, imperfect], [classic_frame, imperfect_frame]] =
        in_turn(bench, &mut pair, [makes_maps, |_| true])?;
    let what = format!("{lights} maps of {map}²");
    let rows = vec![
        ratio(format!("imperfect against classic, {what}: maps"), [classic, imperfect])
            .goal(Goal::AtLeast(30.0), "ISM §5"),
        ratio(format!("imperfect against classic, {what}: frame"), [classic_frame, imperfect_frame])
            .goal(Goal::AtLeast(10.0), "ISM §5"),
        time(format!("{what}, classic"), classic),
        time(format!("{what}, imperfect"), imperfect),
        time(format!("frame with {what}, classic"), classic_frame),
        time(format!("frame with {what}, imperfect"), imperfect_frame),
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

pub(super) fn samplers(bench: &Bench<'_>) -> Result<Section> {
    let (lights, side) = (bench.size(1024, 32), bench.size(512, 32));
    // Only the sampler counts: the rest is as little as it can be.
    let values = [("lights", lights), ("rsm.size", side), ("map", 8), ("shadows.points_per_map", 1)];
    let timed = |pipeline| Timed::new(bench, pipeline, (32, 32), &values);
    let mut pair = [timed("ism-invtm")?, timed("tcas")?];
    let [[inverse, chains]] = in_turn(bench, &mut pair, [|pass| pass == "lights"])?;
    let what = format!("{lights} lights from {side}² texels");
    let rows = vec![
        ratio(format!("chains of 5 steps against inverse transform, {what}"), [inverse, chains])
            .goal(Goal::AtLeast(2.0), "TCAS Tab. 2"),
        time(format!("{what}, inverse transform"), inverse),
        time(format!("{what}, chains of 5 steps"), chains),
    ];
    let note = format!(
        "the pass `lights` of `ism-invtm` against that of `tcas` on {}; the sums over the importance map are part of the \
         inverse transform, and the importance itself part of the chains. Ratios of medians, frames in turn.",
        label(scene(bench))
    );
    Ok(Section { figure: Figure::Samplers, rows, note })
}

pub(super) fn points(bench: &Bench<'_>) -> Result<Section> {
    let (maps, per_map) = (bench.size(1024, 16), bench.size(4096, 64));
    let all = maps * per_map;
    let values = [("lights", maps), ("rsm.size", 32), ("shadows.points_per_map", per_map)];
    let stored_values = [&values[..], &[("shadows.points", all)]].concat();
    let mut pair = [
        Timed::new(bench, "tcas-stored", (32, 32), &stored_values)?,
        Timed::new(bench, "tcas", (32, 32), &values)?,
    ];
    let phases: [Phase; 2] =
        [|pass| pass == "shadows/splat", |pass| makes_maps(pass) && pass != "shadows/fill"];
    let [[stored, fly], [made_and_stored, made_on_the_fly]] = in_turn(bench, &mut pair, phases)?;
    let what = format!("{:.1} M splats", f64::from(all) * 1e-6);
    let rows = vec![
        ratio(format!("points on the fly against stored, {what}"), [stored, made_on_the_fly])
            .goal(Goal::AtLeast(2.5), "TCAS Tab. 3, on a GPU"),
        ratio(
            format!("the same where stored ones are made again, {what}"),
            [made_and_stored, made_on_the_fly],
        ),
        time(format!("{what}, stored points"), stored),
        time(format!("{what}, points on the fly"), fly),
        time(format!("{what}, points on the fly with the shares of triangles"), made_on_the_fly),
    ];
    let note = format!(
        "`shadows/splat` of `tcas-stored` against `shadows/points` and `shadows/splat` of `tcas` on {} ({} triangles), {maps} \
         maps of 64². Ratios of medians, frames in turn.",
        label(scene(bench)),
        pair[0].triangles(),
    );
    Ok(Section { figure: Figure::Points, rows, note })
}

pub(super) fn ism_frame(bench: &Bench<'_>) -> Result<Section> {
    let (lights, map, side) = (bench.size(1024, 32), bench.size(64, 16), bench.size(256, 32));
    let mut timed = Timed::new(bench, "ism", (side, side), &[("lights", lights), ("map", map)])?;
    let frames = (0..bench.args.runs).map(|_| timed.frame()).collect::<Result<Vec<_>>>()?;
    let passes = timed.passes();
    // What runs in a frame in which lights and camera move and geometry does not.
    let without_points = |times: &Vec<f64>| {
        let kept = passes.iter().zip(times).filter(|(pass, _)| *pass != "shadows/points");
        kept.map(|(_, time)| time).sum()
    };
    let name = format!("ism, {lights} lights, maps of {map}², {side}² pixels");
    let spread = |of: &dyn Fn(&Vec<f64>) -> f64| Spread::of(frames.iter().map(of).collect());
    let mut rows = vec![
        time(format!("{name}: stored points kept"), spread(&without_points))
            .goal(Goal::Below(90.0), "own, two cores, Sponza"),
        time(format!("{name}: stored points made again"), spread(&|times| times.iter().sum())),
    ];
    for (i, pass) in passes.iter().enumerate() {
        rows.push(time(format!("ism: {pass}"), spread(&|times| times[i])));
    }
    let note = format!(
        "on {} ({} triangles); GPU time, every pass run again in each frame. Points are stored once, as ISM §3.1 has it, and \
         made again only where geometry moves: without their pass, and with it.",
        label(scene(bench)),
        timed.triangles()
    );
    Ok(Section { figure: Figure::IsmFrame, rows, note })
}
