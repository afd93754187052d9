//! A pass that answers with what the module of its input returns.

use interfaces::virtual_lights::VirtualLight;
use pass::{
    Compute, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording,
    ResourceDesc, SceneBindings, Setting, Settings, Threads, UseContext,
};
use pass_test::Harness;

const SHADER: &str = "passes/percentage-closer-soft-shadows/tests/main/probe.wgsl";

/// Asks for receivers, and writes answers.
struct Probe;

impl Pass for Probe {
    fn info(&self) -> Info {
        Info { kind: "probe", about: "", paper: "", shaders: &[SHADER] }
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        Ok(Vec::new())
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![
                pass::input("visibility", "Visibility", ""),
                pass::input("lights", "VirtualLights", ""),
                pass::input("receivers", "Buffer", ""),
            ],
            outputs: vec![pass::output("answers", "Buffer", "")],
            scene_bindings: SceneBindings::NONE,
        })
    }

    fn outputs(&self, _: &UseContext<'_>, cx: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        let bytes = cx.input("receivers").and_then(|input| input.member("")).map_or(32, ResourceDesc::bytes);
        Ok(vec![OutputDesc::one("answers", ResourceDesc::buffer(bytes / 8))])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let bytes = cx.port("answers").map_or(0, |port| port.members[0].1.bytes());
        let threads = Threads::Grid([(bytes / 4) as u32, 1, 1]);
        Ok(Recording::one(Compute::new(cx.shader(SHADER, &[]), "probe", threads)))
    }
}

/// A point that asks how visible a light is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Receiver {
    pub(crate) position: [f64; 3],
    pub(crate) normal: [f64; 3],
    pub(crate) light: u32,
}

/// The settings of the lookups.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lookups {
    pub(crate) module: &'static str,
    pub(crate) search: u32,
    pub(crate) taps: u32,
    pub(crate) nearest: f32,
}

/// Returns how visible its light is from each receiver; `maps` are the layers of the atlas, one map each. `None` where
/// there is no adapter.
pub(crate) fn answers(
    lookups: Lookups,
    tile: u32,
    maps: &[f32],
    lights: &[VirtualLight],
    receivers: &[Receiver],
) -> Option<Vec<f32>> {
    let given: Vec<[f32; 8]> = receivers
        .iter()
        .map(|receiver| {
            let ([x, y, z], [u, v, w]) =
                (receiver.position.map(|x| x as f32), receiver.normal.map(|x| x as f32));
            [x, y, z, f32::from_bits(receiver.light), u, v, w, 0.0]
        })
        .collect();
    let atlas = ResourceDesc::texture_2d_array(
        pass::Format::R32Float,
        (tile, tile),
        maps.len() as u32 / (tile * tile),
    );
    let facts =
        [("tile", tile), ("columns", 1), ("rows", 1), ("search", lookups.search), ("taps", lookups.taps)];
    let bytes = bytemuck::cast_slice(&given).to_vec();
    let outputs = Harness::new(&Probe)
        .input(
            "visibility",
            "Visibility",
            &facts,
            vec![("atlas", atlas, bytemuck::cast_slice(maps).to_vec())],
        )
        .fact("depth_bias", DEPTH_BIAS as f32)
        .fact("slope_bias", 0.0)
        .fact("nearest", lookups.nearest)
        .module(lookups.module)
        .lights(lights)
        .input("receivers", "Buffer", &[], vec![("", pass_test::buffer(bytes.len() as u64), bytes)])
        .run()?;
    Some(outputs.read("answers"))
}

/// The depth bias of all lookups.
pub(crate) const DEPTH_BIAS: f64 = 0.02;
