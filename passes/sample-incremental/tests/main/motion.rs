//! Lights that are lost as sources and surfaces move, and the frames until all are well placed again.

use super::{Frame, Sampling, lamp_at, light, lit, room};
use glam::Vec3;
use interfaces::surface_points::SurfacePoint;
use pass_test::rooms::{furnace, matte, quad};
use scene::{LightKind, Scene};

/// The closed room with a screen in it, behind all that was there, or with a screen far outside.
fn screened(is_inside: bool) -> Scene {
    let x = if is_inside { 0.5 } else { 30.0 };
    let screen = pass_test::rooms::room(
        &[quad([x, -0.4, -0.4], [0.0, 0.8, 0.0], [0.0, 0.0, 0.8], 0)],
        vec![matte([0.5; 3], [0.0; 3])],
    );
    let mut scene = furnace([0.0; 3], [0.5; 3]);
    let first = scene.vertices.len() as u32;
    scene.vertices.extend(screen.vertices);
    scene.indices.extend(screen.indices.iter().map(|i| first + i));
    scene.instances[0].vertex_count = scene.vertices.len() as u32;
    scene.instances[0].index_count = scene.indices.len() as u32;
    scene.lights = lamp_at([0.0; 3]).lights;
    scene
}

/// A light to which the ray is blocked goes, at most as many in a frame as may; until then its slot is dark. All others stay.
#[test]
fn lights_that_are_hidden_are_replaced() {
    let sampling = Sampling::of(300, 5);
    let Some(start) = sampling.frame(&screened(false), None) else { return };
    let is_hidden = |point: &SurfacePoint| {
        let [x, y, z] = point.position;
        x > 0.9 && (y / x).abs() < 0.8 && (z / x).abs() < 0.8
    };
    let hidden: Vec<usize> = (0..300).filter(|i| is_hidden(&start.points[*i])).collect();
    assert!(hidden.len() > 20, "{}", hidden.len());
    let mut frame = sampling.frame(&screened(true), Some(&start.points)).expect("the adapter is still there");
    assert_eq!(frame.waiting(), hidden.len() - 5);
    assert_eq!(frame.changed(&start.points), hidden);
    let dark = |frame: &Frame| frame.lights.iter().filter(|light| light.flux == [0.0; 3]).count();
    assert_eq!(dark(&frame), hidden.len() - 5);
    let power = 0.5 * 4.0 * std::f64::consts::PI;
    // What is left shares all of the light.
    assert!((frame.flux(0) / power - 1.0).abs() < 1e-5, "{}", frame.flux(0));
    for waiting in (0..hidden.len() - 5).rev().step_by(5) {
        assert!(frame.waiting() > 0, "{waiting}");
        frame = sampling.frame(&screened(true), Some(&frame.points)).expect("the adapter is still there");
    }
    assert_eq!((frame.waiting(), dark(&frame)), (0, 0), "after I / moved frames all are placed");
    for point in &frame.points {
        assert!(!is_hidden(point), "{point:?}");
    }
    // Those that were not hidden have not moved while others waited.
    let stayed = (0..300).filter(|i| frame.points[*i].position == start.points[*i].position).count();
    assert!(stayed >= 300 - hidden.len() - 5, "{stayed} stayed");
}

/// A spot that turns loses what leaves its cone, and nothing else.
#[test]
fn lights_outside_the_cone_are_lost() {
    let kind = LightKind::Spot { inner: 0.4, outer: 0.5 };
    let spot = |direction: [f32; 3]| room([0.5; 3], vec![light(kind, [0.0; 3], direction, [5.0; 3])]);
    let (before, after) = ([1.0, 0.0, 0.0], [1.0, 0.3, 0.0]);
    let sampling = Sampling::of(200, 1);
    let Some(start) = sampling.frame(&spot(before), None) else { return };
    let frame = sampling.frame(&spot(after), Some(&start.points)).expect("the adapter is still there");
    let axis = Vec3::from(after).normalize();
    let cosine = |point: &SurfacePoint| Vec3::from(point.position).normalize().dot(axis);
    let outside = start.points.iter().filter(|point| cosine(point) < 0.5_f32.cos()).count();
    assert!(outside > 20 && outside < 150, "{outside}");
    assert_eq!(frame.waiting() + 1, outside);
    assert!(frame.points.iter().all(|point| point.is_none() || cosine(point) > 0.5_f32.cos() - 1e-4));
}

