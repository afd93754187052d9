//! Photons against closed forms.

use glam::Vec3;
use interfaces::virtual_lights::VirtualLight;
use pass_test::rooms::furnace;
use pass_test::{Harness, scene};
use scene::{LightKind, Scene};
use std::f64::consts::PI;
use trace_photons::PASS;

#[test]
fn every_variant_is_valid() {
    pass_test::assert_shaders_are_valid(PASS);
}

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
