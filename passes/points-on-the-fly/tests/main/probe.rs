//! What the pass writes, and the samples that it is amplified into.

use crate::cpu_reference::{BLOCK, Wanted};
use interfaces::points::SurfaceSample;
use pass_test::Outputs;
use pass_test::points::PointsPort;
use scene::Scene;

/// struct Amplification.
#[derive(Clone, Debug)]
pub(crate) struct Amplification {
    pub(crate) requested: u32,
    pub(crate) step: u64,
    pub(crate) starts: Vec<u32>,
    pub(crate) guide: Vec<u32>,
    port: PointsPort,
}

impl Amplification {
    pub(crate) fn read(outputs: &Outputs, triangles: usize) -> Amplification {
        let words: Vec<u32> = outputs.read("points");
        Amplification {
            requested: words[0],
            step: (u64::from(words[2]) << 32) | u64::from(words[3]),
            starts: words[4..triangles + 5].to_vec(),
            guide: words[triangles + 5..triangles + 6 + (1 << words[1])].to_vec(),
            port: PointsPort {
                content: bytemuck::cast_slice(&words).to_vec(),
                module: "shaders/points-on-the-fly.wgsl",
                block: BLOCK,
            },
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
        self.port.samples(scene, time, maps, per_map)
    }

    pub(crate) fn wanted(&self, maps: u32, per_map: u32) -> Wanted {
        Wanted::new(maps, per_map, self.requested)
    }
}
