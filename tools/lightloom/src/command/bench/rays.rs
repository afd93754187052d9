//! Rays per second.

#[cfg(feature = "native-rays")]
mod native;

use super::running::Running;
#[cfg(feature = "native-rays")]
use super::table::Goal;
use super::table::{Row, Section, Spread};
use super::{Bench, label};
use anyhow::{Context as _, Result};
use executor::FrameOptions;
use frame_graph::{Overrides, Value};

const PIPELINE: &str = include_str!("rays/rays.ron");

/// Scenes that are always measured.
const SCENES: [&str; 2] = ["cornell-box", "atrium"];

/// The timed passes with their descriptions.
const TIMED: [(&str, &str); 4] = [
    ("camera-closest", "closest hit, camera rays"),
    ("camera-any", "any hit, camera rays"),
    ("surface-closest", "closest hit, diffuse rays"),
    ("surface-any", "any hit, diffuse rays"),
];

pub(super) fn measure(bench: &Bench<'_>) -> Result<Section> {
    let gpu = bench.timing_gpu()?;
    let side = bench.size(512, 32);
    let values = Overrides(vec![("rays".to_owned(), Value::U32(side * side))]);
    let mut ways = vec![("bvh", "")];
    if gpu.has_ray_queries() {
        ways.push(("query", ", ray queries"));
    }
    let scenes: Vec<&str> = SCENES.into_iter().chain(bench.args.scene.iter().map(String::as_str)).collect();
    let mut rows = Vec::new();
    let mut sizes = Vec::new();
    for name in scenes {
        let scene = renderer::load_scene(bench.catalog(), name)?;
        let name = label(name);
        sizes.push(format!("{name} {} triangles", scene.triangles()));
        for (way, said) in &ways {
            let mut traits = scene.traits();
            // The pass type `compute` gives options the values of traits of their names.
            traits.values.insert("rays".to_owned(), Value::Text((*way).into()));
            let device = (gpu.clone(), &**bench.catalog());
            let running = Running::new(device, (PIPELINE, &values), (&scene, traits), (side, side))?;
            rows.extend(RayBench(running).rows(bench.args.runs, said, name)?);
        }
    }
    let note = format!(
        "{side}×{side} rays of the camera; from what they see one each over the cosine, diffuse. One ray a thread, to any distance; only rays that exist are counted. {}.",
        sizes.join(", ")
    );
    Ok(Section { rows, note })
}

/// A scene with the pipeline. The renderer has no choice of variants of a user's shader, so the executor is driven here.
struct RayBench<'a>(Running<'a>);

impl RayBench<'_> {
    /// Returns the milliseconds of each pass.
    fn frame(&mut self) -> Result<Vec<f64>> {
        let options = FrameOptions { timed: true, ..FrameOptions::default() };
        Ok(self.0.frame(None, options)?.times.clone())
    }

    fn rows(&mut self, runs: u32, way: &str, scene: &str) -> Result<Vec<Row>> {
        self.frame()?;
        #[cfg(feature = "native-rays")]
        let mut native =
            native::Native::new(self.0.scene, |pass| self.read(pass.split('-').next().unwrap_or(pass)))?;
        let mut passes = [0; TIMED.len()];
        for (id, (pass, _)) in passes.iter_mut().zip(TIMED) {
            let found = self.0.plan.pass(pass).with_context(|| format!("the plan has no pass `{pass}`"))?;
            *id = found.0 as usize;
        }
        let mut times = [const { Vec::new() }; TIMED.len()];
        for _ in 0..runs {
            let frame = self.frame()?;
            times.iter_mut().zip(passes).for_each(|(times, id)| times.push(frame[id]));
            #[cfg(feature = "native-rays")]
            native.run();
        }
        let mut rows = Vec::new();
        for ((pass, what), times) in TIMED.into_iter().zip(&times) {
            let (count, hits) = self.count(pass, pass.ends_with("-any"))?;
            // A ray a microsecond is a million a second.
            let rate = Spread::of(times.clone()).under(count as f64 / 1e3);
            rows.push(
                Row::new(format!("{what}{way}, {scene}"), rate, "Mray/s")
                    .counts(vec![("rays", count), ("hits", hits)]),
            );
        }
        #[cfg(feature = "native-rays")]
        if way.is_empty() {
            rows.extend(native.rows(&times, scene));
        }
        Ok(rows)
    }

    /// Returns the bytes of an output.
    fn read(&self, output: &str) -> Result<Vec<u8>> {
        let found = self.0.plan.output(output).and_then(|output| output.members.first());
        let (_, id) = found.with_context(|| format!("the plan has no output `{output}`"))?;
        Ok(self.0.executor.read(*id)?)
    }

    /// Returns the number of rays that a pass has traced, and of those that hit something.
    fn count(&self, pass: &str, any: bool) -> Result<(u64, u64)> {
        let bytes = self.read(pass)?;
        let words = |bytes: &[u8]| -> Vec<u32> {
            bytes.chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
        };
        let (mut rays, mut hits) = (0, 0);
        if any {
            for word in words(&bytes) {
                rays += u64::from(word != 0);
                hits += u64::from(word == 2);
            }
        } else {
            // A distance of 0 is no hit: they lie beyond the ray's beginning.
            for hit in words(&bytes).chunks_exact(4) {
                rays += u64::from(hit[0] != 0);
                hits += u64::from(hit[0] != 0 && hit[1] != u32::MAX);
            }
        }
        Ok((rays, hits))
    }
}
