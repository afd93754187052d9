//! Walks of 50 frames and more, as TCAS §6.2 has them, through nothing.

use glam::Vec3;
use scene::Scene;

use crate::common::{load_path, root, shared, shipped};

/// Returns the free part [0 to 1] of the way from `start` along `way`, before a triangle is met (Möller & Trumbore 1997).
fn free_part(scene: &Scene, start: Vec3, way: Vec3) -> f32 {
    let vertex = |i: u32| Vec3::from(scene.vertices[i as usize].position);
    let hits = scene.indices.chunks_exact(3).filter_map(|corners| {
        let [a, b, c] = [0, 1, 2].map(|k| vertex(corners[k]));
        let (edge, side) = (b - a, c - a);
        let across = way.cross(side);
        let determinant = edge.dot(across);
        let from = start - a;
        let u = from.dot(across) / determinant;
        let around = from.cross(edge);
        let (v, t) = (way.dot(around) / determinant, side.dot(around) / determinant);
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= 0.0).then_some(t)
    });
    hits.fold(1.0, f32::min)
}

fn assert_free(name: &str, scene: &Scene, frames: u16) {
    let camera = |frame: u16| scene.at(f32::from(frame) / 30.0).camera.position;
    for frame in 0..frames {
        let (here, next) = (camera(frame), camera(frame + 1));
        assert!(frame + 1 >= frames || here.distance(next) > 1e-3, "{name}: frame {frame} stands still");
        // As far ahead again: a camera that passes by a wall shows nothing else.
        let free = free_part(scene, here, 2.0 * (next - here));
        assert!(free >= 1.0, "{name}: something is in the way after frame {frame}, at {here}");
    }
}

#[test]
fn walks_go_through_nothing() {
    let walks = [("atrium", 60), ("atrium-lights", 60), ("nave", 60), ("maze", 660), ("corridor", 600)];
    for (name, frames) in walks {
        assert_free(name, &shipped(name), frames);
    }
}

#[test]
fn the_ways_of_rays_are_found() {
    let plane = shipped("plane");
    let corner = |k: usize| Vec3::from(plane.vertices[plane.indices[k] as usize].position);
    let centre = (corner(0) + corner(1) + corner(2)) / 3.0;
    let normal = (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalize();
    let start = centre + normal;
    assert!((free_part(&plane, start, -4.0 * normal) - 0.25).abs() < 1e-5, "through it");
    assert_eq!(free_part(&plane, start, -0.9 * normal), 1.0, "up to it");
    assert_eq!(free_part(&plane, start, 4.0 * normal), 1.0, "away from it");
    assert_eq!(free_part(&plane, start + 10.0 * (corner(1) - corner(0)), -4.0 * normal), 1.0, "beside it");
}

/// The example of the documentation, beside Sponza.
#[test]
fn the_walk_in_sponza_goes_through_nothing() {
    let Some(shared) = shared() else { return };
    let folder = tempfile::tempdir().unwrap();
    let walk = folder.path().join("sponza-walk.ron");
    std::fs::copy(root().join("docs/examples/sponza-walk.ron"), &walk).expect("the example");
    std::fs::copy(shared.join("sponza.glb"), folder.path().join("sponza.glb")).expect("Sponza");
    let scene = load_path(&walk);
    assert_eq!(scene.lights.len(), 6);
    assert_free("sponza-walk", &scene, 60);
}
