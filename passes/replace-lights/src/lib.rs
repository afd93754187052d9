//! Lights that give way to stronger candidates: few in a frame.

pub mod cpu_reference;

use interfaces::{progress, surface_points};
use pass::{
    Compute, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording,
    ResourceDesc, Setting, Settings, Struct, Threads, UseContext, input, output,
};

/// The pass type `replace-lights`.
pub const PASS: &dyn Pass = &ReplaceLights;

/// The replacement of lights of SMC-IR.
#[derive(Debug)]
pub struct ReplaceLights;

const INTENSITIES: &str = "passes/replace-lights/intensities.wgsl";
const DECIDE: &str = "passes/replace-lights/decide.wgsl";
const REPLACE: &str = "passes/replace-lights/replace-lights.wgsl";
const DECISION: Struct = Struct::new("passes/replace-lights/keys.wgsl", "Decision");

pass::settings! {
    /// The settings of the pass type `replace-lights`.
    pub struct ReplaceLightsSettings {
        /// The most lights replaced in a frame, M_max. More: lights follow camera and light sources sooner, and flicker
        /// more. 0: none, once there are lights.
        moved: u32 = 16, min: 0, max: 65_536;
        /// Share of the lights that a candidate has to outshine to be a sign that there are too few where it is. Less:
        /// more lights move in frames in which all reach the view.
        quantile: f32 = 0.95, min: 0.0, max: 1.0;
        /// Iterations before the first frame. More: lights are better distributed when it comes, after a longer wait.
        warm_up: u32 = 100, min: 0, max: 1_000;
    }
}

impl Pass for ReplaceLights {
    fn info(&self) -> Info {
        Info {
            kind: "replace-lights",
            about: "Puts the strongest candidates in place of lights that reach nothing in view, or are the weakest.",
            paper: "SMC-IR §3.2.5, Alg. 1",
            shaders: &[INTENSITIES, DECIDE, REPLACE],
        }
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        Ok(ReplaceLightsSettings::schema())
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![
                input(
                    "lights",
                    "SurfacePoints",
                    "Where the lights of the frame before are; marked are those to go first.",
                ),
                input("mailboxes", "SurfacePoints", "For each light, a point in view that it reaches."),
                input(
                    "intensities",
                    "VirtualLights",
                    "The lights of the frame before: `prev` of what is made of `replaced`.",
                ),
                input(
                    "candidates",
                    "SurfacePoints",
                    "Where lights may come: as many as there are places for lights.",
                ),
                input(
                    "origins",
                    "SurfacePoints",
                    "For each candidate, the point in view that it was traced from.",
                ),
                input("radiosity", "Radiosity", "Radiosity of the candidates."),
                input("density", "Density", "Density of the lights around each candidate."),
            ],
            outputs: vec![
                output(
                    "replaced",
                    "SurfacePoints",
                    "Where the lights are now; its header's `marked` counts the new ones.",
                ),
                output("witnesses", "SurfacePoints", "For each of them, a point that it reaches."),
                output("progress", "Progress", "How many iterations there were before the first frame."),
            ],
            ..Ports::default()
        })
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let count = cx.fact("candidates", surface_points::COUNT)?;
        let list = |name: &str| OutputDesc::scratch(name, ResourceDesc::buffer(4 * u64::from(count.max(1))));
        Ok(vec![
            surface_points::output(use_cx, "replaced", count)?,
            surface_points::output(use_cx, "witnesses", count)?,
            OutputDesc::one("progress", progress::buffer(use_cx)?),
            list("light_keys"),
            list("candidate_keys"),
            list("newcomers"),
            list("chosen"),
            OutputDesc::scratch("decision", use_cx.buffer(DECISION, 1)?),
        ])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let count = cx.fact("candidates", surface_points::COUNT)?;
        let step =
            |file, entry, length: u32| Compute::new(cx.shader(file, &[]), entry, Threads::Row(length.max(1)));
        Ok(Recording::one(step(INTENSITIES, "rank", count))
            .then(step(DECIDE, "decide", 1))
            .then(step(REPLACE, "replace", count)))
    }
}
