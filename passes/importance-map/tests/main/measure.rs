use glam::{DVec3, dvec3};
use importance_map::cpu_reference::{
    ViewSample, contribution, geometry, luminance, mix_with_flux, pixel, response,
};
use std::f64::consts::PI;

const UP: DVec3 = DVec3::Z;
const DOWN: DVec3 = DVec3::NEG_Z;

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
    let f = contribution(DVec3::ZERO, UP, flux, &[above], 0.0);
    assert!((f - luminance(flux) / PI * expected).abs() < 1e-12);
}

#[test]
fn patches_at_an_angle() {
    // 45° at both ends, distance √2 / 2.
    let aside = sample(dvec3(0.5, 0.0, 0.5), DOWN, DVec3::ONE);
    assert!((geometry(DVec3::ZERO, UP, &aside, 0.0) - 0.5 / (PI * 0.5)).abs() < 1e-12);
}

#[test]
fn nothing_comes_from_behind_or_from_another_colour() {
    let behind = sample(dvec3(0.0, 0.0, -0.5), UP, DVec3::ONE);
    let averted = sample(dvec3(0.0, 0.0, 0.5), UP, DVec3::ONE);
    let green = sample(dvec3(0.0, 0.0, 0.5), DOWN, DVec3::Y);
    assert_eq!(contribution(DVec3::ZERO, UP, DVec3::ONE, &[behind, averted], 0.0), 0.0);
    assert_eq!(contribution(DVec3::ZERO, UP, dvec3(1.0, 0.0, 1.0), &[green], 0.0), 0.0);
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
    let alone = contribution(DVec3::ZERO, UP, DVec3::ONE, &[above], 0.0);
    let with_sky = contribution(DVec3::ZERO, UP, DVec3::ONE, &[above, ViewSample::default()], 0.0);
    assert!((with_sky - alone / 2.0).abs() < 1e-15);
}

#[test]
fn the_mixture_bounds_the_weight_of_a_light() {
    let flux = [1.0, 5.0, 0.5, 0.0, 3.5];
    let by_view = [100.0, 0.0, 0.0, 0.0, 1e-9];
    let mixed = mix_with_flux(&by_view, &flux, 0.05);
    assert!((mixed.iter().sum::<f64>() - 5.0).abs() < 1e-12, "the mean is 1: {mixed:?}");
    assert_eq!(mixed[3], 0.0, "what reflects nothing is not sampled");
    for (f, w) in std::iter::zip(&mixed, flux).filter(|(_, w)| *w > 0.0) {
        // Φ / (N p) with N = 1; sampling by flux alone gives ΣΦ = 10.
        let carried = w / (f / 5.0);
        assert!(carried <= 10.0 / 0.05 + 1e-9, "{carried}");
    }
}

#[test]
fn the_mixture_of_nothing_is_nothing() {
    assert_eq!(mix_with_flux(&[0.0; 3], &[0.0; 3], 0.05), [0.0; 3]);
    // The camera sees nothing: what is left is the flux.
    assert_eq!(mix_with_flux(&[0.0; 2], &[1.0, 3.0], 0.5), [0.25, 0.75]);
}

#[test]
fn pixels_stay_in_the_frame() {
    assert_eq!(pixel([0.0, 0.0], (7, 3)), (0, 0));
    assert_eq!(pixel([0.5, 0.5], (7, 3)), (3, 1));
    assert_eq!(pixel([1.0, 1.0], (7, 3)), (6, 2));
    assert_eq!(pixel([0.999, 0.999], (1, 1)), (0, 0));
}
