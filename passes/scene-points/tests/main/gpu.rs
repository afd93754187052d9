//! The shader against the CPU reference, on a GPU.

use crate::cpu_reference;
use glam::{DVec3, Vec3};
use pass_test::random::{hash2, unit_float};
use pass_test::{Harness, soup};
use scene::Scene;
use scene_points::PASS;

wgsl_structs::wgsl! {
    "../../shaders/points.wgsl" {
        struct Point;
    }
}

fn run(scene: Scene, count: u32, seed: u32) -> Option<Vec<Point>> {
    Some(Harness::new(PASS).with_scene(scene).set("count", count).seed(seed).run()?.read("points"))
}

fn precise(v: [f32; 3]) -> DVec3 {
    Vec3::from(v).as_dvec3()
}

/// Compares with the CPU reference; lengths relative to the largest coordinate.
fn compare(scene: Scene, count: u32, seed: u32) {
    let Some(points) = run(scene.clone(), count, seed) else { return };
    assert_eq!(points.len(), count as usize);
    let table = scene.area_table();
    let largest =
        scene.vertices.iter().flat_map(|v| v.position).fold(0.0, |m: f64, x| m.max(f64::from(x.abs())));
    let seed = pass::pass_seed(seed, "scene-points");
    let corner = |triangle: u32, k: u32| {
        let vertex = &scene.vertices[scene.indices[(3 * triangle + k) as usize] as usize];
        precise(vertex.position)
    };
    for (i, point) in (0..).zip(&points) {
        let expected =
            cpu_reference::place(cpu_reference::numbers(i, [hash2(seed, 0), hash2(seed, 1)]), &table, corner);
        assert_eq!(point.triangle, expected.triangle, "point {i}");
        let barycentric = [point.barycentric & 0xffff, point.barycentric >> 16];
        assert!(barycentric[0] + barycentric[1] <= 65535, "point {i}: {barycentric:?}");
        for (found, expected) in std::iter::zip(barycentric, expected.barycentric) {
            // Single precision may round to the neighbour.
            assert!(found.abs_diff(expected) <= 1, "point {i}: {point:?} {expected:?}");
        }
        let near = precise(point.position).abs_diff_eq(expected.position, 4e-5 * largest)
            && precise(point.normal).abs_diff_eq(expected.normal, 1e-4);
        assert!(near, "point {i}: {point:?} {expected:?}");
    }
}

#[test]
fn points_are_those_of_the_cpu_reference() {
    compare(pass_test::scene("cornell-box"), 20_000, 0);
    compare(pass_test::scene("atrium"), 20_000, 9);
}

#[test]
fn triangles_of_any_shape_at_any_scale() {
    for scale in [1e-3, 1.0, 1e6] {
        let mut corners: Vec<[f32; 3]> =
            (0..90).map(|i| [0, 1, 2].map(|c| scale * unit_float(hash2(i, c)) as f32)).collect();
        // Two corners alike, first, in the middle and last: triangles without area.
        for first in [0, 45, 87] {
            corners[first + 1] = corners[first];
        }
        compare(soup(&corners), 5000, 1);
    }
}

#[test]
fn one_triangle_and_none() {
    compare(soup(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), 1000, 0);
    // A scene without area: numbers, but no normal.
    let Some(points) = run(soup(&[[1.0; 3]; 6]), 10, 0) else { return };
    assert!(points.iter().all(|point| point.position == [1.0; 3] && point.normal == [0.0; 3]), "{points:?}");
    let points = run(pass_test::scene("empty"), 10, 0).unwrap_or_default();
    assert_eq!(points, [Point::default(); 10]);
}

#[test]
fn a_seed_is_another_set_of_points() {
    let set = |seed| run(pass_test::scene("plane"), 64, seed);
    let Some(first) = set(1) else { return };
    assert_eq!(Some(&first), set(1).as_ref());
    assert_ne!(Some(&first), set(2).as_ref());
}
