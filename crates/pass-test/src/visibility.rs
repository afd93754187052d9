//! Lookups of visibility: what the module of a port `Visibility` returns at receivers, and maps whose shadows are known.

use crate::{Harness, buffer};
use glam::{DVec2, DVec3, dvec2};
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

/// Returns the distances that a paraboloid map has of what `along` meets in a direction \[m\], row by row.
pub fn map_of(tile: u32, along: impl Fn(DVec3) -> Option<f64>) -> Vec<f64> {
    let centre = |i: u32| (f64::from(i) + 0.5) * 2.0 / f64::from(tile) - 1.0;
    let stored = |i: u32| {
        let at = dvec2(centre(i % tile), centre(i / tile));
        let r2 = at.length_squared();
        along((2.0 * at).extend(1.0 - r2) / (1.0 + r2)).unwrap_or(3.0e38)
    };
    (0..tile * tile).map(stored).collect()
}

/// Half of a plane that is parallel to the light's, at a height above it, below the floor at [`Edge::FLOOR`]: everything on
/// one side of an edge through the point `at`, to which `across` is perpendicular.
#[derive(Clone, Copy, Debug)]
pub struct Edge {
    /// Above the light's plane \[m\].
    pub height: f64,
    /// In the light's frame \[m\].
    pub at: DVec2,
    /// Unit, away from what is covered.
    pub across: DVec2,
}

impl Edge {
    /// The height of the floor above the light's plane \[m\].
    pub const FLOOR: f64 = 2.0;

    fn covers(&self, at: DVec2) -> bool {
        (at - self.at).dot(self.across) < 0.0
    }

    /// Returns the map of the light.
    pub fn map(&self, tile: u32) -> Vec<f64> {
        map_of(tile, |direction| {
            let z = (direction.z > 0.0).then_some(direction.z)?;
            let met = self.covers(direction.truncate() * (self.height / z));
            Some(if met { self.height / z } else { Self::FLOOR / z })
        })
    }

    /// Returns the part of a disc of that radius about the origin that rays from a point on the floor reach.
    pub fn by_rays(&self, radius: f64, receiver: DVec3) -> f64 {
        const RAYS: u32 = 4096;
        let reaches = |i: u32| {
            let (r, angle) = (((f64::from(i) + 0.5) / f64::from(RAYS)).sqrt(), f64::from(i) * 2.399_963);
            let on_light = radius * r * dvec2(angle.cos(), angle.sin());
            !self.covers(on_light.lerp(receiver.truncate(), self.height / Self::FLOOR))
        };
        f64::from((0..RAYS).filter(|i| reaches(*i)).count() as u32) / f64::from(RAYS)
    }
}

/// Returns the part of a unit disc on one side of a line at a distance from its centre.
pub fn segment(distance: f64) -> f64 {
    let d = distance.clamp(-1.0, 1.0);
    0.5 + (d * (1.0 - d * d).sqrt() + d.asin()) / std::f64::consts::PI
}

/// Returns `count` receivers on a hemisphere of the radius 2 about the origin, which face it, for `lights` lights in turn.
pub fn receivers_around(count: u32, lights: u32) -> Vec<Receiver> {
    let receiver = |i: u32| {
        let direction = direction(i);
        Receiver {
            position: (2.0 * direction).to_array(),
            normal: (-direction).to_array(),
            light: i % lights,
        }
    };
    (0..count).map(receiver).collect()
}

/// Returns one of a sequence of directions that spread over the hemisphere about z, but for 2 % at the horizon.
pub fn direction(i: u32) -> DVec3 {
    let [u, v] = [0.754_877, 0.569_840].map(|step: f64| (f64::from(i) * step).fract());
    let (z, angle) = (0.02 + 0.97 * u, std::f64::consts::TAU * v);
    (dvec2(angle.cos(), angle.sin()) * (1.0 - z * z).sqrt()).extend(z)
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
