//! Scenes without lights or surfaces, sources on walls, and numbers at their ends.

use super::{Sampling, WAITING, assert_finite, lamp_at, light, lit, point_at, room};
use interfaces::surface_points::SurfacePoint;
use interfaces::virtual_lights::VirtualLight;
use scene::{LightKind, Scene};
use std::f64::consts::PI;

/// Runs four frames and asserts that all is finite after the first and the last of them.
fn checked(scene: &Scene, sampling: Sampling) -> Option<(Vec<SurfacePoint>, Vec<VirtualLight>)> {
    for frames in [1, 4] {
        let outputs = sampling.harness(scene).feedback("past", "points").frames(frames).run()?;
        let (points, lights) = (outputs.surface_points("points").1, outputs.lights("lights"));
        assert_eq!((points.len(), lights.len()), (sampling.count as usize, sampling.count as usize));
        assert_finite(&lights);
        if frames == 4 {
            return Some((points, lights));
        }
    }
    None
}

#[test]
fn without_light_or_surfaces_all_is_dark() {
    let spot = LightKind::Spot { inner: 0.5, outer: 0.5 };
    let mut scenes = vec![pass_test::scene("empty"), room([0.5; 3], vec![]), lamp_at([0.0; 3])];
    scenes[2].lights[0].intensity = glam::Vec3::ZERO;
    let mut away = pass_test::scene("plane");
    away.lights = vec![light(spot, [0.0, 0.5, 0.0], [0.0, 1.0, 0.0], [1.0; 3])];
    scenes.push(away);
    let sun = light(LightKind::Directional, [0.0; 3], [0.0, -1.0, 0.0], [1.0; 3]);
    scenes.push(lit(pass_test::scene("empty"), vec![point_at([0.0; 3], [1.0; 3]), sun]));
    for scene in &scenes {
        let Some((points, lights)) = checked(scene, Sampling::of(65, 8)) else { return };
        assert!(lights.iter().all(|light| light.flux == [0.0; 3] && light.area == 0.0));
        assert!(points.iter().all(SurfacePoint::is_none));
    }
}

/// A source that is switched on gets lights, at most `moved` in a frame; one that is switched off leaves none.
#[test]
fn sources_are_switched_on_and_off() {
    let on = lamp_at([0.3, 0.0, 0.0]);
    let mut off = on.clone();
    off.lights[0].intensity = glam::Vec3::ZERO;
    let sampling = Sampling::of(64, 16);
    let Some(mut frame) = sampling.frame(&off, None) else { return };
    assert_eq!((frame.header.marked, frame.waiting()), (0, 0));
    for left in [48, 32, 16, 0] {
        frame = sampling.frame(&on, Some(&frame.points)).expect("the adapter is still there");
        assert_eq!((frame.header.marked, frame.waiting()), (16, left));
        assert!((frame.flux(0) / (2.0 * PI) - 1.0).abs() < 1e-5, "few lights carry all flux");
    }
    frame = sampling.frame(&off, Some(&frame.points)).expect("the adapter is still there");
    assert!(frame.points.iter().all(SurfacePoint::is_none));
    assert_eq!(frame.flux(0), 0.0);
}

/// Sources that lose all their lights at once get new ones in turn, and not one source all before the others.
#[test]
fn sources_recover_together() {
    let lamps =
        |x: f32| room([0.5; 3], vec![point_at([x, 0.0, 0.0], [1.0; 3]), point_at([0.0, x, 0.1], [1.0; 3])]);
    let sampling = Sampling::of(64, 8);
    let lost = vec![SurfacePoint::NONE; 64];
    let Some(frame) = sampling.frame(&lamps(0.3), Some(&lost)) else { return };
    assert_eq!(frame.waiting(), 56);
    for slots in [0..32, 32..64] {
        let placed = frame.sites[slots].iter().filter(|site| site[3] != WAITING).count();
        assert!((3..=5).contains(&placed), "{placed} of a source");
    }
}

/// The first of many lights has the cell of all: its sums do not overflow.
#[test]
fn the_first_of_many_lights_has_all_of_the_flux() {
    let lost = vec![SurfacePoint::NONE; 2000];
    let Some(frame) = Sampling::of(2000, 1).frame(&lamp_at([0.3; 3]), Some(&lost)) else { return };
    assert_eq!(frame.cells.iter().map(|cell| cell[0]).max(), Some(128_000));
    assert!((frame.flux(0) / (2.0 * PI) - 1.0).abs() < 1e-4, "{}", frame.flux(0));
}

#[test]
fn one_light_has_all_of_the_flux() {
    let sampling = Sampling { count: 1, moved: 256, probes: 1 };
    let Some((points, lights)) = checked(&lamp_at([0.5, 0.5, 0.5]), sampling) else { return };
    assert_eq!(points[0].mark, 0, "there is no better place for one light");
    assert!((f64::from(lights[0].flux[0]) / (2.0 * PI) - 1.0).abs() < 1e-5);
}

/// Lamps in a wall, in a corner and outside; numbers at the ends of their range; scenes far away and tiny.
#[test]
fn everything_stays_finite() {
    let spot = LightKind::Spot { inner: 0.0, outer: 1e-3 };
    let scenes = [
        lamp_at([1.0, 0.2, 0.3]),
        lamp_at([1.0, 1.0, 1.0]),
        lamp_at([5.0, 0.0, 0.0]),
        lamp_at([1e25, 1e25, -1e25]),
        room([1.0; 3], vec![point_at([0.0; 3], [3e38; 3]), point_at([0.1; 3], [3e38; 3])]),
        room([1.0; 3], vec![point_at([0.0; 3], [1e-38; 3]), point_at([0.1; 3], [1e-44, 0.0, 0.0])]),
        room([0.0; 3], vec![point_at([0.0; 3], [1.0; 3])]),
        room([0.5; 3], vec![light(spot, [0.0; 3], [0.0, 0.0, 1.0], [1.0; 3])]),
        room(
            [0.5; 3],
            vec![light(LightKind::Spot { inner: 0.0, outer: 1e-5 }, [0.0; 3], [0.0, 0.0, 1.0], [1.0; 3])],
        ),
    ];
    for scene in &scenes {
        let Some(_) = checked(scene, Sampling::of(50, 7)) else { return };
        for scale in [1e-6, 1e6] {
            let mut scaled = scene.clone();
            for vertex in &mut scaled.vertices {
                vertex.position = vertex.position.map(|x| x * scale);
            }
            for light in &mut scaled.lights {
                light.position *= scale.min(1e3);
            }
            let _ = checked(&scaled, Sampling::of(50, 7));
        }
    }
}
