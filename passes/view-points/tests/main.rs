//! Points against what the camera sees at their places of the image.

use glam::{Vec2, Vec3};
use interfaces::progress::Progress;
use interfaces::surface_points::{self, SurfacePoint, SurfacePointsHeader, packed_albedo};
use pass::FromWgsl;
use pass_test::{Harness, elements, scene};
use ray_tracing::Bvh;
use scene::{Camera, Scene};
use std::collections::HashSet;
use view_points::PASS;

/// Moves points to where their triangles are.
const FOLLOWED: FromWgsl = FromWgsl::new("followed", "passes/view-points/tests");

type Points = (SurfacePointsHeader, Vec<SurfacePoint>);

fn run(harness: Harness<'_>) -> Option<Points> {
    Some(harness.run()?.surface_points("points"))
}

fn corners(scene: &Scene, triangle: u32) -> [Vec3; 3] {
    [0, 1, 2].map(|k| {
        let vertex = scene.indices[3 * triangle as usize + k];
        Vec3::from(scene.vertices[vertex as usize].position)
    })
}

fn hierarchy(scene: &Scene) -> Bvh {
    let positions: Vec<[f32; 3]> = scene.vertices.iter().map(|vertex| vertex.position).collect();
    Bvh::build(&positions, &scene.indices)
}

/// Asserts that the camera sees each point, on the triangle, the side and the material that it says.
fn assert_seen(scene: &Scene, camera: &Camera, points: &[SurfacePoint]) {
    let bvh = hierarchy(scene);
    for (i, point) in points.iter().enumerate().filter(|(_, point)| !point.is_none()) {
        let [a, b, c] = corners(scene, point.triangle);
        let [u, v] = point.barycentrics;
        let (position, normal) = (Vec3::from(point.position), Vec3::from(point.normal));
        let off = position.distance(a + (b - a) * u + (c - a) * v);
        assert!(u >= 0.0 && v >= 0.0 && u + v <= 1.0 + 1e-6 && off < 1e-5 * scene.extent(), "{i}: {point:?}");
        let way = position - camera.position;
        assert!(normal.dot(way) < 0.0 && (normal.length() - 1.0).abs() < 1e-5, "{i}: {point:?}");
        assert!(normal.dot((b - a).normalize()).abs() < 1e-4, "{i}: {point:?}");
        let along = way.dot(camera.forward());
        assert!(along >= camera.near, "{i}: {along} before the near plane");
        let nearest = camera.near / along;
        assert!(!bvh.occluded(camera.position, way, nearest, 0.9999), "{i}: something hides {point:?}");
        let material = scene.vertices[scene.indices[3 * point.triangle as usize] as usize].material;
        let material = &scene.materials[material as usize];
        let albedo = material.base_color.truncate() * (1.0 - material.metallic);
        assert_eq!(point.albedo, packed_albedo(albedo.to_array().map(f64::from)), "{i}: {albedo}");
        assert_eq!(point.mark, 0);
    }
}

pass_test::shaders_are_valid!(PASS);

#[test]
fn the_camera_sees_every_point() {
    for name in ["cornell-box", "atrium-spot"] {
        let scene = scene(name);
        let harness = Harness::new(PASS).scene(name).frame(64, 48).set("count", 100).set("rate", 7);
        let Some((header, points)) = run(harness) else { return };
        assert_eq!((header.count, header.iteration, points.len()), (700, 0, 700));
        assert_seen(&scene, &scene.at(0.0).camera, &points);
        let there = points.iter().filter(|point| !point.is_none()).count();
        // The box is a square in the middle of the picture.
        assert!(there > 450, "{there} of 700 points");
        let seeds: HashSet<u32> = points.iter().map(|point| point.seed).collect();
        assert!(seeds.len() >= there, "points share seeds");
    }
}

/// The camera of `Harness::view`: a wall fills its picture.
fn before_a_wall(near: f32) -> (Scene, Camera) {
    let wall = |z: f32| [[-9.0, -9.0, z], [9.0, -9.0, z], [0.0, 20.0, z]];
    let mut corners = wall(-2.0).to_vec();
    corners.extend(wall(-0.5));
    (pass_test::soup(&corners), Camera { near, ..pass_test::view::CAMERA })
}

