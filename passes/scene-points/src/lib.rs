//! Samples the surfaces of the scene uniformly by area.

pub mod cpu_reference;

use interfaces::points;
use pass::{
    Compute, Info, Module, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording,
    SceneBindings, Setting, Settings, Struct, Threads, UseContext, output,
};

/// The pass, for the catalog.
pub const PASS: &dyn Pass = &ScenePoints;

/// See the crate.
pub struct ScenePoints;

const POINT: Struct = Struct::new("shaders/points.wgsl", "Point");

pass::settings! {
    /// The settings of the pass type `scene-points`.
    pub struct ScenePointsSettings {
        /// Number of points, which all maps share; 32 bytes each. More: fewer holes in the shadow maps, but
        /// more time and memory. More than 4,194,304 require an adapter that binds buffers of more than 128
        /// MiB.
        count: u32 = 262_144, min: 1, max: 8_388_608;
    }
}

impl Pass for ScenePoints {
    fn info(&self) -> Info {
        Info {
            kind: "scene-points",
            about: "Samples the scene's surfaces uniformly by area, in an order of which every run is stratified.",
            paper: "ISM §3.1",
            shaders: &["passes/scene-points/scene-points.wgsl"],
        }
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        Ok(ScenePointsSettings::schema())
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            outputs: vec![output(
                "points",
                "Points",
                "Every run of 2^m that starts at a multiple of 2^m is stratified by itself.",
            )],
            scene_bindings: SceneBindings::SCENE,
            ..Ports::default()
        })
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let count = ScenePointsSettings::read(cx.settings).count;
        let desc = use_cx.buffer(POINT, u64::from(count))?;
        Ok(vec![
            OutputDesc::one("points", desc)
                .module(Module::new("shaders/points-stored.wgsl"))
                .fact(points::COUNT, count),
        ])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let shader = cx.shader("passes/scene-points/scene-points.wgsl", &[]);
        let count = ScenePointsSettings::read(cx.settings).count;
        Ok(Recording::one(Compute::new(shader, "place", Threads::Row(count))))
    }
}
