//! Lookups of visibility: what the module of a port `Visibility` returns at receivers.

use crate::{Harness, buffer};
use interfaces::virtual_lights::VirtualLight;
use pass::{
    Compute, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording,
    ResourceDesc, SceneBindings, Setting, Settings, Threads, UseContext,
};

const SHADER: &str = "crates/pass-test/src/visibility-probe.wgsl";

/// A point that looks a light up.
#[derive(Clone, Copy, Debug)]
pub struct Receiver {
    /// World space \[m\].
    pub position: [f64; 3],
    /// Unit.
    pub normal: [f64; 3],
    /// Index of the light.
    pub light: u32,
}

/// Creates the harness of a pass that reads a port `Visibility`, and writes to its output `answers` what the module of
/// that port returns for each receiver (f32). The caller adds the input `visibility`, last of all inputs.
pub fn lookups(lights: &[VirtualLight], receivers: &[Receiver]) -> Harness<'static> {
    let given: Vec<[f32; 8]> = receivers
        .iter()
        .map(|receiver| {
            let ([x, y, z], [u, v, w]) =
                (receiver.position.map(|x| x as f32), receiver.normal.map(|x| x as f32));
            [x, y, z, f32::from_bits(receiver.light), u, v, w, 0.0]
        })
        .collect();
    let bytes: Vec<u8> = bytemuck::cast_slice(&given).to_vec();
    let receivers = vec![("", buffer(bytes.len() as u64), bytes)];
    Harness::new(&Probe).lights(lights).input("receivers", "Buffer", &[], receivers)
}

/// Returns an atlas with one map a layer, of `tile` × `tile` distances \[m\] each: the member `atlas` of an input
/// `Visibility`.
pub fn atlas(tile: u32, maps: &[f32]) -> (&'static str, ResourceDesc, Vec<u8>) {
    let layers = maps.len() as u32 / (tile * tile);
    let desc = ResourceDesc::texture_2d_array(pass::Format::R32Float, (tile, tile), layers);
    ("atlas", desc, bytemuck::cast_slice(maps).to_vec())
}

struct Probe;

impl Pass for Probe {
    fn info(&self) -> Info {
        Info { kind: "visibility-probe", about: "", paper: "", shaders: &[SHADER] }
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
