#![doc = include_str!("../README.md")]

use interfaces::virtual_lights;
use pass::{Compute, Pass, PassTypeError, ReadSettings, RecordContext, Recording, Threads};

/// The pass type `cluster-lights`.
pub const PASS: &dyn Pass = &ClusterLights;

struct ClusterLights;

impl Pass for ClusterLights {
    fn kind(&self) -> &'static str {
        "cluster-lights"
    }

    fn files(&self) -> pass::Files {
        pass::files!()
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let lights = cx.fact("lights", virtual_lights::COUNT)?;
        let shader = cx.file("cluster-lights.wgsl");
        let step = |entry, threads| Compute::new(shader.clone(), entry, threads);
        let indirect = |offset| Threads::Indirect { buffer: "dispatches".into(), offset };
        let mut recording = Recording::one(step("seed", Threads::Row(lights.max(1))));
        for _ in 0..cx.settings.u32("iterations")? {
            recording = recording
                .then(step("assign", indirect(0)))
                .then(step("settle", Threads::Row(1)))
                .then(step("update", indirect(12)));
        }
        Ok(recording)
    }
}
