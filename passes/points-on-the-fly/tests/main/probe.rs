//! A pass that writes what the module of a port Points answers.

use crate::cpu_reference::{BLOCK, Wanted};
use interfaces::points::{SurfaceSample, SurfaceSamples};
use pass::{Compute, Pass, PassTypeError, ReadSettings, RecordContext, Recording, Threads};
use pass_test::{Harness, Outputs};
use scene::Scene;

struct Probe;

impl Pass for Probe {
    fn kind(&self) -> &'static str {
        "probe"
    }

    fn folder(&self) -> String {
        "passes/points-on-the-fly/tests/main".to_owned()
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let maps = cx.settings.u32("maps")?;
        let samples = SurfaceSamples::new(cx, maps, cx.settings.u32("per_map")?)?;
        let threads = Threads::Row(samples.of_maps(&(0..maps)).end);
        Ok(Recording::one(samples.fill(Compute::new(cx.file("probe.wgsl"), "probe", threads), "wanted")))
    }
}

/// struct Amplification.
#[derive(Clone, Debug)]
pub(crate) struct Amplification {
    pub(crate) requested: u32,
    pub(crate) step: u64,
    pub(crate) starts: Vec<u32>,
    pub(crate) guide: Vec<u32>,
    bytes: Vec<u8>,
}

impl Amplification {
    pub(crate) fn read(outputs: &Outputs, triangles: usize) -> Amplification {
        let words: Vec<u32> = outputs.read("points");
        Amplification {
            requested: words[0],
            step: (u64::from(words[2]) << 32) | u64::from(words[3]),
            starts: words[4..triangles + 5].to_vec(),
            guide: words[triangles + 5..triangles + 6 + (1 << words[1])].to_vec(),
            bytes: bytemuck::cast_slice(&words).to_vec(),
        }
    }

    /// The samples that it is amplified into.
    pub(crate) fn samples(
        &self,
        scene: &Scene,
        time: f32,
        maps: u32,
        per_map: u32,
    ) -> Option<Vec<SurfaceSample>> {
        let desc = pass_test::buffer(self.bytes.len() as u64);
        let harness = Harness::new(&Probe)
            .with_scene(scene.clone())
            .time(time)
            .set("maps", maps)
            .set("per_map", per_map)
            .set("threads", self.wanted(maps, per_map).threads())
            .input(
                "points",
                "Points",
                &[("count", u32::MAX), ("block", BLOCK)],
                vec![("", desc, self.bytes.clone())],
            )
            .module("shaders/points-on-the-fly.wgsl");
        Some(harness.run()?.read("samples"))
    }

    pub(crate) fn wanted(&self, maps: u32, per_map: u32) -> Wanted {
        Wanted::new(maps, per_map, self.requested)
    }
}
