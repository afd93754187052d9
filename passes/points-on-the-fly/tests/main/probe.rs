//! A pass that writes what the module of a port Points answers.

use interfaces::points::{SurfaceSample, SurfaceSamples};
use pass::{
    Compute, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording,
    ResourceDesc, SceneBindings, Setting, Settings, Threads, UseContext,
};
use pass_test::{Harness, Outputs};
use points_on_the_fly::BLOCK;
use points_on_the_fly::cpu_reference::Wanted;
use scene::Scene;

pass::settings! {
    struct ProbeSettings {
        maps: u32 = 1;
        per_map: u32 = 1;
    }
}

struct Probe;

const SHADER: &str = "passes/points-on-the-fly/tests/main/probe.wgsl";

impl Pass for Probe {
    fn info(&self) -> Info {
        Info { kind: "probe", about: "", paper: "", shaders: &[SHADER] }
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        Ok(ProbeSettings::schema())
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![pass::input("points", "Points", "")],
            outputs: vec![pass::output("samples", "Samples", "")],
            scene_bindings: SceneBindings::SCENE,
        })
    }

    fn outputs(&self, _: &UseContext<'_>, cx: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        let threads = wanted(cx.settings).threads();
        Ok(vec![OutputDesc::one("samples", ResourceDesc::buffer(32 * u64::from(threads)))])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let settings = ProbeSettings::read(cx.settings);
        let samples = SurfaceSamples::new(cx, settings.maps, settings.per_map)?;
        let probe = Compute::new(
            cx.shader(SHADER, &[]),
            "probe",
            Threads::Row(samples.of_maps(&(0..settings.maps)).end),
        );
        Ok(Recording::one(samples.fill(probe, "samples")))
    }
}

fn wanted(settings: &Settings) -> Wanted {
    let ProbeSettings { maps, per_map } = ProbeSettings::read(settings);
    Wanted::new(maps, per_map, u32::MAX)
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
