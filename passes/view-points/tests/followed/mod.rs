//! A pass that calls `followed` of shaders/surface-point.wgsl.

use interfaces::surface_points;
use pass::{
    Compute, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording,
    SceneBindings, Setting, Settings, Threads, UseContext, input, output,
};

const SHADER: &str = "passes/view-points/tests/followed/followed.wgsl";

/// Moves points to where their triangles are.
pub(crate) struct Followed;

impl Pass for Followed {
    fn info(&self) -> Info {
        Info { kind: "followed", about: "", paper: "", shaders: &[SHADER] }
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        Ok(Vec::new())
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![input("points", "SurfacePoints", "")],
            outputs: vec![output("followed", "SurfacePoints", "")],
            scene_bindings: SceneBindings::SCENE,
        })
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        Ok(vec![surface_points::output(use_cx, "followed", cx.fact("points", surface_points::COUNT)?)?])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let count = cx.fact("points", surface_points::COUNT)?;
        let follow = Compute::new(cx.shader(SHADER, &[]), "follow", Threads::Row(count));
        Ok(Recording::one(follow.bind("followed_points", "followed")))
    }
}
