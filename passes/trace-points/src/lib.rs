//! What surface points see along a ray from each.

use interfaces::surface_points;
use pass::{
    Compute, Define, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording,
    SceneBindings, Setting, Settings, Threads, UseContext, input, output, setting,
};

/// The pass, for the catalog.
pub const PASS: &dyn Pass = &TracePoints;

/// See the crate.
#[derive(Debug)]
pub struct TracePoints;

const SHADER: &str = "passes/trace-points/trace-points.wgsl";

impl Pass for TracePoints {
    fn info(&self) -> Info {
        Info {
            kind: "trace-points",
            about: "Traces a ray from each of a number of surface points to the point that it meets.",
            paper: "SMC-IR §3.2.1, Alg. 1",
            shaders: &[SHADER],
        }
    }

    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        setting::of_options(cx.shaders, SHADER, &["DIRECTIONS", "RAYS"])
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![input("points", "SurfacePoints", "Where rays begin.")],
            outputs: vec![output(
                "traced",
                "SurfacePoints",
                "Where they end; empty where a ray meets nothing, and where none begins.",
            )],
            scene_bindings: SceneBindings::SCENE,
        })
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        Ok(vec![surface_points::output(use_cx, "traced", cx.fact("points", surface_points::COUNT)?)?])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let defines = [
            ("TEXTURED", Define::Bool(cx.trait_bool("textured"))),
            ("MASKED", Define::Bool(cx.trait_bool("masked"))),
            cx.option("DIRECTIONS"),
            cx.option("RAYS"),
        ];
        let count = cx.fact("points", surface_points::COUNT)?;
        Ok(Recording::one(Compute::new(cx.shader(SHADER, &defines), "see", Threads::Row(count))))
    }
}
