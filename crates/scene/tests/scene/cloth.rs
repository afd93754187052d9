//! The cloth against its closed form.

use std::f64::consts::TAU;

use glam::{DVec3, Vec3};
use scene::Changes;

use crate::common::{assert_trait, built_in, shipped};

/// z and its slopes along x and y: a quarter of a metre (y/h)² sin(π x − 2.5 π y/h − π t), h = 1.5 m.
fn wave(x: f64, y: f64, time: f64) -> (f64, [f64; 2]) {
    let (height, kx, ky) = (1.5, TAU / 2.0, 1.25 * TAU / 1.5);
    let (sin, cos) = (kx * x - ky * y - TAU / 2.0 * time).sin_cos();
    let swing = 0.25 * (y / height).powi(2);
    (swing * sin, [swing * cos * kx, 0.5 * y / (height * height) * sin - swing * cos * ky])
}

#[test]
fn the_cloth_waves_as_its_closed_form_says_and_repeats() {
    let scene = built_in("cloth");
    assert!((scene.triangles(), scene.duration) == (3072, 2.0), "{} triangles", scene.triangles());
    assert_trait(&scene, "moving_geometry", true);
    for time in [0.0f32, 0.03, 0.5, 0.777, 1.0, 1.9, 2.0, 5.3] {
        let pose = scene.at(time);
        for (vertex, rest) in pose.moved[0].vertices.iter().zip(&scene.vertices) {
            let p = Vec3::from(vertex.position).as_dvec3();
            assert_eq!(vertex.position[..2], rest.position[..2], "only z changes");
            let (z, [dx, dy]) = wave(p.x, p.y, f64::from(time));
            assert!((p.z - z).abs() < 3e-6, "{p} at {time} s: expected z = {z}");
            let normal = DVec3::new(-dx, -dy, 1.0).normalize();
            let found = Vec3::from(vertex.normal).as_dvec3();
            assert!(found.abs_diff_eq(normal, 2e-5), "{found} at {p}, {time} s: expected {normal}");
        }
    }
    assert_eq!(scene.changes(0.25, 2.25), Changes::default(), "two seconds later all is the same");
    assert!(scene.changes(0.25, 1.25).geometry, "one second later it is not");
}

#[test]
fn the_cloths_rod_does_not_move_and_its_box_holds_every_swing() {
    let scene = built_in("cloth");
    for time in [0.0, 0.4, 1.3] {
        let moved = &scene.at(time).moved[0].vertices;
        let rod = moved.iter().filter(|v| v.position[1] == 0.0);
        assert_eq!(
            rod.filter(|v| v.position[2] == 0.0 && v.normal == [0.0, 0.0, 1.0]).count(),
            33,
            "{time} s"
        );
    }
    let (min, max) = scene.bounds();
    for (corner, z) in [(min, -0.25), (max, 0.25)] {
        assert!((corner.z - z).abs() < 1e-3, "the free edge swings by a quarter of a metre: {corner}");
    }
}

#[test]
fn the_cloth_hangs_inside_the_box_and_clear_of_its_blocks() {
    let scene = shipped("cornell-box-cloth");
    let (min, max) = scene.bounds();
    assert!(min.abs_diff_eq(Vec3::ZERO, 1e-6) && max.abs_diff_eq(Vec3::new(0.556, 0.5488, 0.5592), 1e-6));
    // The short block is 0.165 m high; the tall one of 0.33 m begins at x = 0.265 m.
    let moving: Vec<_> = scene.instances.iter().filter(|i| i.moves).collect();
    assert_eq!(moving.len(), 1, "the cloth");
    let vertices = |frame: u32| scene.at(scene.frame_time(frame)).moved[0].vertices.clone();
    let (rest, mut farthest) = (vertices(0), 0.0_f32);
    for frame in 0..60 {
        let now = vertices(frame);
        let clear = now.iter().all(|v| v.position[1] > 0.17 && v.position[0] < 0.264);
        assert!(clear, "frame {frame}: through a block");
        let moved = rest.iter().zip(&now).map(|(a, b)| Vec3::from(a.position).distance(b.position.into()));
        farthest = moved.fold(farthest, f32::max);
    }
    assert!(farthest > 0.05, "it swings by {farthest} m");
}
