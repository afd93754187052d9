//! Lights that stay: cells against brute force, fluxes against closed forms, and what frames keep and replace.

mod cells;
mod choices;
mod extremes;
mod flux;
mod frames;
mod motion;

use glam::{DVec3, Vec3};
use interfaces::surface_points::{self, SurfacePoint, SurfacePointsHeader};
use interfaces::virtual_lights::VirtualLight;
use pass_test::rooms::furnace;
use pass_test::{Harness, Outputs, elements};
use sample_incremental::PASS;
use scene::{Light, LightKind, Scene};

pass_test::shaders_are_valid!(PASS);

/// Settings of the pass.
#[derive(Clone, Copy, Debug)]
struct Sampling {
    count: u32,
    moved: u32,
    probes: u32,
}

/// The results of a frame.
#[derive(Clone, Debug, PartialEq)]
struct Frame {
    header: SurfacePointsHeader,
    points: Vec<SurfacePoint>,
    lights: Vec<VirtualLight>,
    /// Source, first slot, end, and the bits of weight and density.
    shares: Vec<[u32; 5]>,
    /// Place, and state.
    sites: Vec<[u32; 4]>,
    /// Place, and squared distance.
    probes: Vec<[f32; 4]>,
    owners: Vec<u32>,
    /// Probes, and what the source gives to them.
    cells: Vec<[u32; 2]>,
}

impl Sampling {
    fn of(count: u32, moved: u32) -> Sampling {
        Sampling { count, moved, probes: 64 }
    }

    fn harness(self, scene: &Scene) -> Harness<'static> {
        Harness::new(PASS)
            .with_scene(scene.clone())
            .set("count", self.count)
            .set("moved", self.moved)
            .set("probes", self.probes)
    }

    /// Runs a frame after one that left these points; `None` without an adapter.
    fn frame(self, scene: &Scene, past: Option<&[SurfacePoint]>) -> Option<Frame> {
        let mut harness = self.harness(scene);
        if let Some(points) = past {
            let members = elements(&surface_points::to_bytes(7, points));
            harness = harness.past("past", "SurfacePoints", 1, members).fact("count", points.len() as u32);
        }
        Some(Frame::of(&harness.run()?))
    }

    /// Runs this many frames after one another; the first is a start.
    fn frames(self, scene: &Scene, count: u32) -> Option<Frame> {
        let outputs = self.harness(scene).feedback("past", "points").frames(count).run()?;
        Some(Frame::of(&outputs))
    }

    /// Runs frames of which the last places no light any more.
    fn at_rest(self, scene: &Scene, frames: u32) -> Option<Frame> {
        let frame = self.frames(scene, frames)?;
        assert_eq!(frame.header.marked, 0, "lights are still placed in frame {frames}");
        Some(frame)
    }
}

/// A slot that is dark until it gets a place.
const WAITING: u32 = 1;

impl Frame {
    fn of(outputs: &Outputs) -> Frame {
        let (header, points) = outputs.surface_points("points");
        Frame {
            header,
            points,
            lights: outputs.lights("lights"),
            shares: outputs.read("shares"),
            sites: outputs.read("sites"),
            probes: outputs.read("probes"),
            owners: outputs.read("owners"),
            cells: outputs.read("cells"),
        }
    }

    fn place(&self, slot: usize) -> DVec3 {
        let [x, y, z, _] = self.sites[slot].map(|bits| f64::from(f32::from_bits(bits)));
        DVec3::new(x, y, z)
    }

    fn waiting(&self) -> usize {
        self.sites.iter().filter(|site| site[3] == WAITING).count()
    }

    /// The slots whose points differ.
    fn changed(&self, before: &[SurfacePoint]) -> Vec<usize> {
        let unmarked = |point: &SurfacePoint| SurfacePoint { mark: 0, ..*point };
        (0..self.points.len()).filter(|i| unmarked(&self.points[*i]) != unmarked(&before[*i])).collect()
    }

    fn flux(&self, channel: usize) -> f64 {
        self.lights.iter().map(|light| f64::from(light.flux[channel])).sum()
    }
}

fn assert_finite(lights: &[VirtualLight]) {
    for light in lights {
        let numbers = [&light.position[..], &light.normal[..], &light.flux[..], &[light.area]].concat();
        assert!(numbers.iter().all(|x| x.is_finite()), "{light:?}");
        assert!(light.flux.iter().chain([&light.area]).all(|x| *x >= 0.0), "{light:?}");
        assert!((Vec3::from(light.normal).length() - 1.0).abs() < 1e-3, "{light:?}");
    }
}

fn light(kind: LightKind, position: [f32; 3], direction: [f32; 3], intensity: [f32; 3]) -> Light {
    Light {
        name: String::new(),
        kind,
        position: position.into(),
        direction: Vec3::from(direction).normalize(),
        intensity: intensity.into(),
    }
}

fn point_at(position: [f32; 3], intensity: [f32; 3]) -> Light {
    light(LightKind::Point, position, [0.0, 0.0, -1.0], intensity)
}

/// The surfaces of a scene with these lights.
fn lit(surfaces: Scene, lights: Vec<Light>) -> Scene {
    let any = "Point(position: (0.0, 0.0, 0.0), intensity: (1.0, 1.0, 1.0)),".repeat(lights.len());
    let mut scene = pass_test::scene_from(&format!(
        r#"Scene(
            geometry: BuiltIn("empty"),
            camera: Camera(position: (0.0, 1.0, 2.0), target: (0.0, 0.0, 0.0), vertical_fov_deg: 40),
            lights: [{any}],
        )"#
    ));
    (scene.vertices, scene.indices) = (surfaces.vertices, surfaces.indices);
    (scene.materials, scene.instances) = (surfaces.materials, surfaces.instances);
    scene.lights = lights;
    scene
}

/// A closed cube of 2 m with this reflectance and these lights.
fn room(albedo: [f64; 3], lights: Vec<Light>) -> Scene {
    lit(furnace([0.0; 3], albedo), lights)
}

/// A lamp in a closed cube.
fn lamp_at(position: [f32; 3]) -> Scene {
    room([0.5; 3], vec![point_at(position, [1.0; 3])])
}
