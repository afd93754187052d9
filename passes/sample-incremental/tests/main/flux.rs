//! Fluxes and areas against closed forms.

use super::{Frame, Sampling, lamp_at, light, point_at, room};
use glam::Vec3;
use scene::LightKind;
use std::f64::consts::PI;

/// The luminance of all fluxes.
fn luminance(frame: &Frame) -> f64 {
    0.2126 * frame.flux(0) + 0.7152 * frame.flux(1) + 0.0722 * frame.flux(2)
}

/// In a closed room all light meets a surface: the fluxes add up to power times reflectance, whatever the lights are.
#[test]
fn a_closed_room_reflects_all_power() {
    let albedo = [0.2, 0.5, 0.8];
    let lamp = point_at([0.2, -0.3, 0.1], [1.0, 2.0, 3.0]);
    let scene = room(albedo, vec![lamp]);
    for count in [1, 7, 256] {
        let sampling = Sampling::of(count, 3);
        for frames in [1, 4] {
            let Some(frame) = sampling.frames(&scene, frames) else { return };
            for c in 0..3 {
                let expected = 4.0 * PI * [1.0, 2.0, 3.0][c] * albedo[c];
                let found = frame.flux(c);
                assert!((found / expected - 1.0).abs() < 1e-5, "{count} lights: {found} W of {expected}");
            }
        }
    }
}

/// The lights of a lamp in a room have its walls as their areas, and lie on them.
#[test]
fn areas_add_up_to_the_walls() {
    let Some(frame) = Sampling { count: 400, moved: 32, probes: 128 }.at_rest(&lamp_at([0.1, 0.0, -0.1]), 12)
    else {
        return;
    };
    let area: f64 = frame.lights.iter().map(|light| f64::from(light.area)).sum();
    assert!((area / 24.0 - 1.0).abs() < 0.02, "{area} m² of 24");
    for light in &frame.lights {
        let at = Vec3::from(light.position);
        assert!((at.abs().max_element() - 1.0).abs() < 1e-5 && at.dot(Vec3::from(light.normal)) < 0.0);
        assert!(light.area > 0.0 && light.flux[0] > 0.0);
    }
}

/// A spot's flux is its intensity over the cone, with the falloff over each cell.
#[test]
fn a_spot_gives_what_its_cone_holds() {
    for (inner, outer) in [(0.2_f32, 0.6_f32), (0.5, 0.5), (0.0, 1.5)] {
        let spot = light(LightKind::Spot { inner, outer }, [0.1, 0.0, 0.2], [0.3, 1.0, -0.4], [5.0; 3]);
        let Some(frame) = Sampling::of(256, 8).frames(&room([0.5; 3], vec![spot]), 3) else { return };
        let (inner, outer) = (f64::from(inner.cos()), f64::from(outer.cos()));
        // The falloff is the square of a ramp in the cosine.
        let expected = 0.5 * 5.0 * 2.0 * PI * ((1.0 - inner) + (inner - outer) / 3.0);
        let found = frame.flux(1);
        assert!((found / expected - 1.0).abs() < 1e-3, "{found} W of {expected}");
    }
}

/// A sun gives a plane its irradiance; rays beside the plane stand for what goes past it.
#[test]
fn what_goes_past_a_plane_is_lost() {
    let mut scene = pass_test::scene("plane");
    scene.lights = vec![light(LightKind::Directional, [0.0; 3], [0.6, -0.8, 0.0], [3.0; 3])];
    let sampling = Sampling::of(500, 32);
    let Some(frame) = sampling.at_rest(&scene, 16) else { return };
    // Irradiance 3 W/m², cosine 0.8, 4 m², albedo ½.
    assert!((frame.flux(1) / 4.8 - 1.0).abs() < 0.02, "{} W", frame.flux(1));
    let area: f64 = frame.lights.iter().map(|light| f64::from(light.area)).sum();
    assert!((area / 4.0 - 1.0).abs() < 0.02, "{area} m²");

    // A lamp above the square: its solid angle is 4 asin(a² / (a² + h²)).
    scene.lights = vec![point_at([0.0, 0.5, 0.0], [2.0; 3])];
    let frame = sampling.at_rest(&scene, 16).expect("the adapter is still there");
    let expected = 0.5 * 2.0 * 4.0 * (1.0_f64 / 1.25).asin();
    assert!((frame.flux(2) / expected - 1.0).abs() < 0.03, "{} W of {expected}", frame.flux(2));
    assert!(frame.points.iter().filter(|point| point.is_none()).count() > 250, "most rays meet nothing");
}

/// Slots are shared out by power, and every source that shines has one.
#[test]
fn sources_share_slots_by_their_power() {
    let lamps = |powers: &[f32]| {
        let lamp = |(i, power): (usize, &f32)| point_at([0.1 * i as f32, 0.0, 0.2], [*power; 3]);
        room([0.5; 3], powers.iter().enumerate().map(lamp).collect())
    };
    let slots = |frame: &Frame, source: u32| frame.shares.iter().filter(|share| share[0] == source).count();
    let powers = [6.0, 0.0, 3.0, 1e-6, 3.0];
    let Some(frame) = Sampling::of(124, 8).frame(&lamps(&powers), None) else { return };
    let counts: Vec<usize> = (0..5).map(|source| slots(&frame, source)).collect();
    assert_eq!(counts, [61, 0, 31, 1, 31]);
    let expected = 0.5 * 4.0 * PI * 12.000_001;
    assert!((frame.flux(0) / expected - 1.0).abs() < 1e-5, "{} W of {expected}", frame.flux(0));

    // With more sources than lights, those that have one stand for all.
    for count in [1, 2, 3] {
        let sampling = Sampling::of(count, 1);
        let frame = sampling.frame(&lamps(&[1.0, 5.0, 1.0, 2.0]), None).expect("the adapter is still there");
        let expected = 0.5 * 4.0 * PI * 9.0;
        let found = luminance(&frame);
        assert!((found / expected - 1.0).abs() < 1e-4, "{count} lights: {found} W of {expected}");
    }
}
