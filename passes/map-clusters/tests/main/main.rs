//! Each texel belongs to the nearest cluster in whose window it lies.

mod cpu_reference;
mod gpu;
mod means;

use cpu_reference::{NormalDistance, flux_distance, normal_distance};
use glam::{DVec3, dvec3};
use map_clusters::PASS;

#[test]
fn every_variant_of_the_shader_is_valid() {
    pass_test::assert_shaders_are_valid(PASS);
}

#[test]
fn normals_are_as_far_apart_as_their_angle_says() {
    let (up, right) = (DVec3::Y, DVec3::X);
    let tilted = dvec3(0.0, 0.5, 0.75f64.sqrt());
    for (a, b, cosine, angle) in [
        (up, up, 0.0, 0.0),
        (up, tilted, 0.5, 1.0 / 3.0),
        (up, right, 1.0, 0.5),
        // The two sides of a wall.
        (up, -up, 0.0, 1.0),
        (up, DVec3::ZERO, 1.0, 1.0),
    ] {
        assert!((normal_distance(a, b, NormalDistance::Cosine) - cosine).abs() < 1e-12, "{a} {b}");
        assert!((normal_distance(a, b, NormalDistance::Angle) - angle).abs() < 1e-12, "{a} {b}");
    }
}

#[test]
fn fluxes_are_apart_whatever_their_unit() {
    let (red, green) = (dvec3(2.0, 0.0, 0.0), dvec3(0.0, 2.0, 0.0));
    assert_eq!(flux_distance(red, green), 1.0);
    assert_eq!(flux_distance(red, DVec3::ZERO), 1.0);
    assert_eq!(flux_distance(DVec3::ZERO, DVec3::ZERO), 0.0);
    assert_eq!(flux_distance(red, red), 0.0);
    let near = flux_distance(red, 1.1 * red);
    assert!((flux_distance(1e-9 * red, 1.1e-9 * red) - near).abs() < 1e-12 && near < 0.01, "{near}");
}