/// Of 2^m points each of 2^m equal parts of the image has one, and where a point lies is where the camera projects it to.
#[test]
fn points_are_stratified_over_the_image() {
    let (scene, camera) = before_a_wall(0.1);
    let size = [96, 64];
    for iteration in 0..3 {
        let harness = Harness::new(PASS).with_scene(scene.clone()).camera(camera).frame(size[0], size[1]);
        let Some((_, points)) = run(harness.frame_index(iteration).set("count", 1024).set("rate", 4)) else {
            return;
        };
        assert_seen(&scene, &camera, &points);
        for (columns, rows) in [(64, 64), (16, 256), (1024, 4)] {
            let mut cells = vec![0; columns * rows];
            for point in &points {
                let at = camera.project(Vec3::from(point.position), size).expect("before the camera");
                let at = at / Vec2::new(size[0] as f32, size[1] as f32);
                let at = (at * Vec2::new(columns as f32, rows as f32)).floor();
                cells[(at.y as usize).min(rows - 1) * columns + (at.x as usize).min(columns - 1)] += 1;
            }
            // A point at a side of a cell may be projected to the other side.
            let other = cells.iter().filter(|count| **count != 1).count();
            assert!(other < 40, "{other} of {columns}×{rows} cells have none or several");
        }
    }
}

#[test]
fn nothing_before_the_near_plane_is_seen() {
    for (near, seen) in [(0.4, -0.5), (0.6, -2.0)] {
        let (scene, camera) = before_a_wall(near);
        let Some((_, points)) = run(Harness::new(PASS).with_scene(scene).camera(camera).set("count", 32))
        else {
            return;
        };
        assert!(points.iter().all(|point| (point.position[2] - seen).abs() < 1e-6), "near plane at {near}");
    }
}

#[test]
fn where_nothing_is_seen_there_is_no_point() {
    let away = Camera { target: Vec3::Z, ..pass_test::view::CAMERA };
    let (scene, _) = before_a_wall(0.1);
    for harness in [Harness::new(PASS), Harness::new(PASS).with_scene(scene).camera(away)] {
        let Some((_, points)) = run(harness.set("count", 5)) else { return };
        assert_eq!(points, [SurfacePoint::NONE; 80]);
    }
}

/// Surfaces cut out by a mask are not seen.
#[test]
fn masked_surfaces_are_not_seen() {
    let (mut scene, camera) = before_a_wall(0.1);
    scene.materials[0].alpha_cutoff = Some(0.5);
    scene.materials[0].base_color.w = 0.25;
    let Some((_, points)) = run(Harness::new(PASS).with_scene(scene).camera(camera).set("count", 4)) else {
        return;
    };
    assert!(points.iter().all(SurfacePoint::is_none));
}

/// A texture counts as its mean in linear light: half of black and white texels.
#[test]
fn textures_count_as_their_mean() {
    let (mut scene, camera) = before_a_wall(0.1);
    let texels = |of: [[u8; 4]; 4]| scene::Texture {
        name: String::new(),
        width: 2,
        height: 2,
        pixels: of.concat(),
        encoding: scene::Encoding::Srgb,
        wrap: [scene::Wrap::Repeat; 2],
    };
    let (black, white) = ([0, 0, 0, 255], [255; 4]);
    scene.textures = vec![texels([black, white, white, black])];
    scene.materials[0].base_color = glam::Vec4::new(0.8, 0.4, 1.0, 1.0);
    scene.materials[0].base_color_texture = Some(0);
    let Some((_, points)) = run(Harness::new(PASS).with_scene(scene).camera(camera).set("count", 4)) else {
        return;
    };
    for point in points {
        for (found, expected) in std::iter::zip(point.albedo(), [0.4, 0.2, 0.5]) {
            // A texel has eight bits.
            assert!((found - expected).abs() < 0.005, "{found} for {expected}");
        }
    }
}

#[test]
fn every_iteration_has_other_points() {
    let harness = || Harness::new(PASS).scene("cornell-box").set("count", 16);
    let frame = |index: u32, vary: bool| run(harness().frame_index(index).set("vary", vary));
    let Some(first) = frame(0, true) else { return };
    let next = frame(1, true).unwrap();
    let same =
        std::iter::zip(&first.1, &next.1).filter(|(a, b)| a.position == b.position || a.seed == b.seed);
    assert_eq!((same.count(), next.0.iteration), (0, 1));
    let (fixed, later) = (frame(0, false).unwrap(), frame(7, false).unwrap());
    assert_eq!((&fixed.1, &fixed.1), (&later.1, &first.1));
    assert_eq!((fixed.0.iteration, later.0.iteration), (0, 0), "nor has what follows from them");
    let other = run(harness().seed(5)).unwrap();
    assert_ne!(other.1, first.1);
}

