//! The shaders against the CPU reference, on a GPU.

use glam::{DVec3, Vec3};
use importance_map::PASS;
use importance_map::cpu_reference::{ViewSample, contribution, luminance, mix_with_flux, pixel, response};
use pass::{Format, ResourceDesc};
use pass_test::random::{halton3, hash2, unit_float};
use pass_test::{Harness, Outputs};
use scene::{Camera, Scene};

const FRAME: (u32, u32) = (40, 30);
const SAMPLES: u32 = 100;
const SEED: u32 = 3;

/// A reflective shadow map and a view of a room that is a cube of edge `scale`, filled at random.
#[derive(Clone, Copy)]
struct Room {
    scale: f32,
    flux: f32,
    size: (u32, u32),
    layers: u32,
    /// Whether the camera sees anything.
    seen: bool,
}

fn number(element: u32, dimension: u32) -> f32 {
    unit_float(hash2(element, dimension)) as f32
}

fn vector(element: u32, dimension: u32) -> Vec3 {
    Vec3::from([0, 1, 2].map(|c| number(element, dimension + c)))
}

impl Room {
    fn texels(self) -> u32 {
        self.size.0 * self.size.1 * self.layers
    }

    fn position(self, texel: u32) -> Vec3 {
        self.scale * vector(texel, 10)
    }

    fn normal(element: u32) -> Vec3 {
        (vector(element, 20) - 0.5).normalize()
    }

    fn flux(self, texel: u32) -> Vec3 {
        if texel.is_multiple_of(5) { Vec3::ZERO } else { self.flux * vector(texel, 30) }
    }

    fn depth(self, pixel: u32) -> f32 {
        if pixel.is_multiple_of(7) || !self.seen { 0.0 } else { self.scale * (0.1 + number(pixel, 40)) }
    }

    fn albedo(pixel: u32) -> Vec3 {
        vector(pixel, 50)
    }

    fn scene(self) -> Scene {
        let (edge, middle) = (self.scale, 0.5 * self.scale);
        pass_test::scene_from(&format!(
            "Scene(geometry: Objects([Object(name: \"room\", geometry: BuiltIn(\"cube\"), transform: Transform(\
             translate: ({middle:?}, {middle:?}, {middle:?}), scale: ({edge:?}, {edge:?}, {edge:?})))]))"
        ))
    }

    fn camera(self) -> Camera {
        let position = self.scale * Vec3::new(0.2, 0.3, 1.5);
        Camera {
            position,
            target: position + Vec3::NEG_Z,
            up: Vec3::Y,
            vertical_fov: 1.0,
            near: 0.01 * self.scale,
        }
    }

    fn run(self, measure: &str, defensive: f32) -> Option<Outputs> {
        let bytes = |count: u32, element: &dyn Fn(u32) -> [f32; 4]| -> Vec<u8> {
            (0..count).flat_map(|i| bytemuck::bytes_of(&element(i)).to_vec()).collect()
        };
        let array = || ResourceDesc::texture_2d_array(Format::Rgba32Float, self.size, self.layers);
        let texels = |element: &dyn Fn(u32) -> [f32; 4]| bytes(self.texels(), element);
        let rsm = vec![
            ("position", array(), texels(&|i| self.position(i).extend(1.0).to_array())),
            ("normal", array(), texels(&|i| Room::normal(i).extend(0.0).to_array())),
            ("flux", array(), texels(&|i| self.flux(i).extend(0.0).to_array())),
        ];
        let image = |format| ResourceDesc::texture_2d(format, FRAME);
        let pixels = FRAME.0 * FRAME.1;
        let depth: Vec<f32> = (0..pixels).map(|i| self.depth(i)).collect();
        let view = vec![
            ("depth", image(Format::R32Float), bytemuck::cast_slice(&depth).to_vec()),
            (
                "normal",
                image(Format::Rgba32Float),
                bytes(pixels, &|i| Room::normal(!i).extend(0.0).to_array()),
            ),
            (
                "albedo",
                image(Format::Rgba32Float),
                bytes(pixels, &|i| Room::albedo(i).extend(1.0).to_array()),
            ),
        ];
        let harness = Harness::new(PASS)
            .set("measure", measure)
            .set("defensive", defensive)
            .set("view_samples", SAMPLES)
            .seed(SEED)
            .frame(FRAME.0, FRAME.1)
            .with_scene(self.scene())
            .camera(self.camera())
            .input("rsm", "ReflectiveShadowMap", &[], rsm);
        if measure == "flux" { harness.run() } else { harness.input("view", "GBuffer", &[], view).run() }
    }

