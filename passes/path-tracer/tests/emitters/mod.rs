//! Light of surfaces that emit, which paths sample and meet: against closed forms and quadrature.

use crate::glossy::reflected;
use glam::Vec3;
use pass_test::rooms::{self, camera_at, floor_and_lamp, view_factor};
use pass_test::statistics::spread;
use pass_test::{Harness, Outputs};
use scene::{Encoding, Scene, Texture, Wrap};
use std::f64::consts::PI;

/// Looks at a point of the floor from `from`.
fn looking_at(scene: Scene, from: [f32; 3], at: [f32; 3]) -> Harness<'static> {
    Harness::new(path_tracer::PASS).with_scene(scene).camera(camera_at(from, at, 1e-3)).frame(32, 32)
}

/// Mean and its deviation of an output, over pixels that see the same point.
fn mean_of(outputs: &Outputs, name: &str) -> (f64, f64) {
    let pixels: Vec<[f32; 4]> = outputs.read(name);
    spread(pixels.iter().map(|pixel| pixel[0]))
}

fn assert_mean((mean, deviation): (f64, f64), expected: f64, most: f64, what: &str) {
    assert!(
        (mean - expected).abs() < 4.0 * deviation + 1e-5 * expected,
        "{what}: {mean} ± {deviation}, not {expected}"
    );
    assert!(deviation < most * expected, "{what}: ± {deviation} of {expected}");
}

/// Radiance ½ F of a floor that reflects ½ under a lamp that emits 1, with the view factor F. A path that meets the lamp by
/// chance does so with probability F, so its variance is ¼ F (1 - F).
#[test]
fn a_floor_reflects_the_view_factor_of_a_lamp() {
    for (height, side, less) in [(0.5, 0.05, 5000.0), (1.0, 0.4, 100.0), (0.1, 0.4, 0.9)] {
        for x in [0.0, 0.3] {
            let harness = looking_at(floor_and_lamp(height, side), [x + 0.3, 0.05, 0.0], [x, 0.0, 0.0]);
            let harness = harness.set("samples_per_frame", 1u32).set("bounces", 0u32);
            let Some(outputs) = harness.run() else { return };
            let half = f64::from(side) / 2.0;
            let along = [-half - f64::from(x), half - f64::from(x)];
            let factor = view_factor(f64::from(height), along, [-half, half]);
            let (mean, deviation) = mean_of(&outputs, "direct");
            let what = format!("height {height}, side {side}, {x}");
            assert_mean((mean, deviation), 0.5 * factor, 0.05, &what);
            // Of one sample: there are as many pixels.
            let variance = deviation * deviation * 1024.0;
            let by_chance = 0.25 * factor * (1.0 - factor);
            assert!(variance * less < by_chance, "{what}: variance {variance}, by chance {by_chance}");
        }
    }
}

/// A screen between lamp and floor takes all of its light; the lamp itself is as bright as before on both sides.
#[test]
fn a_lamp_is_seen_and_shaded() {
    for (screen, expected) in [(0.3_f32, 0.0), (0.9, 1.0)] {
        let quads = [
            rooms::quad([-1.0, 0.0, -1.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0], 0),
            rooms::quad([-0.2, 0.6, -0.2], [0.4, 0.0, 0.0], [0.0, 0.0, 0.4], 1),
            rooms::quad([-0.9, screen, -0.9], [1.8, 0.0, 0.0], [0.0, 0.0, 1.8], 2),
        ];
        let materials = [(0.5, 0.0), (0.0, 1.0), (0.0, 0.0)];
        let materials = materials.map(|(albedo, emitted)| rooms::matte([albedo; 3], [emitted; 3])).to_vec();
        let scene = rooms::room(&quads, materials);
        let run = |from: [f32; 3], at: [f32; 3]| looking_at(scene.clone(), from, at).run();
        let Some(floor) = run([0.3, 0.2, 0.0], [0.0; 3]) else { return };
        let factor = view_factor(0.6, [-0.2, 0.2], [-0.2, 0.2]);
        assert!((mean_of(&floor, "direct").0 - expected * 0.5 * factor).abs() < 0.01 * factor);
        let lamp = run([0.3, 0.5, 0.0], [0.0, 0.6, 0.0]).expect("the adapter is still there");
        assert_eq!(mean_of(&lamp, "image").0, 1.0);
    }
}

