//! Photons against closed forms.

use glam::Vec3;
use interfaces::surface_points::SurfacePoint;
use interfaces::virtual_lights::VirtualLight;
use pass_test::rooms::furnace;
use pass_test::{Harness, scene};
use scene::{LightKind, Scene};
use std::f64::consts::PI;
use trace_photons::PASS;

pass_test::shaders_are_valid!(PASS);

fn lights(scene: &Scene, count: u32, bounces: u32) -> Option<Vec<VirtualLight>> {
    let harness = Harness::new(PASS).with_scene(scene.clone()).set("count", count).set("bounces", bounces);
    Some(harness.run()?.lights("lights"))
}

/// Sums of flux, by bounce.
fn fluxes(lights: &[VirtualLight], bounces: usize, channel: usize) -> Vec<f64> {
    let mut sums = vec![0.0; bounces];
    for (i, light) in lights.iter().enumerate() {
        sums[i % bounces] += f64::from(light.flux[channel]);
    }
    sums
}

/// In a closed room nothing is lost but by reflection, so bounce b has the power of the lights times ρᵇ.
#[test]
fn a_closed_room_keeps_all_power_but_what_it_absorbs() {
    let albedo = [0.2, 0.5, 0.8];
    let mut scene = pass_test::scene_from(
        r#"Scene(
            geometry: BuiltIn("plane"),
            camera: Camera(position: (0.0, 1.0, 2.0), target: (0.0, 0.0, 0.0), vertical_fov_deg: 40),
            lights: [
                Point(position: (0.2, -0.3, 0.1), intensity: (1.0, 2.0, 3.0)),
                Spot(position: (-0.5, 0.1, 0.0), direction: (0.0, -1.0, 0.0), intensity: (5.0, 5.0, 5.0), outer_deg: 40, inner_deg: 40),
            ],
        )"#,
    );
    let room = furnace([0.0; 3], albedo);
    (scene.vertices, scene.indices) = (room.vertices, room.indices);
    (scene.materials, scene.instances) = (room.materials, room.instances);
    let Some(found) = lights(&scene, 3001, 3) else { return };
    assert_eq!(found.len(), 3001);
    for c in 0..3 {
        let power = 4.0 * PI * [1.0, 2.0, 3.0][c] + 2.0 * PI * (1.0 - 40.0_f64.to_radians().cos()) * 5.0;
        for (b, sum) in fluxes(&found[..3000], 3, c).into_iter().enumerate() {
            let expected = power * albedo[c].powi(b as i32 + 1);
            // One path of a thousand may be of the other light: shares are rounded to whole paths.
            assert!((sum / expected - 1.0).abs() < 2e-3, "bounce {b}, channel {c}: {sum}, not {expected}");
        }
    }
    // All of them lie on the walls and face inwards.
    for light in &found[..3000] {
        let at = Vec3::from(light.position);
        assert!((at.abs().max_element() - 1.0).abs() < 1e-5, "{at}");
        assert!(at.dot(Vec3::from(light.normal)) < 0.0);
    }
    assert_eq!(found[3000].flux, [0.0; 3]);
}

/// A closed room about a lamp at its middle, half a metre wide. All reflect alike.
fn room_with_lamp(albedo: [f64; 3], emission: [f64; 3]) -> Scene {
    let mut scene = furnace([0.0; 3], albedo);
    let first = scene.vertices.len() as u32;
    let mut lamp = scene.materials[0].clone();
    lamp.emission = Vec3::from(emission.map(|x| x as f32));
    scene.materials.push(lamp);
    for (x, z) in [(-0.25, -0.25), (0.25, -0.25), (0.25, 0.25), (-0.25, 0.25)] {
        let (material, normal) = (1, [0.0, 1.0, 0.0]);
        let uv = [x * 2.0 + 0.5, 0.5];
        scene.vertices.push(scene::Vertex {
            position: [x, 0.0, z],
            material,
            normal,
            uv,
            ..scene.vertices[0]
        });
    }
    scene.indices.extend([0, 1, 2, 0, 2, 3].map(|i| first + i));
    scene.instances[0].vertex_count += 4;
    scene.instances[0].index_count += 6;
    scene
}