/// A source that comes to the other side of a surface takes its lights to that side.
#[test]
fn lights_face_their_source() {
    let mut scene = pass_test::scene("plane");
    let lamp = |y: f32| vec![super::point_at([0.0, y, 0.0], [1.0; 3])];
    scene.lights = lamp(0.5);
    let sampling = Sampling::of(128, 16);
    let Some(start) = sampling.frame(&scene, None) else { return };
    assert!(start.points.iter().all(|point| point.is_none() || point.normal[1] > 0.0));
    scene.lights = lamp(-0.5);
    let mut frame = start.clone();
    for _ in 0..8 {
        frame = sampling.frame(&scene, Some(&frame.points)).expect("the adapter is still there");
    }
    assert_eq!(frame.waiting(), 0);
    assert!(frame.points.iter().all(|point| point.is_none() || point.normal[1] < 0.0));
    assert!((frame.flux(0) / start.flux(0) - 1.0).abs() < 0.15, "{} W of {}", frame.flux(0), start.flux(0));
}

/// A ray that met nothing keeps its place until something comes in its way: then that gets lights.
#[test]
fn what_comes_into_the_open_gets_lights() {
    let above = |y: f32| {
        let floor = quad([-1.0, 0.0, -1.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0], 0);
        let screen = quad([-0.5, y, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], 0);
        let surfaces = pass_test::rooms::room(&[floor, screen], vec![matte([0.5; 3], [0.0; 3])]);
        lit(surfaces, vec![super::point_at([0.0, 0.5, 0.0], [1.0; 3])])
    };
    // Hidden below the floor at first.
    let (before, after) = (above(-0.5), above(1.0));
    let sampling = Sampling::of(200, 40);
    let Some(start) = sampling.at_rest(&before, 10) else { return };
    let meets_screen = |point: &SurfacePoint| {
        let way = -Vec3::from(point.normal);
        point.is_none() && way.y > 0.0 && way.x.abs().max(way.z.abs()) < way.y
    };
    let lost = start.points.iter().filter(|point| meets_screen(point)).count();
    assert!((20..=40).contains(&lost), "{lost}");
    let frame = sampling.frame(&after, Some(&start.points)).expect("the adapter is still there");
    assert_eq!(frame.waiting(), 0);
    assert!(!frame.points.iter().any(meets_screen));
    let on_screen = frame.points.iter().filter(|point| !point.is_none() && point.triangle >= 2).count();
    assert!(on_screen.abs_diff(lost) <= lost / 3, "{on_screen} lights where {lost} rays met nothing");
}

/// The relative spread of the areas of cells: their standard deviation over their mean.
fn unevenness(frame: &Frame) -> f64 {
    let cells: Vec<f64> = frame.cells.iter().map(|cell| f64::from(cell[0])).collect();
    let mean = cells.iter().sum::<f64>() / cells.len() as f64;
    (cells.iter().map(|cell| (cell - mean).powi(2)).sum::<f64>() / cells.len() as f64).sqrt() / mean
}

/// A lamp that jumps across the room keeps all lights, which crowd in its sight; after I / moved frames they are spread again.
#[test]
fn lights_spread_again_after_a_jump() {
    let sampling = Sampling::of(256, 16);
    let Some(rest) = sampling.at_rest(&lamp_at([-0.6, -0.5, 0.1]), 40) else { return };
    let there = lamp_at([0.6, 0.7, -0.2]);
    let mut frame = sampling.frame(&there, Some(&rest.points)).expect("the adapter is still there");
    assert_eq!(frame.waiting(), 0, "nothing hides a wall of the room");
    let jumped = unevenness(&frame);
    for _ in 1..256 / 16 {
        frame = sampling.frame(&there, Some(&frame.points)).expect("the adapter is still there");
    }
    let after = unevenness(&frame);
    assert!(jumped > 0.6, "{jumped}");
    assert!(
        after < 0.35 && after < 1.5 * unevenness(&rest),
        "{after} after {jumped}; at rest {}",
        unevenness(&rest)
    );
}

/// Lights ride on what they lie on.
#[test]
fn lights_follow_their_triangles() {
    let mut scene = lamp_at([0.1, 0.0, 0.0]);
    let sampling = Sampling::of(64, 1);
    let Some(start) = sampling.frame(&scene, None) else { return };
    for vertex in &mut scene.vertices {
        vertex.position[1] += 0.02;
    }
    let frame = sampling.frame(&scene, Some(&start.points)).expect("the adapter is still there");
    let rode = std::iter::zip(&start.points, &frame.points).filter(|(a, b)| {
        let way = Vec3::from(b.position) - Vec3::from(a.position);
        way.distance(Vec3::new(0.0, 0.02, 0.0)) < 1e-5
    });
    assert!(rode.count() >= 63, "all but the one that may be placed");
}
