//! Rays per second.

#[cfg(feature = "native-rays")]
mod native;

#[cfg(feature = "native-rays")]
use super::table::Goal;
use super::table::{Row, Section, Spread};
use super::{Bench, Figure, label};
use anyhow::{Context as _, Result};
use executor::{Executor, FrameOptions, Gpu};
use frame_graph::{Change, CompileOptions, LinkContext, Overrides, Plan, Value};
use renderer::{Catalog, Compiled};
use scene::Scene;
use scene_upload::{Frame, SceneView};
use std::sync::Arc;

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
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("rays.ron");
    std::fs::write(&path, pipeline(side * side))?;
    let path = path.to_string_lossy();
    let mut ways = vec![("bvh", "")];
    if gpu.has_ray_queries() {
        ways.push(("query", ", ray queries"));
    }
    let scenes: Vec<&str> = SCENES.into_iter().chain(bench.args.scene.iter().map(String::as_str)).collect();
    let mut rows = Vec::new();
    let mut sizes = Vec::new();
    for name in scenes {
        let scene = renderer::load_scene(bench.catalog, name)?;
        let name = label(name);
        sizes.push(format!("{name} {} triangles", scene.triangles()));
        for (way, said) in &ways {
            let mut ray_bench = RayBench::new(gpu.clone(), bench.catalog, &path, &scene, side, way)?;
            rows.extend(ray_bench.rows(bench.args.runs, said, name)?);
        }
    }
    let note = format!(
        "{side}×{side} rays of the camera; from what they see one each over the cosine, diffuse. One ray a thread, to any distance; only rays that exist are counted. {}.",
        sizes.join(", ")
    );
    Ok(Section { figure: Figure::Rays, rows, note })
}

/// Returns the pipeline of this many rays.
fn pipeline(rays: u32) -> String {
    let made = format!(
        r#"kind: "compute", shader: "shaders/bench/make-rays.wgsl", out: {{ "rays": Out(count: {rays}) }}"#
    );
    let hits = format!(r#"out: {{ "hits": Out(count: {rays}) }}"#);
    let closest = format!(r#"kind: "compute", shader: "shaders/bench/closest-hit.wgsl", {hits}"#);
    let any = format!(r#"kind: "compute", shader: "shaders/bench/any-hit.wgsl", {hits}"#);
    format!(
        r#"Pipeline(
    passes: {{
        "camera": Pass({made}),
        "surface": Pass({made}, set: {{ "from_surfaces": 1 }}),
        "camera-closest": Pass({closest}, in: {{ "rays": "camera" }}),
        "camera-any": Pass({any}, in: {{ "rays": "camera" }}),
        "surface-closest": Pass({closest}, in: {{ "rays": "surface" }}),
        "surface-any": Pass({any}, in: {{ "rays": "surface" }}),
    }},
    outputs: {{
        "camera": "camera",
        "surface": "surface",
        "camera-closest": "camera-closest",
        "camera-any": "camera-any",
        "surface-closest": "surface-closest",
        "surface-any": "surface-any",
    }},
)"#
    )
}

/// A scene with the pipeline. The renderer has no choice of variants of a user's shader, so the executor is driven here.
struct RayBench<'a> {
    executor: Executor,
    view: SceneView,
    scene: &'a Scene,
    plan: Arc<Plan>,
    side: u32,
}

impl RayBench<'_> {
    fn new<'a>(
        gpu: Gpu,
        catalog: &Catalog,
        pipeline: &str,
        scene: &'a Scene,
        side: u32,
        way: &str,
    ) -> Result<RayBench<'a>> {
        let mut traits = scene.traits();
        // The pass type `compute` gives options the values of traits of their names.
        traits.0.insert("rays".to_owned(), Value::Text(way.into()));
        let context = LinkContext { frame: (side, side), traits };
        let compiled =
            Compiled::new(catalog, pipeline, &Overrides::default(), &context, &CompileOptions::default())?;
        let mut executor = Executor::new(gpu);
        let mut view = SceneView::upload(&mut executor, scene);
        let scene_bindings = compiled.steps.iter().flatten().flat_map(|step| step.scene_bindings());
        view.provide(&mut executor, scene, scene_bindings)?;
        executor.load(Arc::clone(&compiled.plan), compiled.steps)?;
        Ok(RayBench { executor, view, scene, plan: compiled.plan, side })
    }

    /// Returns the milliseconds of each pass.
    fn frame(&mut self) -> Result<Vec<f64>> {
        let frame = Frame { index: 0, time: 0.0, step: 0.0, pad: 0.0 };
        let (pose, size) = (self.scene.at(0.0), (self.side, self.side));
        let mut change = Change { all: true, ..Change::default() };
        self.view.update(&mut self.executor, self.scene, &pose, size, frame, &mut change)?;
        let options = FrameOptions { timed: true, ..FrameOptions::default() };
        Ok(self.executor.frame(&change, options)?.times.clone())
    }

    fn rows(&mut self, runs: u32, way: &str, scene: &str) -> Result<Vec<Row>> {
        self.frame()?;
        #[cfg(feature = "native-rays")]
        let mut native =
            native::Native::new(self.scene, |pass| self.read(pass.split('-').next().unwrap_or(pass)))?;
        let mut passes = [0; TIMED.len()];
        for (id, (pass, _)) in passes.iter_mut().zip(TIMED) {
            let found = self.plan.pass(pass).with_context(|| format!("the plan has no pass `{pass}`"))?;
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
        let found = self.plan.output(output).and_then(|output| output.members.first());
        let (_, id) = found.with_context(|| format!("the plan has no output `{output}`"))?;
        Ok(self.executor.read(*id)?)
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