/// Iterations count on from the past, not from the frame's number, which stands still where frames are repeated.
#[test]
fn iterations_follow_the_past() {
    let harness = || Harness::new(PASS).scene("cornell-box").set("count", 16);
    let Some(first) = run(harness().frame_index(0)) else { return };
    let looped =
        |frames: u32| run(harness().feedback("past", "points").frame_index(90).frames(frames)).unwrap();
    assert_eq!(looped(1), first);
    let third = looped(3);
    assert_eq!(third, run(harness().frame_index(2)).unwrap());
    let past = SurfacePoint::default();
    let of_another = run(harness().surface_points("past", 1, &[past])).unwrap();
    assert_eq!(of_another, third, "the past may be of another number of points");
}

/// Iterations before that of the picture have the first quarter of the points; the rest of the room is empty.
#[test]
fn iterations_that_no_picture_shows_have_fewer_points() {
    let harness = |rate: u32| Harness::new(PASS).scene("cornell-box").set("count", 10).set("rate", rate);
    let of = |step: u32, steps: u32, rate: u32| {
        let progress = Progress { step, steps, ..Progress::default() };
        let outputs = harness(rate).input("progress", "Progress", &[], elements(&[progress])).run()?;
        let mut bytes: Vec<u8> = outputs.read("points");
        let header = outputs.surface_points("points").0;
        // As if all of the room were of points.
        bytes[..4].copy_from_slice(&(10 * rate).to_le_bytes());
        Some((header, surface_points::from_bytes(&bytes)?.1))
    };
    for (rate, few) in [(16, 40), (3, 8)] {
        let Some((_, all)) = run(harness(rate)) else { return };
        for (step, steps) in [(0, 24), (22, 24)] {
            let (header, found) = of(step, steps, rate).unwrap();
            assert_eq!(header.count, few, "{step} of {steps}");
            assert_eq!(found[..few as usize], all[..few as usize], "{step} of {steps}");
            assert!(found[few as usize..].iter().all(SurfacePoint::is_none), "{step} of {steps}");
        }
        // The next is the last, nothing is known yet, or pictures have been shown.
        for (step, steps) in [(23, 24), (0, 0), (0, 1), (24, 24), (900, 24)] {
            let (header, found) = of(step, steps, rate).unwrap();
            assert_eq!((header.count as usize, &found), (all.len(), &all), "{step} of {steps}");
        }
    }
}

#[test]
fn points_follow_their_triangles() {
    let name = "cornell-box-cloth";
    let at = |time: f32| {
        let mut scene = scene(name);
        for moved in scene.at(time).moved {
            let first = moved.first_vertex as usize;
            scene.vertices[first..first + moved.vertices.len()].copy_from_slice(&moved.vertices);
        }
        scene
    };
    let (begin, end) = (0.3, 1.1);
    let Some((_, mut points)) = run(Harness::new(PASS).scene(name).time(begin).set("count", 200)) else {
        return;
    };
    assert_seen(&at(begin), &scene(name).camera, &points);
    // Some are reached from the other side.
    for point in points.iter_mut().step_by(2) {
        point.normal = point.normal.map(|x| -x);
    }
    let follow = |time: f32| {
        let harness = Harness::new(&FOLLOWED).scene(name).time(time);
        harness.surface_points("points", 0, &points).run().unwrap().surface_points("now").1
    };
    assert_eq!(follow(begin), points, "where nothing moves, no bit changes");
    let after = follow(end);
    let scene = at(end);
    let mut moved = 0;
    for (before, after) in std::iter::zip(&points, &after) {
        if before.is_none() {
            assert_eq!(before, after);
            continue;
        }
        moved += usize::from(before.position != after.position);
        let same = SurfacePoint { position: before.position, normal: before.normal, ..*after };
        assert_eq!(same, *before, "all else stays");
        let [a, b, c] = corners(&scene, after.triangle);
        let [u, v] = after.barycentrics;
        let off = Vec3::from(after.position).distance(a + (b - a) * u + (c - a) * v);
        assert!(off < 2e-6 * scene.extent(), "{before:?} {after:?}");
        let (normal, old) = (Vec3::from(after.normal), Vec3::from(before.normal));
        let of_triangle = (b - a).cross(c - a).normalize();
        let side = if old.dot(of_triangle) < 0.0 { -of_triangle } else { of_triangle };
        assert!(normal.distance(side) < 1e-4, "{before:?} {after:?}");
    }
    assert!(moved > 100, "{moved} points are on the cloth");
}
