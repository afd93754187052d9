//! Points on both sides of a wall.

use glam::{Vec2, Vec3};
use interfaces::surface_points::SurfacePoint;
use pass_test::rooms::{matte, point_on, quad, room};
use pass_test::{Harness, elements};
use reach_view::PASS;
use scene::Scene;

pass_test::shaders_are_valid!(PASS);

/// A floor, a ceiling 1 m above it, and a wall between them at x = 0.
fn two_rooms() -> Scene {
    let quads = [
        quad([-1.0, 0.0, -1.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0], 0),
        quad([-1.0, 1.0, -1.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0], 0),
        quad([0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [0.0, 0.0, 2.0], 0),
    ];
    room(&quads, vec![matte([0.5; 3], [0.0; 3])])
}

/// Points of the floor (triangle 0) or the ceiling (2), as they face the room between.
fn points(scene: &Scene, triangle: u32, count: u32) -> Vec<SurfacePoint> {
    let place = |i: u32| {
        let along = (i as f32 + 0.5) / count as f32;
        Vec2::new(along * 0.5, 0.4 * along)
    };
    (0..count).map(|i| point_on(scene, triangle, place(i), Vec3::new(0.0, 0.5, 0.0), i)).collect()
}

fn reached(
    scene: &Scene,
    of: &[SurfacePoint],
    nearest: &[u32],
    view: &[SurfacePoint],
    tries: u32,
) -> Option<Vec<SurfacePoint>> {
    let outputs = Harness::new(PASS)
        .with_scene(scene.clone())
        .set("tries", tries)
        .surface_points("points", 9, of)
        .surface_points_before("view", 9, view, &vec![SurfacePoint::NONE; 99 * view.len()])
        .input("nearest", "Owners", &[("count", nearest.len() as u32)], elements(nearest))
        .run()?;
    let (header, found) = outputs.surface_points("reached");
    assert_eq!((header.count, header.iteration), (of.len() as u32, 9));
    Some(found)
}

/// What is seen stays to the bit, in its place; nothing is seen through the wall, however many points are asked.
#[test]
fn nothing_is_reached_through_a_wall() {
    let scene = two_rooms();
    let left = |point: &SurfacePoint| point.position[0] < 0.0;
    let mut view = points(&scene, 0, 200);
    view.retain(left);
    let ceiling = points(&scene, 2, 300);
    assert!(
        view.len() > 50 && ceiling.iter().filter(|point| !left(point)).count() > 50,
        "both sides have points"
    );
    for tries in [0, 3, 64] {
        let nearest: Vec<u32> = (0..300).map(|i| i % view.len() as u32).collect();
        let Some(found) = reached(&scene, &ceiling, &nearest, &view, tries) else { return };
        for (i, (point, found)) in ceiling.iter().zip(&found).enumerate() {
            assert_eq!(found.is_none(), !left(point), "{tries} tries, point {i}: {point:?}");
            assert!(found.is_none() || found == point, "point {i} is as it was");
        }
    }
}

/// Where the first point in view is hidden, or there is none, others find what they see, more of it the more of them are asked.
#[test]
fn others_are_asked_where_the_first_is_hidden() {
    let scene = two_rooms();
    let view = points(&scene, 0, 200);
    let hidden = view.iter().position(|point| point.position[0] > 0.1).unwrap() as u32;
    let mut ceiling = points(&scene, 2, 300);
    ceiling.retain(|point| point.position[0] < -0.1);
    for first in [hidden, u32::MAX] {
        let nearest = vec![first; ceiling.len()];
        let mut before = 0;
        for (tries, least) in [(0, 0.0), (1, 0.2), (16, 0.99)] {
            let Some(found) = reached(&scene, &ceiling, &nearest, &view, tries) else { return };
            let kept = found.iter().filter(|point| !point.is_none()).count();
            assert!(
                kept as f64 >= least * ceiling.len() as f64 && (tries > 0 || kept == 0),
                "{tries} tries: {kept}"
            );
            assert!(kept >= before, "{tries} tries: {kept}, {before} with fewer");
            before = kept;
        }
    }
}

/// Empty points stay empty, and a view of nothing reaches nothing.
#[test]
fn nothing_reaches_nothing() {
    let scene = two_rooms();
    let some = points(&scene, 2, 3);
    let none = vec![SurfacePoint::NONE; 3];
    for (of, view) in [(&none, &some), (&some, &none)] {
        let Some(found) = reached(&scene, of, &[0, 1, 2], view, 8) else { return };
        assert!(found.iter().all(SurfacePoint::is_none), "{found:?}");
    }
}

/// A point in view is asked by itself: whether its neighbours in the list are there does not matter.
#[test]
fn a_point_that_is_not_there_hides_no_other() {
    let scene = two_rooms();
    let seen =
        points(&scene, 0, 200).into_iter().find(|point| point.position[0] < -0.1).expect("one of the room");
    let mut ceiling = points(&scene, 2, 300);
    ceiling.retain(|point| point.position[0] < -0.1);
    let none = SurfacePoint::NONE;
    for (view, nearest, is_reached) in [(vec![none, seen, none], 1, true), (vec![seen, none, seen], 1, false)]
    {
        let nearest = vec![nearest; ceiling.len()];
        let Some(found) = reached(&scene, &ceiling, &nearest, &view, 0) else { return };
        assert!(found.iter().all(|point| point.is_none() != is_reached), "{view:?}: {found:?}");
    }
}
