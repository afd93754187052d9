//! The results of short rays, against closed forms over a lit plane.

use glam::{Vec3, vec3};
use pass_test::Harness;
use scene::{Camera, Light, LightKind};
use std::f64::consts::PI;

/// Pixels along a side of the view.
const SIDE: u32 = 64;

/// Light that falls straight on the plane [W/m²].
const SUN: f32 = 3.0;

/// The compensated irradiance of receivers that face the middle of a sunlit plane of albedo ½ from the height `height`
/// \[m\], with the bound `bound` \[m\]; each had the irradiance `before`. The plane is a square of 2 m.
fn compensated(height: f32, bound: f32, rays: u32, before: [f32; 4]) -> Option<Vec<[f32; 4]>> {
    let mut scene = pass_test::scene("plane");
    let sun = LightKind::Directional;
    let light = scene.lights[0].clone();
    scene.lights = vec![Light { kind: sun, direction: Vec3::NEG_Y, intensity: Vec3::splat(SUN), ..light }];
    let extent = 2.0 * 2f32.sqrt();
    let outputs = Harness::new(bias_compensation::PASS)
        .with_scene(scene)
        // Far above and narrow: all receivers are within 1 mm of the middle.
        .camera(Camera {
            position: vec3(0.0, 1.0, 0.0),
            target: Vec3::ZERO,
            up: Vec3::NEG_Z,
            vertical_fov: 0.001,
            near: 0.01,
        })
        .frame(SIDE, SIDE)
        .set("rays_per_pixel", rays)
        .seen(|_, _| (1.0 - height, [0.0, -1.0, 0.0]))
        .irradiance((4, 2), |_, _| before)
        .fact("clamp", bound / extent)
        .run()?;
    Some(outputs.read("compensated"))
}

/// The irradiance that a plane of radiance L lacks at the height h below the bound b: with a = h / b, the integral of
/// L cosθ (1 - a² / cos²θ) over the directions of cosθ > a, 2π L ((1 - a²) / 2 + a² ln a).
fn missing(height: f64, bound: f64) -> f64 {
    let radiance = 0.5 / PI * f64::from(SUN);
    let a = height / bound;
    if a >= 1.0 { 0.0 } else { 2.0 * PI * radiance * ((1.0 - a * a) / 2.0 + a * a * a.ln()) }
}

fn mean(pixels: &[[f32; 4]]) -> f64 {
    pixels.iter().map(|pixel| f64::from(pixel[0])).sum::<f64>() / pixels.len() as f64
}

#[test]
fn a_plane_returns_its_near_field() {
    for (height, bound) in [(0.001, 0.4), (0.05, 0.4), (0.2, 0.4), (0.39, 0.4)] {
        let Some(pixels) = compensated(height, bound, 4, [0.0; 4]) else { return };
        let (found, wanted) = (mean(&pixels), missing(f64::from(height), f64::from(bound)));
        // 16,384 stratified rays.
        assert!(
            (found - wanted).abs() < 4e-3 * wanted + 1e-5,
            "at {height} of {bound}: {found} for {wanted}"
        );
    }
}

#[test]
fn what_was_there_is_kept() {
    for bound in [0.0, 0.1] {
        // The plane is farther than the bound.
        let Some(pixels) = compensated(0.2, bound, 1, [1.0, 2.0, 3.0, 4.0]) else { return };
        assert!(pixels.iter().all(|pixel| *pixel == [1.0, 2.0, 3.0, 4.0]), "{:?}", pixels[0]);
    }
}

#[test]
fn what_rays_return_is_not_missing_any_more() {
    let Some(pixels) = compensated(0.05, 0.4, 1, [0.0, 0.0, 0.0, 7.0]) else { return };
    for [r, g, b, missing] in &pixels {
        let returned = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        assert!((missing + returned - 7.0).abs() < 1e-4, "{missing} are missing, and {returned} came back");
    }
    assert!(mean(&pixels) > 0.0);
}

/// The eight pixels of a window of the interleaving share one set of stratified rays, so that their mean, which a filter
/// takes, varies less than that of eight rays of their own.
#[test]
fn a_window_shares_its_rays() {
    let Some(pixels) = compensated(0.05, 0.4, 1, [0.0; 4]) else { return };
    let variance = |values: &[f64]| {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64
    };
    let single: Vec<f64> = pixels.iter().map(|pixel| f64::from(pixel[0])).collect();
    let window = |x: u32, y: u32| {
        let pixel = |i: u32| single[((2 * y + i / 4) * SIDE + 4 * x + i % 4) as usize];
        (0..8).map(pixel).sum::<f64>() / 8.0
    };
    let windows: Vec<f64> =
        (0..SIDE / 4 * (SIDE / 2)).map(|i| window(i % (SIDE / 4), i / (SIDE / 4))).collect();
    let (of_windows, independent) = (variance(&windows), variance(&single) / 8.0);
    assert!(of_windows < 0.5 * independent, "{of_windows} against {independent}");
}
