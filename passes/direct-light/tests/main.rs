//! The shader is valid; the CPU reference against closed forms.

mod cpu_reference;
mod gpu;

use cpu_reference::{Map, ggx};
use glam::{DVec2, DVec3, dvec2, dvec3};
use std::f64::consts::PI;

pass_test::shaders_are_valid!(direct_light::PASS);

const TOWARDS: DVec3 = DVec3::Z;

/// A map of a wall at distance 2 whose left half is hidden by a screen at distance 1.
fn screened(perspective: bool) -> Map {
    let mut map = Map::of_plane(64, DVec2::ONE, perspective, dvec3(0.0, 0.0, -2.0), TOWARDS);
    for (i, distance) in map.distances.iter_mut().enumerate() {
        if i % 64 < 32 {
            *distance = 1.0;
        }
    }
    map
}

#[test]
fn a_plane_never_shadows_itself() {
    for perspective in [true, false] {
        for i in 0..400 {
            let angle = f64::from(i) * 0.37;
            let tilt = f64::from(i % 20) / 20.0 * 1.2;
            let normal = dvec3(tilt.sin() * angle.cos(), tilt.sin() * angle.sin(), tilt.cos());
            let at = dvec3(0.3, -0.2, -3.0);
            let map = Map::of_plane(64, DVec2::ONE, perspective, at, normal);
            for k in 0..40 {
                let image = dvec2(f64::from(k % 7), f64::from(k / 7)) * 0.1 - 0.3;
                let distance = cpu_reference::plane_distance(at, normal, image, perspective);
                let scale = if perspective { distance } else { 1.0 };
                let receiver = (image * scale).extend(-distance);
                // Seen too much on edge, a plane rises more than the limit, and the bias has to do.
                let cosine = if perspective { -receiver.normalize().dot(normal) } else { normal.z };
                if cosine < 0.3 {
                    continue;
                }
                let lit = map.visibility(receiver, normal, 5, 1e-9);
                assert!((lit - 1.0).abs() < 1e-9, "{perspective} {normal:?} at {receiver:?}: {lit}");
            }
        }
    }
}

#[test]
fn a_screen_shadows_what_is_behind_it_with_a_smooth_edge() {
    for (perspective, pcf) in [(true, 1), (true, 5), (false, 3), (false, 9)] {
        let map = screened(perspective);
        let scale = if perspective { 2.0 } else { 1.0 };
        let lit = |x: f64| map.visibility(dvec3(x * scale, 0.0, -2.0), TOWARDS, pcf, 0.5);
        let window = f64::from(pcf + 1) / 64.0;
        assert_eq!(lit(-window), 0.0);
        assert!((lit(window) - 1.0).abs() < 1e-12);
        assert!((lit(0.0) - 0.5).abs() < 1e-9, "{}", lit(0.0));
        let mut last = 0.0;
        for i in -100..=100 {
            let now = lit(f64::from(i) / 100.0 * window);
            assert!(now >= last - 1e-12 && now - last < 0.03, "no smooth rise from {last} to {now}");
            last = now;
        }
    }
}

#[test]
fn what_is_in_front_of_the_screen_is_lit() {
    assert!((screened(true).visibility(dvec3(-0.3, 0.0, -0.9), TOWARDS, 5, 0.5) - 1.0).abs() < 1e-12);
}

/// The wall of a building, hidden by its roof: the sun's map is empty beside the building.
#[test]
fn past_the_outline_of_the_scene_a_hidden_surface_stays_dark_and_a_lit_one_lit() {
    for (nearest, expected) in [(1.0, 0.0), (2.0, 1.0)] {
        let distances = (0..64 * 64).map(|i| if i % 64 < 32 { nearest } else { 0.0 }).collect();
        let map = Map { size: 64, half_extent: DVec2::ONE, perspective: false, distances };
        for x in [-0.2, -0.05, -0.01, 0.0, 0.01] {
            let lit = map.visibility(dvec3(x, 0.1, -2.0), TOWARDS, 5, 0.5);
            assert!((lit - expected).abs() < 1e-12, "{lit} at {x} behind {nearest}");
        }
    }
}

#[test]
fn an_empty_map_hides_nothing_and_a_spot_sends_nothing_back() {
    let empty = Map { size: 8, half_extent: DVec2::ONE, perspective: true, distances: vec![0.0; 64] };
    assert!((empty.visibility(dvec3(0.1, 0.1, -5.0), TOWARDS, 5, 0.5) - 1.0).abs() < 1e-12);
    assert_eq!(empty.visibility(dvec3(0.1, 0.1, 5.0), TOWARDS, 5, 0.5), 0.0);
}

/// ∫ f cosθ dω over the hemisphere: what is reflected of light from one side. It stays below 1, and what is
/// missing is scattered twice or more, which one microfacet does not follow.
#[test]
fn the_glossy_part_reflects_no_more_than_it_receives() {
    for roughness in [0.3, 0.6, 1.0] {
        for degrees in [0.0f64, 40.0, 70.0] {
            let camera = dvec3(degrees.to_radians().sin(), 0.0, degrees.to_radians().cos());
            let (rings, spokes) = (600, 600);
            let mut albedo = 0.0;
            for i in 0..rings * spokes {
                // Uniformly over the disc, so each stands for π / n of the projected solid angle.
                let r2 = (f64::from(i / spokes) + 0.5) / f64::from(rings);
                let turn = (f64::from(i % spokes) + 0.5) / f64::from(spokes) * 2.0 * PI;
                let light = dvec3(r2.sqrt() * turn.cos(), r2.sqrt() * turn.sin(), (1.0 - r2).sqrt());
                albedo += ggx(TOWARDS, light, camera, 1.0, roughness) * PI / f64::from(rings * spokes);
            }
            assert!(albedo < 1.001, "roughness {roughness} at {degrees}°: {albedo}");
            if roughness == 1.0 && degrees == 0.0 {
                // With α = 1 and the camera above: D = 1/π, G/(4 cos cos′) = 1/(2 (1 + cos)); ∫ = 1 − ln 2.
                assert!((albedo - (1.0 - 2f64.ln())).abs() < 1e-3, "{albedo}");
            }
            if roughness == 0.3 && degrees < 50.0 {
                assert!(albedo > 0.95, "a smooth mirror keeps its light: {albedo}");
            }
        }
    }
}