/// Indirect light of a floor under a lamp, on a wall beside it: against the floor's light by its view factors, patch by patch.
/// A clamp bounds the segment between the two, and the light of the lamp with it, but not the segment to the lamp.
#[test]
fn a_wall_sees_the_floor_that_a_lamp_lights() {
    // A small lamp, which paths sample, and one near the floor, which they meet as well.
    for (half, height) in [(0.025, 0.4), (0.2, 0.25)] {
        for clamp in [0.0, 0.2] {
            assert_that_the_wall_sees_the_floor(half, height, clamp);
        }
    }
}

fn assert_that_the_wall_sees_the_floor(half: f32, height: f32, clamp: f32) {
    let quads = [
        rooms::quad([0.0, 0.0, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], 0),
        rooms::quad([0.0, 0.0, -0.5], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], 1),
        rooms::quad([0.5 - half, height, -half], [2.0 * half, 0.0, 0.0], [0.0, 0.0, 2.0 * half], 2),
    ];
    let materials = vec![
        rooms::matte([0.6; 3], [0.0; 3]),
        rooms::matte([0.5; 3], [0.0; 3]),
        rooms::matte([0.0; 3], [1.0; 3]),
    ];
    let harness = looking_at(rooms::room(&quads, materials), [0.4, 0.2, 0.0], [0.0, 0.2, 0.0]);
    let harness = harness.set("bounces", 1u32).set("samples_per_frame", 64u32).set("clamp", clamp);
    let Some(outputs) = harness.run() else { return };
    // The extent of the scene is that of `plane`.
    let closest2 = f64::from(clamp * clamp) * 8.0;
    // ∫ ρ E(x) / π · cos cos / d² dA over the floor, with the irradiance E = π F of the lamp.
    let (steps, at, half) = (200, 0.2, f64::from(half));
    let step = 1.0 / f64::from(steps);
    let (mut irradiance, mut whole) = (0.0, 0.0);
    for i in 0..steps {
        for j in 0..steps {
            let (x, z) = ((f64::from(i) + 0.5) * step, (f64::from(j) + 0.5) * step - 0.5);
            let factor =
                view_factor(f64::from(height), [0.5 - half - x, 0.5 + half - x], [-half - z, half - z]);
            let distance2 = x * x + at * at + z * z;
            let arriving = 0.6 * factor * x * at / (distance2 * distance2) * step * step;
            whole += arriving;
            irradiance += arriving * if distance2 < closest2 { distance2 / closest2 } else { 1.0 };
        }
    }
    assert_mean(mean_of(&outputs, "irradiance"), irradiance, 0.02, "irradiance");
    assert_mean(mean_of(&outputs, "indirect"), irradiance * 0.5 / PI, 0.02, "indirect");
    let removed: Vec<[f32; 4]> = outputs.read("irradiance");
    let (mean, deviation) = spread(removed.iter().map(|pixel| pixel[3]));
    assert!(
        (mean - (whole - irradiance)).abs() <= 4.0 * deviation + 1e-5 * whole,
        "{mean} of {whole} - {irradiance}"
    );
    assert!(
        clamp == 0.0 || irradiance < 0.9 * whole,
        "the clamp does something here: {irradiance} of {whole}"
    );
}

