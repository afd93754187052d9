//! Samples of surfaces: what the module of a port `Points` returns.

use crate::{Harness, buffer};
use interfaces::points::{SurfaceSample, SurfaceSamples};
use pass::{Compute, Pass, PassTypeError, ReadSettings, RecordContext, Recording, Threads};
use scene::Scene;

/// Writes what the module of its input answers.
struct Probe;

impl Pass for Probe {
    fn kind(&self) -> &'static str {
        "points-probe"
    }

    fn folder(&self) -> String {
        "crates/pass-test/src".to_owned()
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let maps = cx.settings.u32("maps")?;
        let samples = SurfaceSamples::new(cx, maps, cx.settings.u32("per_map")?)?;
        let threads = Threads::Row(samples.of_maps(&(0..maps)).end);
        let shader = Compute::new(cx.file("points-probe.wgsl"), "points_probe", threads);
        Ok(Recording::one(samples.fill(shader, "wanted")))
    }
}

/// A port `Points` of a pass that has run.
#[derive(Clone, Debug)]
pub struct PointsPort {
    /// What its buffer holds.
    pub content: Vec<u8>,
    /// Its module.
    pub module: &'static str,
    /// How many maps take samples in turn at most.
    pub block: u32,
}

impl PointsPort {
    /// Returns the seed of the pass that generates the samples.
    pub fn seed() -> u32 {
        pass::pass_seed(0, "points-probe")
    }

    /// Returns the samples of all maps in the scene as it is at that time \[s\]: those of the maps that fill the last block
    /// included, whose area is 0. `None` where there is no adapter.
    pub fn samples(&self, scene: &Scene, time: f32, maps: u32, per_map: u32) -> Option<Vec<SurfaceSample>> {
        let turns = self.block.min(maps.next_power_of_two());
        Harness::new(&Probe)
            .with_scene(scene.clone())
            .time(time)
            .set("maps", maps)
            .set("per_map", per_map)
            .set("threads", maps.next_multiple_of(turns) * per_map)
            .input(
                "points",
                "Points",
                &[("count", u32::MAX), ("block", self.block)],
                vec![("", buffer(self.content.len() as u64), self.content.clone())],
            )
            .module(self.module)
            .run()
            .map(|outputs| outputs.read("samples"))
    }
}
