#![doc = include_str!("../README.md")]

use gpu_algorithms::scan;
use interfaces::surface_points;
use pass::{
    Compute, OutputContext, OutputDesc, Pass, PassTypeError, ReadSettings, RecordContext, Recording, Threads,
    UseContext, reflected,
};

/// The pass type `verify-lights`.
pub const PASS: &dyn Pass = &VerifyLights;

struct VerifyLights;

/// Scratch of the scan that lists the lights that are unseen.
const PLACES: &str = "places";

impl Pass for VerifyLights {
    fn kind(&self) -> &'static str {
        "verify-lights"
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let mut outputs = reflected::outputs(use_cx, &self.main_shader(&cx.use_)?, cx)?;
        outputs.extend(scan::scratch(use_cx, PLACES, cx.fact("lights", surface_points::COUNT)?)?);
        Ok(outputs)
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let lights = cx.fact("lights", surface_points::COUNT)?.max(1);
        let shader = cx.file("verify-lights.wgsl");
        let of_lights = |entry| Compute::new(shader.clone(), entry, Threads::Row(lights));
        let list = scan::steps(&cx.use_context(), &shader, lights, PLACES)?;
        let mut recording = Recording::one(of_lights("follow")).then_all(list.clone());
        let threads = Threads::Indirect { buffer: "round".into(), offset: 0 };
        let cast = Compute::new(shader.clone(), "cast_rays", threads).bind("dispatched", "round");
        for _ in 0..cx.settings.u32("rounds")? {
            recording = recording.then(cast.clone()).then(of_lights("settle")).then_all(list.clone());
        }
        Ok(recording.then(of_lights("finish")))
    }
}
