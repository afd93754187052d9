//! What pixels receive from the lights that were chosen for them.

use interfaces::reservoirs::Reservoir;
use interfaces::virtual_lights::VirtualLight;
use pass_test::Harness;
use pass_test::reservoirs::{SIDE, TARGET, flat, lights, reservoir};
use shade_reservoirs::PASS;
use std::f64::consts::PI;

fn shade(per_pixel: u32, reservoirs: &[Reservoir]) -> Harness<'static> {
    Harness::new(PASS).middle_of_plane(flat).reservoirs("reservoirs", per_pixel, reservoirs)
}

/// A light above the middle of the plane, facing it.
fn above(height: f32) -> VirtualLight {
    VirtualLight {
        position: [0.0, height, 0.0],
        normal: [0.0, -1.0, 0.0],
        area: 1e-4,
        texel: 0,
        flux: [2.0, 1.0, 0.5],
        kind: 0,
    }
}

#[test]
fn every_variant_of_the_shaders_is_valid() {
    pass_test::assert_shaders_are_valid(PASS);
}

#[test]
fn a_light_gives_its_irradiance_times_the_weight() {
    let all = vec![reservoir(above(0.5), 0.25, 8.0); (SIDE * SIDE) as usize];
    let Some(outputs) = shade(1, &all).run() else { return };
    let pixels: Vec<[f32; 4]> = outputs.read("irradiance");
    let expected = [2.0, 1.0, 0.5].map(|flux| 4.0 * flux / (PI * 0.25));
    for pixel in &pixels {
        let off = pixel.iter().zip(expected).any(|(found, e)| (f64::from(*found) - e).abs() > 1e-4 * e);
        assert!(!off, "{pixel:?} for {expected:?}");
        assert!(pixel[3].abs() < 1e-6, "nothing is removed: {pixel:?}");
    }
    let verified: Vec<Reservoir> = outputs.read("verified");
    assert_eq!(verified, all);
}

/// One light lies below the plane, one faces away from it: a ray meets the plane, or no light comes.
#[test]
fn what_is_hidden_gives_nothing_and_is_doubted() {
    let below = VirtualLight { position: [0.0, -0.5, 0.0], normal: [0.0, 1.0, 0.0], ..above(0.5) };
    let away = VirtualLight { normal: [0.0, 1.0, 0.0], ..above(0.5) };
    for light in [below, away] {
        let Some(outputs) = shade(1, &vec![reservoir(light, 1.0, 1.0); (SIDE * SIDE) as usize]).run() else {
            return;
        };
        let pixels: Vec<[f32; 4]> = outputs.read("irradiance");
        assert!(pixels.iter().all(|pixel| *pixel == [0.0; 4]), "{:?}", pixels[0]);
        let verified: Vec<Reservoir> = outputs.read("verified");
        assert!(verified.iter().all(|reservoir| reservoir.guess == TARGET.2));
    }
}

#[test]
fn reservoirs_of_a_pixel_are_averaged() {
    let pair = [reservoir(above(0.5), 1.0, 1.0), reservoir(above(0.5), 1.0 / 3.0, 1.0)];
    let all = pair.repeat((SIDE * SIDE) as usize);
    let Some(outputs) = shade(2, &all).run() else { return };
    let pixels: Vec<[f32; 4]> = outputs.read("irradiance");
    let expected = 2.0 * 2.0 / (PI * 0.25);
    assert!(pixels.iter().all(|pixel| (f64::from(pixel[0]) / expected - 1.0).abs() < 1e-4));
}

/// What is near is bounded, and what that took is known.
#[test]
fn a_bound_removes_what_alpha_has() {
    let extent = f64::from(pass_test::scene("plane").dense_extent());
    let all = vec![reservoir(above(0.05), 1.0, 1.0); (SIDE * SIDE) as usize];
    let bounded = shade(1, &all).set("clamp", (0.1 / extent) as f32).set("area_bound", 0.0f32);
    let Some(outputs) = bounded.run() else { return };
    let pixels: Vec<[f32; 4]> = outputs.read("irradiance");
    let (kept, whole) = (1.0 / (PI * 0.01), 1.0 / (PI * 0.0025));
    let luminance = 0.2126 * 2.0 + 0.7152 + 0.0722 * 0.5;
    for pixel in pixels {
        assert!((f64::from(pixel[0]) / (2.0 * kept) - 1.0).abs() < 1e-4, "{pixel:?}");
        assert!((f64::from(pixel[3]) / (luminance * (whole - kept)) - 1.0).abs() < 1e-3, "{pixel:?}");
    }
}

#[test]
fn a_light_infinitely_far_needs_no_place() {
    let far = lights()[4];
    let all = vec![reservoir(far, 1.0, 1.0); (SIDE * SIDE) as usize];
    let Some(outputs) = shade(1, &all).run() else { return };
    let pixels: Vec<[f32; 4]> = outputs.read("irradiance");
    assert!(pixels.iter().all(|pixel| (pixel[0] / far.flux[0] - 1.0).abs() < 1e-5), "{:?}", pixels[0]);
}