    fn samples(self) -> Vec<ViewSample> {
        let (camera, extent) = (self.camera(), f64::from(self.scene().extent()));
        let half_height = f64::tan(0.5 * f64::from(camera.vertical_fov));
        let sample = |k| {
            let numbers = halton3(k + 1, pass::pass_seed(SEED, "importance-map"));
            let (x, y) = pixel([numbers[0], numbers[1]], FRAME);
            let i = y * FRAME.0 + x;
            if self.depth(i) == 0.0 {
                return ViewSample::default();
            }
            let (width, height) = (f64::from(FRAME.0), f64::from(FRAME.1));
            let across = (2.0 * f64::from(x) + 1.0 - width) / height * half_height;
            let up = (height - 2.0 * f64::from(y) - 1.0) / height * half_height;
            let at = camera.position.as_dvec3() + DVec3::new(across, up, -1.0) * f64::from(self.depth(i));
            ViewSample {
                position: at / extent,
                normal: Room::normal(!i).as_dvec3(),
                response: response(Room::albedo(i).as_dvec3()),
            }
        };
        (0..SAMPLES).map(sample).collect()
    }

    fn contributions(self) -> Vec<f64> {
        let (samples, extent) = (self.samples(), f64::from(self.scene().extent()));
        (0..self.texels())
            .map(|i| {
                let position = self.position(i).as_dvec3() / extent;
                let (normal, flux) = (Room::normal(i).as_dvec3(), self.flux(i).as_dvec3());
                contribution(position, normal, flux, &samples, f64::from(0.01_f32))
            })
            .collect()
    }

    fn luminances(self) -> Vec<f64> {
        (0..self.texels()).map(|i| luminance(self.flux(i).as_dvec3())).collect()
    }
}

/// Asserts that they differ by 10⁻³ at most. Single precision knows places to 10⁻⁷ extents, so of the way between
/// a texel and a sample that are 10⁻² apart 10⁻⁵, and of its cosine with a surface that it nearly lies in less.
fn assert_close(found: &[f32], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    let mean = expected.iter().sum::<f64>() / expected.len() as f64;
    for (i, (found, expected)) in std::iter::zip(found, expected).enumerate() {
        let error = (f64::from(*found) - expected).abs();
        assert!(
            found.is_finite() && error <= 1e-3 * expected + 1e-6 * mean,
            "{i}: {found}, expected {expected}"
        );
    }
}

const ROOM: Room = Room { scale: 1.0, flux: 1.0, size: (20, 17), layers: 3, seen: true };

#[test]
fn contributions_are_those_of_the_cpu_reference() {
    for room in [ROOM, Room { size: (33, 5), layers: 1, ..ROOM }, Room { size: (1, 1), layers: 1, ..ROOM }] {
        let Some(outputs) = room.run("contribution", 0.0) else { return };
        assert_close(&outputs.read("importance"), &room.contributions());
    }
}

#[test]
fn mixtures_are_those_of_the_cpu_reference() {
    // The last has more workgroups than threads that add up their sums.
    for room in
        [ROOM, Room { size: (33, 5), layers: 6, ..ROOM }, Room { size: (272, 272), layers: 1, ..ROOM }]
    {
        let Some(outputs) = room.run("contribution", 0.2) else { return };
        let expected = mix_with_flux(&room.contributions(), &room.luminances(), f64::from(0.2_f32));
        assert_close(&outputs.read("importance"), &expected);
    }
}

#[test]
fn flux_is_its_luminance_and_needs_no_view() {
    let Some(outputs) = ROOM.run("flux", 0.05) else { return };
    assert_close(&outputs.read("importance"), &ROOM.luminances());
}

#[test]
fn scenes_and_lights_of_any_scale() {
    for (scale, flux) in [(1e-3, 1e30), (1e6, 1e-30), (1.0, 1e33)] {
        let room = Room { scale, flux, ..ROOM };
        let Some(outputs) = room.run("contribution", 0.0) else { return };
        assert_close(&outputs.read("importance"), &room.contributions());
        let Some(outputs) = room.run("contribution", 0.05) else { return };
        let expected = mix_with_flux(&room.contributions(), &room.luminances(), f64::from(0.05_f32));
        assert_close(&outputs.read("importance"), &expected);
    }
}

#[test]
fn a_view_of_nothing_and_lights_that_reflect_nothing() {
    let blind = Room { seen: false, ..ROOM };
    let Some(outputs) = blind.run("contribution", 0.05) else { return };
    assert_close(
        &outputs.read("importance"),
        &mix_with_flux(&[0.0; 1020], &blind.luminances(), f64::from(0.05_f32)),
    );
    let dark = Room { flux: 0.0, ..ROOM };
    let nothing = dark.run("contribution", 0.05).map(|outputs| outputs.read::<f32>("importance"));
    assert_eq!(nothing, Some(vec![0.0; 1020]));
}
