//! Samples of the surfaces that the camera sees.

use interfaces::surface_points;
use pass::{
    Compute, Define, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording,
    SceneBindings, Setting, Settings, Threads, UseContext, optional, output, setting,
};

/// The pass, for the catalog.
pub const PASS: &dyn Pass = &ViewPoints;

/// See the crate.
#[derive(Debug)]
pub struct ViewPoints;

const SHADER: &str = "passes/view-points/view-points.wgsl";

pass::settings! {
    /// The settings of the pass type `view-points` that are not options of its shader.
    pub struct ViewPointsSettings {
        /// Number I of virtual lights that the points are for. More than 2,796,202 points in all require an adapter that
        /// binds buffers of more than 128 MiB.
        count: u32 = 2048, min: 1, max: 2_097_152;
        /// Points for each virtual light. More: candidates for lights are more uniform, and small parts of the image have
        /// points in each frame, but the time for rays and densities grows.
        rate: u32 = 16, min: 1, max: 4096;
        /// Whether each iteration has other points.
        vary: bool = true;
    }
}

impl Pass for ViewPoints {
    fn info(&self) -> Info {
        Info {
            kind: "view-points",
            about: "Samples the surfaces that the camera sees, stratified over the image.",
            paper: "SMC-IR §3.2, Alg. 1",
            shaders: &[SHADER],
        }
    }

    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        let mut all = ViewPointsSettings::schema();
        all.extend(setting::of_options(cx.shaders, SHADER, &["RAYS"])?);
        Ok(all)
    }

    fn ports(&self, cx: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        let scene = SceneBindings::SCENE.and(SceneBindings::CAMERA);
        let past = cx.use_.inputs.iter().any(|input| input == "past");
        Ok(Ports {
            inputs: vec![optional(
                "past",
                "SurfacePoints",
                "Points whose iteration is the one before this: a link with `Prev`. Without it, the frame's number counts.",
            )],
            outputs: vec![output("points", "SurfacePoints", "Points; empty where the camera sees nothing.")],
            scene_bindings: if past { scene } else { scene.and(SceneBindings::FRAME) },
        })
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let settings = ViewPointsSettings::read(cx.settings);
        Ok(vec![surface_points::output(use_cx, "points", settings.count * settings.rate)?])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let defines = [
            ("PAST", Define::Bool(cx.connected("past"))),
            ("TEXTURED", Define::Bool(cx.trait_bool("textured"))),
            ("MASKED", Define::Bool(cx.trait_bool("masked"))),
            cx.option("RAYS"),
        ];
        let count = cx.fact("points", surface_points::COUNT)?;
        Ok(Recording::one(Compute::new(cx.shader(SHADER, &defines), "see", Threads::Row(count))))
    }
}
