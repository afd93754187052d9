//! The shaders are valid; the CPU reference against closed forms.

mod cpu_reference;
mod gpu;

use crate::cpu_reference::{Layer, incident_flux, rectangle_solid_angle};
use glam::{DVec2, dvec2, uvec2};
use std::f64::consts::PI;

pass_test::shaders_are_valid!(reflective_shadow_map::PASS);

/// Sums what a layer sends through all of its texels.
fn sum(layer: Layer, size: u32, half_extent: DVec2) -> f64 {
    (0..size * size).map(|i| incident_flux(layer, uvec2(i % size, i / size), size, half_extent)).sum()
}

#[test]
fn six_faces_make_the_whole_sphere() {
    for size in [1, 2, 3, 17, 128] {
        let all = 6.0 * sum(Layer::Point, size, DVec2::ONE);
        assert!((all / (4.0 * PI) - 1.0).abs() < 1e-12, "{size}: {all}");
    }
}

#[test]
fn a_small_texel_has_its_area_times_the_cosine_cubed() {
    let (x, y, side) = (0.7, -0.3, 1e-5);
    let corner = dvec2(x, y);
    let exact = rectangle_solid_angle(corner, corner + side);
    let differential = side * side / (1.0 + (corner + 0.5 * side).length_squared()).powf(1.5);
    assert!((exact / differential - 1.0).abs() < 1e-9, "{exact} {differential}");
}

#[test]
fn a_hard_spot_sends_its_cone() {
    for degrees in [5.0f64, 30.0, 60.0] {
        let outer = degrees.to_radians();
        let half_extent = DVec2::splat(outer.tan());
        // The edge of the cone falls between texels; what it cuts off averages out with their number.
        for (size, tolerance) in [(32, 2e-2), (512, 5e-4)] {
            let sent = sum(Layer::Spot { cos_inner: outer.cos(), cos_outer: outer.cos() }, size, half_extent);
            let cone = 2.0 * PI * (1.0 - outer.cos());
            assert!((sent / cone - 1.0).abs() < tolerance, "{degrees}° at {size}: {sent} for {cone}");
        }
    }
}

#[test]
fn a_soft_spot_sends_the_integral_of_its_ramp() {
    let (cos_inner, cos_outer) = (0.95, 0.8f64);
    let tangent = (1.0 - cos_outer * cos_outer).sqrt() / cos_outer;
    let sent = sum(Layer::Spot { cos_inner, cos_outer }, 256, DVec2::splat(tangent));
    // 2π (1 − c_i + (c_i − c_o) / 3)
    let integral = 2.0 * PI * (1.0 - cos_inner + (cos_inner - cos_outer) / 3.0);
    assert!((sent / integral - 1.0).abs() < 1e-4, "{sent} for {integral}");
}

#[test]
fn parallel_light_sends_the_area_of_its_map() {
    let sent = sum(Layer::Directional, 37, dvec2(12.0, 5.0));
    assert!((sent / (24.0 * 10.0) - 1.0).abs() < 1e-12, "{sent}");
}