/// A lamp gives 2 π times its radiance and its area to a closed room, as much on either side, and bounce b has ρᵇ of it.
#[test]
fn a_lamp_gives_its_power_on_both_sides() {
    let (albedo, emission) = ([0.2, 0.5, 0.8], [3.0, 1.0, 2.0]);
    let scene = room_with_lamp(albedo, emission);
    let Some(found) = lights(&scene, 3072, 3) else { return };
    for c in 0..3 {
        let power = 2.0 * PI * 0.25 * emission[c];
        for (b, sum) in fluxes(&found, 3, c).into_iter().enumerate() {
            let expected = power * albedo[c].powi(b as i32 + 1);
            assert!((sum / expected - 1.0).abs() < 1e-4, "bounce {b}, channel {c}: {sum}, not {expected}");
        }
    }
    let first = || found.iter().step_by(3);
    assert_eq!(first().filter(|light| light.position[1] > 0.0).count(), 512, "half of them upwards");
    // What the cosine and the place of the lamp make of it: the share of the ceiling is its view factor from the lamp.
    let (steps, side) = (100, 0.5);
    let place = |i: i32| ((f64::from(i) + 0.5) / f64::from(steps) - 0.5) * side;
    let factors = (0..steps * steps).map(|i| {
        let (x, z) = (place(i / steps), place(i % steps));
        pass_test::rooms::view_factor(1.0, [-1.0 - x, 1.0 - x], [-1.0 - z, 1.0 - z])
    });
    let factor = factors.sum::<f64>() / f64::from(steps * steps);
    let up = first().filter(|light| light.position[1] > 1.0 - 1e-4).count() as f64 / 512.0;
    assert!((up - factor).abs() < 0.03, "{up} of the photons above, not {factor}");
}

/// A texture changes how much each photon carries, and lights of either kind get paths by their power.
#[test]
fn emission_by_texture_and_other_lights_add_up() {
    let mut scene = room_with_lamp([0.5; 3], [4.0; 3]);
    let texel = |i: u32| if i < 128 { [0, 0, 0, 255] } else { [255; 4] };
    scene.textures.push(scene::Texture {
        name: String::new(),
        width: 256,
        height: 1,
        pixels: (0..256).flat_map(texel).collect(),
        encoding: scene::Encoding::Srgb,
        wrap: [scene::Wrap::Repeat; 2],
    });
    scene.materials[1].emission_texture = Some(0);
    scene.lights[0].kind = LightKind::Point;
    scene.lights[0].position = Vec3::new(0.3, 0.4, -0.2);
    scene.lights[0].intensity = Vec3::splat(0.5);
    let Some(found) = lights(&scene, 4096, 1) else { return };
    let power = 2.0 * PI * 0.25 * 2.0 + 4.0 * PI * 0.5;
    let sum = fluxes(&found, 1, 0)[0];
    assert!((sum / (0.5 * power) - 1.0).abs() < 0.01, "{sum}, not half of {power}");
    // Of a third of the paths, those of the lamp, a half begin in the dark.
    let dark = found.iter().filter(|light| light.flux[0] == 0.0).count() as f64 / 4096.0;
    assert!((dark - 1.0 / 6.0).abs() < 0.02, "{dark}");
}

/// However bright a lamp is, and beside whatever else.
#[test]
fn extreme_emission_stays_finite() {
    for emission in [1e-38, 1e37, 3e38] {
        let mut scene = room_with_lamp([0.5; 3], [emission; 3]);
        scene.lights[0].intensity = Vec3::splat(1e38);
        let Some(found) = lights(&scene, 300, 3) else { return };
        assert!(found.iter().flat_map(|light| light.flux).all(f32::is_finite), "{emission}");
        scene.lights.clear();
        let found = lights(&scene, 3000, 3).expect("the adapter is still there");
        let power = 2.0 * PI * 0.25 * f64::from(emission as f32);
        let ratio = fluxes(&found, 3, 0)[0] / (0.5 * power);
        assert!(emission < 1e-37 || (ratio - 1.0).abs() < 1e-3, "{emission}: {ratio} of the power");
    }
}

/// A spot above a plane: what falls on it is the intensity over the cone, with its falloff; nothing comes back.
#[test]
fn a_spot_gives_what_its_cone_holds() {
    let mut scene = scene("plane");
    let (inner, outer) = (0.2_f32, 0.6_f32);
    scene.lights[0].kind = LightKind::Spot { inner, outer };
    let intensity = f64::from(scene.lights[0].intensity.x);
    let Some(found) = lights(&scene, 4096, 1) else { return };
    let (inner, outer) = (f64::from(inner.cos()), f64::from(outer.cos()));
    // The falloff is the square of a ramp in the cosine.
    let solid_angle = 2.0 * PI * ((1.0 - inner) + (inner - outer) / 3.0);
    let sum = fluxes(&found, 1, 0)[0];
    let expected = 0.5 * intensity * solid_angle;
    assert!((sum / expected - 1.0).abs() < 2e-3, "{sum}, not {expected}");
    let Some(again) = lights(&scene, 4096, 2) else { return };
    assert_eq!(fluxes(&again, 2, 0)[1], 0.0, "a plane alone sees nothing of itself");
}

