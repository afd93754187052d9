//! Virtual lights where photons meet surfaces.

use interfaces::virtual_lights;
use pass::{
    Compute, Define, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording,
    SceneBindings, Setting, Settings, Threads, UseContext, output, setting,
};

/// The pass type `trace-photons`.
pub const PASS: &dyn Pass = &TracePhotons;

/// Instant radiosity's lights.
#[derive(Debug)]
pub struct TracePhotons;

const SHADER: &str = "passes/trace-photons/trace-photons.wgsl";

pass::settings! {
    /// The settings of the pass type `trace-photons` that are not options of its shader.
    pub struct TracePhotonsSettings {
        /// Number N of virtual lights. Error falls as N^-½; the time for shadows and gathering rises with N.
        count: u32 = 2048, min: 1, max: 2_097_152;
        /// Bounces of indirect light, each of which has a share of the lights: N / `bounces` photons are traced. More:
        /// brighter, and fewer photons.
        bounces: u32 = 3, min: 1, max: 63;
    }
}

impl Pass for TracePhotons {
    fn info(&self) -> Info {
        Info {
            kind: "trace-photons",
            about: "Puts virtual lights where photons from the scene's lights meet surfaces, bounce after bounce.",
            paper: "SMC-IR §5.1, Keller 1997",
            shaders: &[SHADER],
        }
    }

    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        let mut all = TracePhotonsSettings::schema();
        all.extend(setting::of_options(cx.shaders, SHADER, &["ALBEDO", "RAYS"])?);
        Ok(all)
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            outputs: vec![output(
                "lights",
                "VirtualLights",
                "A light for each photon and bounce; dark where it left the scene.",
            )],
            scene_bindings: SceneBindings::SCENE.and(SceneBindings::LIGHTS),
            ..Ports::default()
        })
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let count = TracePhotonsSettings::read(cx.settings).count;
        Ok(vec![virtual_lights::output(use_cx, "lights", count)?])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let settings = TracePhotonsSettings::read(cx.settings);
        let of_scene = |define: &'static str, name: &str| (define, Define::Bool(cx.trait_bool(name)));
        let defines = [
            of_scene("EMISSIVE", "emissive"),
            of_scene("TEXTURED", "textured"),
            of_scene("MASKED", "masked"),
            cx.option("ALBEDO"),
            cx.option("RAYS"),
        ];
        let paths = (settings.count / settings.bounces).max(1);
        Ok(Recording::one(Compute::new(cx.shader(SHADER, &defines), "trace_photons", Threads::Row(paths))))
    }
}
