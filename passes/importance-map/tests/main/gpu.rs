//! The shaders against the CPU reference, on a GPU.

use crate::cpu_reference::{
    ViewSample, geometry, importance, luminance, pixel, response, view_response, weights,
};
use glam::{DVec3, Vec3};
use importance_map::PASS;
use interfaces::surface_points::{SurfacePoint, packed_albedo};
use pass::{Format, ResourceDesc, Value};
use pass_test::random::{halton3, hash2, unit_float};
use pass_test::{Harness, Outputs, RsmTexel, member};
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

    /// The samples of the view as points, which know albedo to ten bits.
    fn points(self) -> Vec<SurfacePoint> {
        let extent = self.scene().extent();
        let point = |sample: &ViewSample| {
            if sample.response == DVec3::ZERO {
                return SurfacePoint::NONE;
            }
            let albedo = sample.response * std::f64::consts::PI / DVec3::new(0.2126, 0.7152, 0.0722);
            SurfacePoint {
                position: (sample.position.as_vec3() * extent).to_array(),
                normal: sample.normal.as_vec3().to_array(),
                albedo: packed_albedo(albedo.to_array()),
                triangle: 0,
                ..SurfacePoint::default()
            }
        };
        self.samples().iter().map(point).collect()
    }

    /// Runs the pass with the values of its settings.
    fn run(self, set: &[(&str, Value)]) -> Option<Outputs> {
        self.harness(set).run()
    }

    fn harness(self, set: &[(&str, Value)]) -> Harness<'static> {
        let texel = |i| RsmTexel {
            position: self.position(i).extend(1.0).to_array(),
            normal: Room::normal(i).to_array(),
            flux: self.flux(i).extend(0.0).to_array(),
        };
        let texels: Vec<RsmTexel> = (0..self.texels()).map(texel).collect();
        let image = |name, of: &dyn Fn(u32) -> [f32; 4]| {
            let pixels: Vec<[f32; 4]> = (0..FRAME.0 * FRAME.1).map(of).collect();
            member(name, ResourceDesc::texture_2d(Format::Rgba32Float, FRAME), &pixels)
        };
        let view = vec![
            image("depth", &|i| [self.depth(i); 4]),
            image("normal", &|i| Room::normal(!i).extend(0.0).to_array()),
            image("albedo", &|i| Room::albedo(i).extend(1.0).to_array()),
        ];
        let by_flux = set.contains(&("measure", Value::from("flux")));
        let harness = Harness::new(PASS);
        let harness = set.iter().fold(harness, |harness, (name, value)| harness.set(name, value.clone()));
        let harness = harness
            .set("view_samples", SAMPLES)
            .seed(SEED)
            .frame(FRAME.0, FRAME.1)
            .with_scene(self.scene())
            .camera(self.camera())
            .rsm(self.size, &texels);
        if by_flux { harness } else { harness.input("view", "GBuffer", &[], view) }
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

    /// What each sample receives of the light of all texels. The room is convex and has the texels, so what is outside of it
    /// receives nothing.
    fn received(self) -> Vec<f64> {
        let extent = f64::from(self.scene().extent());
        let all: f64 = self.luminances().iter().sum();
        let of_texel = |sample: &ViewSample, i: u32| {
            let position = self.position(i).as_dvec3() / extent;
            let geometry = geometry(position, Room::normal(i).as_dvec3(), sample, f64::from(0.01_f32));
            self.flux(i).as_dvec3().dot(sample.response) * geometry
        };
        let of_sample = |sample: ViewSample| {
            let inside = (sample.position * extent / f64::from(self.scale)).to_array();
            if inside.iter().any(|x| !(0.0..=1.0).contains(x)) {
                return 0.0;
            }
            (0..self.texels()).map(|i| of_texel(&sample, i)).sum::<f64>() / all
        };
        self.samples().into_iter().map(of_sample).collect()
    }

    fn responses(self) -> Vec<DVec3> {
        let (samples, extent) = (self.samples(), f64::from(self.scene().extent()));
        let response = |i| {
            let (position, normal) = (self.position(i).as_dvec3() / extent, Room::normal(i).as_dvec3());
            view_response(position, normal, &samples, f64::from(0.01_f32))
        };
        (0..self.texels()).map(response).collect()
    }

    fn importance(self, defensive: f32) -> Vec<f64> {
        let responses = (0..).zip(self.responses());
        let of = |(i, response)| importance(self.flux(i).as_dvec3(), response, f64::from(defensive));
        responses.map(of).collect()
    }

    fn luminances(self) -> Vec<f64> {
        (0..self.texels()).map(|i| luminance(self.flux(i).as_dvec3())).collect()
    }
}

