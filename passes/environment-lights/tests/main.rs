//! Lights of the environment against closed forms.

use environment_lights::PASS;
use glam::{DVec3, Vec3};
use interfaces::virtual_lights::VirtualLight;
use pass_test::Harness;
use scene::{Environment, Scene};
use std::f64::consts::PI;

pass_test::shaders_are_valid!(PASS);

/// The value of `VirtualLight::kind` for a light infinitely far.
const INFINITELY_FAR: u32 = 1;

fn under(environment: Option<Environment>) -> Scene {
    let mut scene = pass_test::scene("plane");
    scene.environment = environment;
    scene
}

fn lights(scene: &Scene, count: u32) -> Option<Vec<VirtualLight>> {
    Some(Harness::new(PASS).with_scene(scene.clone()).set("count", count).run()?.lights("lights"))
}

/// Irradiance of a plane with this normal, by one channel \[W/m²\].
fn irradiance(lights: &[VirtualLight], normal: DVec3, channel: usize) -> f64 {
    let of = |light: &VirtualLight| {
        let cosine = -Vec3::from(light.normal).as_dvec3().dot(normal);
        f64::from(light.flux[channel]) * cosine.max(0.0)
    };
    lights.iter().map(of).sum()
}

#[test]
fn a_uniform_sky_gives_pi_times_its_radiance_on_every_side() {
    let scene = under(Some(Environment::uniform([1.0, 0.5, 3.0])));
    let Some(found) = lights(&scene, 4096) else { return };
    for normal in [DVec3::Y, DVec3::NEG_X, DVec3::new(0.6, 0.0, 0.8)] {
        for (c, radiance) in [1.0, 0.5, 3.0].into_iter().enumerate() {
            let ratio = irradiance(&found, normal, c) / (PI * radiance);
            assert!((ratio - 1.0).abs() < 5e-3, "{normal}: {ratio}");
        }
    }
    // All of one irradiance, and beyond the scene, in whose direction they shine.
    let middle = 0.5 * (scene.bounds().0 + scene.bounds().1);
    for light in &found {
        assert_eq!(light.kind, INFINITELY_FAR);
        assert!((f64::from(light.flux[0]) / (4.0 * PI / 4096.0) - 1.0).abs() < 1e-5);
        let along = (middle - Vec3::from(light.position)).dot(light.normal.into());
        assert!((along / (0.505 * scene.extent()) - 1.0).abs() < 1e-5, "{along}");
    }
}

/// A sun of one texel: its lights come from there, turned as the map is, and have its irradiance to rounding.
#[test]
fn one_texel_that_is_brighter_than_all_others_has_its_light() {
    let (width, height, row, column) = (32_u32, 16_u32, 3_u32, 25_u32);
    let mut texels = vec![[1.0; 3]; (width * height) as usize];
    texels[(row * width + column) as usize] = [1e5; 3];
    let mut environment = Environment { width, height, texels, rotation: 0.0 };
    let solid_angle = environment.solid_angle(row);
    for turned in [0.0, 0.4] {
        environment.rotation = turned;
        let Some(found) = lights(&under(Some(environment.clone())), 4096) else { return };
        let whole = 1e5 * solid_angle + (4.0 * PI - solid_angle);
        let sum: f64 = found.iter().map(|light| f64::from(light.flux[0])).sum();
        assert!((sum / whole - 1.0).abs() < 1e-5, "{sum} for {whole}");
        // The middle of the texel.
        let latitude = PI * (f64::from(row) + 0.5) / f64::from(height);
        let longitude = 2.0 * PI * ((f64::from(column) + 0.5) / f64::from(width) - 0.5);
        let to =
            DVec3::new(latitude.sin() * longitude.sin(), latitude.cos(), -latitude.sin() * longitude.cos());
        let to = glam::DQuat::from_rotation_y(f64::from(turned)) * to;
        let near = |light: &&VirtualLight| -Vec3::from(light.normal).as_dvec3().dot(to) > 0.985;
        let share = found.iter().filter(near).count() as f64 / 4096.0;
        let expected = 1e5 * solid_angle / whole;
        assert!((share - expected).abs() < 2.0 / 4096.0 + 1e-3, "{share} of the lights, not {expected}");
    }
}

#[test]
fn without_light_all_are_dark_and_all_is_finite() {
    for environment in [None, Some(Environment::uniform([0.0; 3]))] {
        let Some(found) = lights(&under(environment), 100) else { return };
        assert!(found.iter().all(|light| light.flux == [0.0; 3] && light.normal != [0.0; 3]));
    }
    for radiance in [1e-38, 1e30] {
        let mut scene = pass_test::scene("empty");
        scene.environment = Some(Environment::uniform([radiance; 3]));
        let found = lights(&scene, 100).expect("the adapter is still there");
        assert!(found.iter().all(|light| light.flux[0].is_finite() && light.position[0].is_finite()));
    }
}

#[test]
fn one_light_stands_for_the_whole_sky() {
    let Some(found) = lights(&under(Some(Environment::uniform([1.0; 3]))), 1) else { return };
    assert_eq!(found.len(), 1);
    assert!((f64::from(found[0].flux[0]) / (4.0 * PI) - 1.0).abs() < 1e-5, "{:?}", found[0]);
}