/// A glossy plate under a small lamp, at its highlight and beside it.
#[test]
fn a_glossy_plate_reflects_a_lamp() {
    for (roughness, diffuse) in [(0.2_f32, 0.0), (0.5, 0.0), (0.5, 0.5), (1.0, 0.0)] {
        for (x, side) in [(0.5_f64, 0.1_f64), (0.1, 0.1), (0.5, 0.6)] {
            let mut scene = floor_and_lamp(0.5, side as f32);
            let plate = &mut scene.materials[0];
            plate.roughness = roughness;
            // All light is reflected by the facets, and as much diffusely as the base color says.
            plate.base_color = if diffuse > 0.0 { Vec3::splat(diffuse).extend(1.0) } else { glam::Vec4::ONE };
            plate.metallic = if diffuse > 0.0 { 0.0 } else { 1.0 };
            plate.specular = Vec3::ONE;
            // From the point, the camera stands at x, and the lamp at -x.
            let at = [x as f32 * 0.5, 0.0, 0.0];
            let harness = looking_at(scene, [at[0] + x as f32, 0.5, 0.0], at);
            let Some(outputs) = harness.set("bounces", 0u32).set("samples_per_frame", 64u32).run() else {
                return;
            };
            let length = x.hypot(0.5);
            let view = [x / length, 0.0, 0.5 / length];
            let (steps, alpha) = (300, f64::from(roughness * roughness));
            let step = side / f64::from(steps);
            let mut expected = 0.0;
            for i in 0..steps {
                for j in 0..steps {
                    let place = |i: i32| (f64::from(i) + 0.5) * step - side / 2.0;
                    let (dx, dz) = (place(i) - 0.5 * x, place(j));
                    let distance = (dx * dx + dz * dz + 0.25).sqrt();
                    let light = [dx / distance, dz / distance, 0.5 / distance];
                    let scattered = f64::from(diffuse) / PI * light[2] + reflected(alpha, view, light);
                    expected += scattered * light[2] / (distance * distance) * step * step;
                }
            }
            let what = format!("roughness {roughness}, diffuse {diffuse}, lamp of {side} at {x}");
            let (mean, deviation) = mean_of(&outputs, "direct");
            // The quadrature's own error is below a thousandth.
            assert_mean((mean, deviation + 2.5e-4 * expected), expected, 0.02, &what);
        }
    }
}

/// A lamp whose texture is white on one half lights as that half alone.
#[test]
fn emission_follows_its_texture() {
    for dark in [0, 1] {
        let mut scene = floor_and_lamp(0.5, 0.4);
        let width = 512;
        let texel = |i: u32| if i / (width / 2) == dark { [0, 0, 0, 255] } else { [255; 4] };
        scene.textures.push(Texture {
            name: String::new(),
            width,
            height: 1,
            pixels: (0..width).flat_map(texel).collect(),
            encoding: Encoding::Srgb,
            wrap: [Wrap::Repeat; 2],
        });
        scene.materials[1].emission_texture = Some(0);
        for (vertex, u) in scene.vertices[4..].iter_mut().zip([0.0, 1.0, 1.0, 0.0]) {
            vertex.uv = [u, 0.5];
        }
        let harness = looking_at(scene, [0.6, 0.2, 0.0], [0.3, 0.0, 0.0]);
        let Some(outputs) = harness.set("samples_per_frame", 16u32).run() else { return };
        let along = if dark == 0 { [-0.3, -0.1] } else { [-0.5, -0.3] };
        let expected = 0.5 * view_factor(0.5, along, [-0.2, 0.2]);
        let (mean, deviation) = mean_of(&outputs, "direct");
        // A texel on either side of an edge is neither white nor black.
        assert_mean((mean, deviation + 5e-4 * expected), expected, 0.01, &format!("{dark}"));
    }
}

/// Alpha cuts holes into lamps too.
#[test]
fn what_a_mask_cuts_out_of_a_lamp_does_not_shine() {
    let mut scene = floor_and_lamp(0.5, 0.4);
    scene.materials[1].alpha_cutoff = Some(0.5);
    scene.materials[1].base_color.w = 0.25;
    let Some(outputs) = looking_at(scene, [0.3, 0.2, 0.0], [0.0; 3]).run() else { return };
    assert_eq!(mean_of(&outputs, "direct"), (0.0, 0.0));
}