/// Asserts that they differ by 10⁻³ at most. Single precision knows places to 10⁻⁷ extents, so of the way between
/// a texel and a sample that are 10⁻² apart 10⁻⁵, and of its cosine with a surface that it nearly lies in less. Adapters
/// may take numbers below the least normal one for zero, in each of three channels.
fn assert_close(found: &[f32], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    let mean = expected.iter().sum::<f64>() / expected.len() as f64;
    for (i, (found, expected)) in std::iter::zip(found, expected).enumerate() {
        let error = (f64::from(*found) - expected).abs();
        assert!(
            found.is_finite() && error <= 1e-3 * expected + 1e-6 * mean + 3.0 * f64::from(f32::MIN_POSITIVE),
            "{i}: {found}, expected {expected}"
        );
    }
}

const ROOM: Room = Room { scale: 1.0, flux: 1.0, size: (20, 17), layers: 3, seen: true };

/// The importance of each texel, stored.
fn stored(room: Room, defensive: f32) -> Option<Vec<f32>> {
    let set = [("evaluate", Value::from("texels")), ("defensive", Value::F32(defensive))];
    Some(room.run(&set)?.read("importance.map"))
}

#[test]
fn importance_is_that_of_the_cpu_reference() {
    let rooms = [
        ROOM,
        Room { size: (33, 5), layers: 6, ..ROOM },
        Room { size: (1, 1), layers: 1, ..ROOM },
        Room { size: (272, 30), layers: 1, ..ROOM },
    ];
    for room in rooms {
        for defensive in [0.0, 0.2] {
            let Some(found) = stored(room, defensive) else { return };
            assert_close(&found, &room.importance(defensive));
        }
    }
}

/// Points where the pixels' samples are give what these give, whatever `view_samples` says, but for the rounding of their
/// albedo.
#[test]
fn samples_may_be_given() {
    for (evaluate, stored) in [("texels", "map"), ("on-demand", "samples")] {
        let set = [("evaluate", Value::from(evaluate)), ("defensive", Value::F32(0.0))];
        // The fourth element of a vector of three is nothing.
        let read = |outputs: Outputs| -> Vec<f32> {
            let all: Vec<f32> = outputs.read(&format!("importance.{stored}"));
            let is_number = |i: &usize| stored == "map" || i % 4 != 3;
            (0..all.len()).filter(is_number).map(|i| all[i]).collect()
        };
        let given = |points: &[SurfacePoint]| {
            let harness = ROOM.harness(&set).surface_points("points", 0, points);
            harness.set("view_samples", 3u32).run().map(read)
        };
        let (Some(expected), Some(found)) = (ROOM.run(&set).map(read), given(&ROOM.points())) else { return };
        assert_eq!(found.len(), expected.len(), "{evaluate}");
        let mean = expected.iter().map(|x| x.abs()).sum::<f32>() / expected.len() as f32;
        for (i, (found, expected)) in found.iter().zip(&expected).enumerate() {
            let error = (found - expected).abs();
            assert!(
                error < 1e-2 * expected.abs() + 1e-5 * mean,
                "{evaluate}, {i}: {found}, expected {expected}"
            );
        }
        let nothing = given(&[SurfacePoint::NONE; 5]).expect("the adapter is still there");
        assert!(nothing.iter().all(|x| *x == 0.0), "{evaluate}: points that are empty");
    }
}

#[test]
fn flux_is_its_luminance_and_needs_no_view() {
    let Some(outputs) = ROOM.run(&[("measure", Value::from("flux"))]) else { return };
    assert_close(&outputs.read("importance.map"), &ROOM.luminances());
}

