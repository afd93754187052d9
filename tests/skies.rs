//! Scenes that light from infinitely far lights, against closed forms.

use crate::adapter::{done, renderer};
use glam::{DVec3, dvec3};
use metrics::Image;
use renderer::Renderer;
use scene::{Environment, Scene};
use std::f64::consts::PI;

const SIZE: (u32, u32) = (24, 18);

/// A map that is dim, but for a texel of 10⁵, turned by an angle.
fn with_a_bright_texel() -> Environment {
    let mut texels = vec![[1.0, 2.0, 0.5]; 16 * 8];
    texels[2 * 16 + 11] = [1e5; 3];
    Environment { width: 16, height: 8, texels, rotation: 0.7 }
}

/// Radiance from a direction, by what `Environment` says of its map.
fn radiance(environment: &Environment, direction: DVec3) -> [f64; 3] {
    let turned = glam::DQuat::from_rotation_y(-f64::from(environment.rotation)) * direction;
    let (width, height) = (f64::from(environment.width), f64::from(environment.height));
    let x = (turned.x.atan2(-turned.z) / (2.0 * PI) + 0.5) * width;
    let y = turned.y.acos() / PI * height;
    let (x, y) = ((x as u32).min(environment.width - 1), (y as u32).min(environment.height - 1));
    environment.texels[(y * environment.width + x) as usize].map(f64::from)
}

/// Irradiance of a plane that faces up, by the midpoints of many directions.
fn irradiance(environment: &Environment) -> [f64; 3] {
    let (rows, columns) = (512, 2048);
    let mut sum = [0.0; 3];
    for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        // Even in the squared sine, and so by the cosine.
        let level = ((f64::from(row) + 0.5) / f64::from(rows)).sqrt();
        let (sine, cosine) = (2.0 * PI * (f64::from(column) + 0.5) / f64::from(columns)).sin_cos();
        let direction = dvec3(level * sine, (1.0 - level * level).sqrt(), level * cosine);
        let found = radiance(environment, direction);
        (0..3).for_each(|c| sum[c] += PI * found[c] / f64::from(rows * columns));
    }
    sum
}

/// The scene `plane` without its light, under an environment.
fn plane_under(renderer: &Renderer, environment: Environment) -> Scene {
    let mut scene = renderer.scene().clone();
    scene.lights.clear();
    scene.environment = Some(environment);
    scene
}

/// Asserts that the pixels which see the plane reflect half of an irradiance, and that the others show the sky.
fn assert_lit(image: &Image, direct: &Image, irradiance: [f64; 3], most: f64) {
    let mut mean = [0.0; 3];
    let mut count = 0.0;
    for (pixel, lit) in image.pixels().iter().zip(direct.pixels()) {
        if lit[3] == 0.0 {
            assert!(pixel[0] > 0.0 && lit[..3] == [0.0; 3], "the sky is seen, and is no reflected light");
            continue;
        }
        count += 1.0;
        (0..3).for_each(|c| mean[c] += f64::from(lit[c]));
    }
    assert!(count > 50.0 && count < f64::from(SIZE.0 * SIZE.1));
    for c in 0..3 {
        let expected = 0.5 * irradiance[c] / PI;
        let found = mean[c] / count;
        assert!((found / expected - 1.0).abs() < most, "channel {c}: {found}, not {expected}");
    }
}

#[test]
fn paths_find_the_light_of_a_sky() {
    let values = ["samples=64", "filter=centre"];
    let Some(mut renderer) = renderer("reference", "plane", SIZE, &values) else { return };
    let uniform = Environment::uniform([1.0, 2.0, 0.5]);
    let bright = with_a_bright_texel();
    for (sky, expected, most) in
        [(uniform, [PI, 2.0 * PI, 0.5 * PI], 2e-3), (bright.clone(), irradiance(&bright), 0.01)]
    {
        let scene = plane_under(&renderer, sky);
        renderer.set_scene(scene).unwrap();
        done(&mut renderer);
        let [image, direct] = ["image", "direct"].map(|name| renderer.output(name).unwrap());
        assert_lit(&image, &direct, expected, most);
    }
    // A black one is none.
    let scene = plane_under(&renderer, Environment::uniform([0.0; 3]));
    renderer.set_scene(scene).unwrap();
    done(&mut renderer);
    assert!(renderer.output("image").unwrap().pixels().iter().all(|pixel| pixel[..3] == [0.0; 3]));
}

/// Walls that reflect half and emit ½ see as much wherever they look, and the hole between them shows: 1.
#[test]
fn a_box_that_is_open_to_a_sky_is_a_furnace() {
    let values = ["samples=64", "bounces=12", "filter=centre"];
    let Some(mut renderer) = renderer("reference", "cornell-box", SIZE, &values) else { return };
    let mut scene = renderer.scene().clone();
    scene.lights.clear();
    scene.environment = Some(Environment::uniform([1.0; 3]));
    for material in &mut scene.materials {
        material.base_color = glam::Vec4::new(0.5, 0.5, 0.5, 1.0);
        material.emission = glam::Vec3::splat(0.5);
    }
    renderer.set_scene(scene).unwrap();
    done(&mut renderer);
    let image = renderer.output("image").unwrap();
    let off = |pixel: &[f32; 4]| (pixel[0] - 1.0).abs();
    let greatest = image.pixels().iter().map(off).fold(0.0, f32::max);
    assert!(greatest < 0.05, "{greatest} in a pixel of 64 samples");
    let mean = crate::adapter::mean(&image)[1];
    assert!((mean - 1.0).abs() < 2e-3, "{mean}");
}
