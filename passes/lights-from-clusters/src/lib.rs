#![doc = include_str!("../README.md")]

use gpu_algorithms::reduce;
use pass::{
    Compute, OutputContext, OutputDesc, Pass, PassTypeError, ReadSettings, RecordContext, Recording, Threads,
    UseContext, reflected,
};

/// The pass type `lights-from-clusters`.
pub const PASS: &dyn Pass = &LightsFromClusters;

struct LightsFromClusters;

impl Pass for LightsFromClusters {
    fn kind(&self) -> &'static str {
        "lights-from-clusters"
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        if cx.settings.text("place")? == "texel" && cx.input("rsm").is_none() {
            return Err(PassTypeError::input("rsm", "lights are at a texel each, and there are no texels")
                .help("link the reflective shadow map, or take `place: \"mean\"`"));
        }
        reflected::outputs(use_cx, &self.main_shader(&cx.use_)?, cx)
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let shader = cx.file("lights-from-clusters.wgsl");
        let lights = cx.fact("lights", interfaces::virtual_lights::COUNT)?;
        let make = Compute::new(shader.clone(), "make_lights", Threads::Row(lights));
        Ok(Recording::one(reduce::few(&shader)).then(make))
    }
}