#[test]
fn each_measure_refuses_where_it_is_not_evaluated() {
    for (measure, evaluate, why) in [
        ("contribution", "blocks", "blocks are for `reflectance`"),
        ("reflectance", "on-demand", "all texels are evaluated"),
    ] {
        let set = [("measure", Value::from(measure)), ("evaluate", Value::from(evaluate))];
        let Some(refused) = ROOM.harness(&set).refusal() else { return };
        assert!(refused.contains(why), "{refused}");
    }
}

#[test]
fn scenes_and_lights_of_any_scale() {
    for (scale, flux) in [(1e-3, 1e30), (1e6, 1e-30), (1.0, 1e33)] {
        let room = Room { scale, flux, ..ROOM };
        for defensive in [0.0, 0.005] {
            let Some(found) = stored(room, defensive) else { return };
            assert_close(&found, &room.importance(defensive));
        }
    }
}

#[test]
fn a_view_of_nothing_and_lights_that_reflect_nothing() {
    let blind = Room { seen: false, ..ROOM };
    let Some(found) = stored(blind, 0.05) else { return };
    let expected: Vec<f64> = blind.luminances().iter().map(|flux| f64::from(0.05_f32) * flux).collect();
    assert_close(&found, &expected);
    let dark = Room { flux: 0.0, ..ROOM };
    assert_eq!(stored(dark, 0.05), Some(vec![0.0; 1020]));
}

/// A change in one place changes nothing elsewhere: nothing is normalised by a sum.
#[test]
fn importance_is_local() {
    let other = Room { layers: 4, ..ROOM };
    let (Some(three), Some(four)) = (stored(ROOM, 0.05), stored(other, 0.05)) else { return };
    assert_eq!(three, four[..three.len()], "texels of a further layer are important too");
    assert!(four[three.len()..].iter().any(|f| *f > 0.0));
}

/// The responses of samples that are weighed by rays, of each three channels.
fn weighed(room: Room, rays: u32) -> Option<Vec<f32>> {
    let set = [("evaluate", Value::from("on-demand")), ("rays_per_sample", Value::U32(rays))];
    let samples: Vec<[f32; 12]> = room.run(&set)?.read("importance.samples");
    Some(samples.iter().flat_map(|sample| sample[8..11].to_vec()).collect())
}

fn expected_responses(room: Room) -> Vec<f64> {
    let samples = room.samples();
    let weights = weights(&samples, &room.received());
    std::iter::zip(samples, weights)
        .flat_map(|(sample, weight)| (sample.response * weight).to_array())
        .collect()
}

/// Where one texel alone is bright, each ray to it finds all that a sample receives.
#[test]
fn samples_count_by_what_they_receive() {
    for (scale, flux) in [(1.0, 1.0), (1e-3, 1e30), (1e4, 1e-30)] {
        let room = Room { scale, flux, size: (1, 1), layers: 2, ..ROOM };
        assert!(room.flux(0) == Vec3::ZERO, "the second texel alone is bright");
        let received = room.received();
        assert!(received.contains(&0.0) && received.iter().any(|x| *x > 0.0));
        let Some(found) = weighed(room, 32) else { return };
        assert_close(&found, &expected_responses(room));
    }
}

/// Rays to random texels find what all texels give.
#[test]
fn rays_estimate_what_a_sample_receives() {
    let Some([few, many]) = (|| Some([weighed(ROOM, 16)?, weighed(ROOM, 4096)?]))() else { return };
    let expected = expected_responses(ROOM);
    let error = |found: &[f32]| {
        let errors =
            std::iter::zip(found, &expected).map(|(found, expected)| (f64::from(*found) - expected).abs());
        errors.sum::<f64>() / expected.iter().sum::<f64>()
    };
    let [few, many] = [error(&few), error(&many)];
    assert!(many < 0.02 && few > 4.0 * many, "{few} of 16 rays, {many} of 4,096");
}

#[test]
fn samples_that_receive_nothing_count_alike() {
    let dark = Room { flux: 0.0, ..ROOM };
    let Some(found) = weighed(dark, 64) else { return };
    let expected: Vec<f64> = dark.samples().iter().flat_map(|sample| sample.response.to_array()).collect();
    assert_close(&found, &expected);
}