/// A sun gives each square metre across it the same, wherever it begins.
#[test]
fn a_sun_gives_the_plane_its_irradiance() {
    let mut scene = scene("plane");
    scene.lights[0].kind = LightKind::Directional;
    scene.lights[0].direction = Vec3::new(0.6, -0.8, 0.0);
    scene.lights[0].intensity = Vec3::splat(3.0);
    let Some(found) = lights(&scene, 8192, 1) else { return };
    let sum = fluxes(&found, 1, 1)[0];
    // Irradiance 3 W/m², cosine 0.8, 4 m², albedo ½.
    assert!((sum / 4.8 - 1.0).abs() < 0.02, "{sum}");
}

/// Each iteration has other photons, of the same flux; their places as points are those of the lights, and each has its own seed.
#[test]
fn iterations_have_photons_of_their_own() {
    let mut scene = furnace([0.0; 3], [0.5; 3]);
    scene.lights[0].kind = LightKind::Point;
    scene.lights[0].intensity = Vec3::ONE;
    scene.lights[0].position = Vec3::new(0.1, 0.2, 0.3);
    let run_of_count = |count: u32, iteration, points, others| {
        let harness = Harness::new(PASS).with_scene(scene.clone()).set("count", count).set("bounces", 3u32);
        let [points, others] = [points, others].map(|count| vec![SurfacePoint::NONE; count]);
        let outputs = harness.surface_points_before("iteration", iteration, &points, &others).run()?;
        Some((outputs.lights("lights"), outputs.surface_points("points")))
    };
    let run_of = |iteration, points, others| run_of_count(301, iteration, points, others);
    let run = |iteration| run_of(iteration, 1, 0);
    let (Some(first), Some(second), Some(again)) = (run(4), run(5), run(4)) else { return };
    assert_eq!((&first.0, &first.1.1), (&again.0, &again.1.1), "one iteration has one sequence");
    let (lights, (header, points)) = &first;
    assert_eq!((header.count, header.iteration), (301, 4));
    for (light, point) in lights.iter().zip(points) {
        assert_eq!(
            (light.position, light.normal, light.texel),
            (point.position, point.normal, point.triangle)
        );
    }
    assert!(points[300].is_none(), "what is left over is dark");
    let seeds: std::collections::BTreeSet<u32> = points.iter().map(|point| point.seed).collect();
    assert!(seeds.len() > 299, "{}", seeds.len());
    let moved = lights.iter().zip(&second.0).filter(|(a, b)| a.position != b.position).count();
    assert!(moved >= 300, "{moved} of 300 are elsewhere");
    let [a, b] = [lights, &second.0].map(|lights| fluxes(&lights[..300], 3, 0));
    assert!(a.iter().zip(&b).all(|(a, b)| (a / b - 1.0).abs() < 1e-5), "{a:?}, {b:?}");
    // A quarter of the points: a quarter of the photons, of as much flux in all.
    let (few, (header, _)) = run_of(4, 25, 75).unwrap();
    assert_eq!((few.len(), header.count), (75, 75));
    let fewer = fluxes(&few, 3, 0);
    assert!(a.iter().zip(&fewer).all(|(a, b)| (a / b - 1.0).abs() < 1e-5), "{a:?}, {fewer:?}");
    // A path at least.
    let (one, _) = run_of_count(4, 4, 25, 75).unwrap();
    assert!(one.len() == 3 && one.iter().all(|light| light.flux[0] > 0.0), "{one:?}");
}

#[test]
fn without_light_all_places_are_dark() {
    let mut scene = scene("plane");
    scene.lights[0].intensity = Vec3::ZERO;
    let Some(found) = lights(&scene, 100, 3) else { return };
    assert!(found.iter().all(|light| light.flux == [0.0; 3] && light.normal != [0.0; 3]));
    scene.lights.clear();
    let found = lights(&scene, 2, 3).expect("the adapter is still there");
    assert!(found.iter().all(|light| light.flux == [0.0; 3]));
}