/// A lamp that moved from where its table was made lights as one that has always been there.
#[test]
fn a_lamp_that_moves_takes_its_light_along() {
    let moving = || {
        let mut scene = pass_test::scene("cornell-box-cloth");
        scene.lights[0].intensity = Vec3::ZERO;
        let cloth = scene.instances.iter().find(|instance| instance.moves).expect("the cloth moves").clone();
        let range = cloth.first_vertex as usize..(cloth.first_vertex + cloth.vertex_count) as usize;
        let material = scene.vertices[range.start].material as usize;
        scene.materials[material].emission = Vec3::ONE;
        (scene, range)
    };
    let time = 0.7;
    let (mut resting, range) = moving();
    // At rest it is half as long and as wide, and elsewhere.
    for vertex in &mut resting.vertices[range] {
        vertex.position = vertex.position.map(|x| 0.5 * x + 0.1);
    }
    let (mut still, _) = moving();
    for moved in still.at(time).moved {
        let first = moved.first_vertex as usize;
        still.vertices[first..first + moved.vertices.len()].copy_from_slice(&moved.vertices);
    }
    let run = |scene: Scene| {
        let harness = Harness::new(path_tracer::PASS).with_scene(scene).time(time).frame(24, 24);
        let outputs = harness.set("bounces", 0u32).set("samples_per_frame", 64u32).run()?;
        Some(outputs.read::<[f32; 4]>("direct"))
    };
    let (Some(moved), Some(still)) = (run(resting), run(still)) else { return };
    let luminances = |pixels: &[[f32; 4]]| pixels.iter().map(|pixel| f64::from(pixel[1])).sum::<f64>();
    let ratio = luminances(&moved) / luminances(&still);
    assert!((ratio - 1.0).abs() < 0.01, "{ratio} times the light");
}

/// A lamp in the plane of the floor, one that touches it, one without area, and a camera on a lamp; however bright.
#[test]
fn extremes_stay_finite() {
    let lamps = [
        ([-0.1, 0.0, -0.1], [0.2, 0.0, 0.0], [0.0, 0.0, 0.2]),
        ([0.0, 0.0, -0.1], [0.0, 0.2, 0.0], [0.0, 0.0, 0.2]),
        ([0.0, 0.3, 0.0], [0.2, 0.0, 0.0], [0.1, 0.0, 0.0]),
        ([0.0, 1e-7, 0.0], [1e-3, 0.0, 0.0], [0.0, 0.0, 1e-3]),
    ];
    for emission in [1e-37, 1.0, 1e37] {
        for (i, (corner, a, b)) in lamps.into_iter().enumerate() {
            for roughness in [1.0, 0.0] {
                let floor = rooms::quad([-1.0, 0.0, -1.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0], 0);
                let mut shining = rooms::matte([0.5; 3], [1.0; 3]);
                shining.emission = Vec3::splat(emission);
                let quads = [floor, rooms::quad(corner, a, b, 1)];
                let mut scene = rooms::room(&quads, vec![rooms::matte([0.5; 3], [0.0; 3]), shining]);
                scene.materials.iter_mut().for_each(|material| material.roughness = roughness);
                let camera = camera_at([0.2, 0.3, 0.1], [0.0; 3], 0.8);
                let harness = Harness::new(path_tracer::PASS).with_scene(scene).camera(camera).frame(16, 16);
                let Some(outputs) = harness.set("samples_per_frame", 2u32).set("clamp", 0.1f32).run() else {
                    return;
                };
                for name in ["image", "direct", "indirect", "irradiance"] {
                    let pixels: Vec<[f32; 4]> = outputs.read(name);
                    let what = format!("{name} of lamp {i}, emission {emission}, roughness {roughness}");
                    assert!(pixels.iter().flatten().all(|x| x.is_finite() && *x >= 0.0), "{what}");
                }
                // A lamp in the floor lights neither itself nor the floor.
                if i == 0 && roughness == 1.0 {
                    let direct: Vec<[f32; 4]> = outputs.read("direct");
                    assert!(direct.iter().all(|pixel| pixel[0] <= 1e-5 * emission), "emission {emission}");
                }
            }
        }
    }
}
