use crate::cpu_reference::{ViewSample, geometry, importance, luminance, pixel, response, view_response};
use glam::{DVec3, dvec3};
use std::f64::consts::PI;

const UP: DVec3 = DVec3::Z;
const DOWN: DVec3 = DVec3::NEG_Z;

/// The importance of the paper, of a texel at the origin that faces up.
fn contribution(flux: DVec3, samples: &[ViewSample]) -> f64 {
    importance(flux, view_response(DVec3::ZERO, UP, samples, 0.0), 0.0)
}

fn sample(position: DVec3, normal: DVec3, albedo: DVec3) -> ViewSample {
    ViewSample { position, normal, response: response(albedo) }
}

#[test]
fn patches_face_to_face() {
    let above = sample(dvec3(0.0, 0.0, 0.5), DOWN, DVec3::ONE);
    let expected = 1.0 / (PI * 0.25);
    assert!((geometry(DVec3::ZERO, UP, &above, 0.0) - expected).abs() < 1e-12 * expected);
    // White light on a white surface: the luminance of the flux, over π, times the geometry term.
    let flux = dvec3(2.0, 3.0, 4.0);
    let f = contribution(flux, &[above]);
    assert!((f - luminance(flux) / PI * expected).abs() < 1e-12);
}

#[test]
fn patches_at_an_angle() {
    // 45° at both ends, distance √2 / 2.
    let aside = sample(dvec3(0.5, 0.0, 0.5), DOWN, DVec3::ONE);
    assert!((geometry(DVec3::ZERO, UP, &aside, 0.0) - 0.5 / (PI * 0.5)).abs() < 1e-12);
}

#[test]
fn nothing_comes_from_behind_or_from_another_color() {
    let behind = sample(dvec3(0.0, 0.0, -0.5), UP, DVec3::ONE);
    let averted = sample(dvec3(0.0, 0.0, 0.5), UP, DVec3::ONE);
    let green = sample(dvec3(0.0, 0.0, 0.5), DOWN, DVec3::Y);
    assert_eq!(contribution(DVec3::ONE, &[behind, averted]), 0.0);
    assert_eq!(contribution(dvec3(1.0, 0.0, 1.0), &[green]), 0.0);
}

#[test]
fn a_sample_on_the_light_is_bounded() {
    let on = sample(DVec3::ZERO, DOWN, DVec3::ONE);
    assert_eq!(geometry(DVec3::ZERO, UP, &on, 0.01), 0.0);
    let near = sample(dvec3(0.0, 0.0, 1e-6), DOWN, DVec3::ONE);
    let bound = 1.0 / (PI * 0.01 * 0.01);
    let term = geometry(DVec3::ZERO, UP, &near, 0.01);
    assert!(term <= bound && term > 0.99 * bound, "{term} of {bound}");
}

#[test]
fn pixels_without_surface_count_for_nothing_but_count() {
    let above = sample(dvec3(0.0, 0.0, 0.5), DOWN, DVec3::ONE);
    let alone = contribution(DVec3::ONE, &[above]);
    let with_sky = contribution(DVec3::ONE, &[above, ViewSample::default()]);
    assert!((with_sky - alone / 2.0).abs() < 1e-15);
}

#[test]
fn what_no_sample_saw_is_sampled_by_its_flux() {
    let flux = dvec3(2.0, 3.0, 4.0);
    assert_eq!(importance(flux, DVec3::ZERO, 0.5), 0.5 * luminance(flux));
    assert_eq!(importance(DVec3::ZERO, DVec3::ONE, 0.5), 0.0, "what reflects nothing is not sampled");
}

#[test]
fn pixels_stay_in_the_frame() {
    assert_eq!(pixel([0.0, 0.0], (7, 3)), (0, 0));
    assert_eq!(pixel([0.5, 0.5], (7, 3)), (3, 1));
    assert_eq!(pixel([1.0, 1.0], (7, 3)), (6, 2));
    assert_eq!(pixel([0.999, 0.999], (1, 1)), (0, 0));
}
