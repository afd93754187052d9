//! What the pass stores and what maps get of it, on a GPU.

use crate::algorithm::{level, points};
use glam::{DVec3, Vec3};
use interfaces::points::SurfaceSample;
use pass_test::points::PointsPort;
use pass_test::random::{hash2, unit_float};
use pass_test::{Harness, soup};
use scene::Scene;
use tessellated_points::PASS;

wgsl_structs::wgsl! {
    "../../shaders/lattice-points.wgsl" {
        struct LatticePoint;
    }
}

/// What the pass writes.
struct Stored {
    requested: u32,
    points: Vec<LatticePoint>,
    port: PointsPort,
}

fn run(scene: &Scene, settings: &[(&str, pass::Value)]) -> Option<Stored> {
    let harness = Harness::new(PASS).with_scene(scene.clone());
    let harness = settings.iter().fold(harness, |harness, (name, value)| harness.set(name, value.clone()));
    let words: Vec<u32> = harness.run()?.read("points");
    let points: &[LatticePoint] = bytemuck::cast_slice(&words[4..]);
    let port = PointsPort {
        content: bytemuck::cast_slice(&words).to_vec(),
        module: "shaders/points-tessellated.wgsl",
        block: 32,
    };
    Some(Stored { requested: words[0], points: points[..words[1] as usize].to_vec(), port })
}

fn corners(scene: &Scene) -> Vec<[DVec3; 3]> {
    let position = |index: &u32| Vec3::from(scene.vertices[*index as usize].position).as_dvec3();
    scene.indices.chunks(3).map(|corners| [0, 1, 2].map(|k| position(&corners[k]))).collect()
}

fn area(corners: &[DVec3; 3]) -> f64 {
    0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]).length()
}

/// The lengths of the edges opposite to the corners.
fn edges([a, b, c]: &[DVec3; 3]) -> [f64; 3] {
    [b.distance(*c), a.distance(*c), a.distance(*b)]
}

fn bounds(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, 0.0], |[least, most], x| [least.min(x), most.max(x)])
}

/// The points of all triangles: triangle and barycentric coordinates.
fn expected(scene: &Scene, factors: [u32; 2]) -> Vec<(usize, DVec3)> {
    let triangles = corners(scene);
    let real = || triangles.iter().filter(|corners| area(corners) > 0.0);
    let (areas, lengths) = (bounds(real().map(area)), bounds(real().flat_map(edges)));
    let of = |(index, corners): (usize, &[DVec3; 3])| {
        let outer = edges(corners).map(|edge| level(lengths, edge, factors));
        let inside = level(areas, area(corners), factors);
        let found = if area(corners) > 0.0 { points(outer, inside) } else { Vec::new() };
        found.into_iter().map(move |at| (index, at))
    };
    triangles.iter().enumerate().flat_map(of).collect()
}

#[test]
fn points_are_those_of_the_algorithm() {
    for (name, factors) in
        [("plane", [5, 64]), ("cornell-box", [5, 64]), ("cornell-box", [1, 1]), ("ring", [3, 32])]
    {
        let scene = pass_test::scene(name);
        let factor = |name, k: usize| (name, pass::Value::U32(factors[k]));
        let Some(stored) = run(&scene, &[factor("min_factor", 0), factor("max_factor", 1)]) else { return };
        let expected = expected(&scene, factors);
        let triangles = corners(&scene);
        assert_eq!(
            (stored.points.len(), stored.requested),
            (expected.len(), expected.len() as u32),
            "{name}"
        );
        let mut sums = vec![0.0; triangles.len()];
        for (i, (point, (triangle, at))) in std::iter::zip(&stored.points, &expected).enumerate() {
            assert_eq!(point.triangle as usize, *triangle, "{name}, point {i}");
            let [a, b, c] = triangles[*triangle];
            let position = at.x * a + at.y * b + at.z * c;
            let found = Vec3::from(point.position).as_dvec3();
            assert!(found.abs_diff_eq(position, 1e-4), "{name}, point {i}: {found} {position}");
            let upright = Vec3::from(point.normal).as_dvec3().dot((b - a).cross(c - a).normalize());
            assert!((upright - 1.0).abs() < 1e-4, "{name}, point {i}: {:?}", point.normal);
            sums[*triangle] += f64::from(point.area);
        }
        for (sum, corners) in std::iter::zip(sums, &triangles) {
            assert!((sum - area(corners)).abs() < 1e-4 * area(corners), "{name}: {sum} {}", area(corners));
        }
    }
}

#[test]
fn triangles_of_any_shape_at_any_scale() {
    for scale in [1e-3, 1.0, 1e6] {
        let mut corners: Vec<[f32; 3]> =
            (0..3000).map(|i| [0, 1, 2].map(|c| scale * unit_float(hash2(i, c)) as f32)).collect();
        // Two corners alike, first, in the middle and last: triangles without area, and so without points.
        for first in [0, 1500, 2997] {
            corners[first + 1] = corners[first];
        }
        let scene = soup(&corners);
        let Some(stored) = run(&scene, &[("max_factor", 16_u32.into())]) else { return };
        let expected = expected(&scene, [5, 16]);
        // A level that single precision takes up or down, and rows that then are another.
        let differ = stored.points.len().abs_diff(expected.len());
        assert!(differ * 200 < expected.len(), "{} and {}", stored.points.len(), expected.len());
        let sum: f64 = stored.points.iter().map(|point| f64::from(point.area)).sum();
        assert!((sum / scene.area() - 1.0).abs() < 1e-4, "{sum} of {}", scene.area());
        assert!(stored.points.iter().all(|point| ![0, 500, 999].contains(&point.triangle)));
    }
    let Some(none) = run(&pass_test::scene("empty"), &[]) else { return };
    assert_eq!((none.requested, none.points.len()), (0, 0));
}

#[test]
fn triangles_lose_the_same_share_where_not_all_points_fit() {
    let scene = pass_test::scene("cornell-box");
    let Some(all) = run(&scene, &[]) else { return };
    let count = |points: &[LatticePoint], triangle| {
        points.iter().filter(|point| point.triangle == triangle).count() as f64
    };
    for capacity in [1_u32, 1_000, 30_001] {
        let Some(few) = run(&scene, &[("capacity", capacity.into())]) else { return };
        assert_eq!((few.points.len(), few.requested), (capacity as usize, all.requested));
        let share = f64::from(capacity) / all.points.len() as f64;
        for triangle in 0..scene.triangles() as u32 {
            let (found, wanted) = (count(&few.points, triangle), share * count(&all.points, triangle));
            assert!((found - wanted).abs() <= 1.0, "triangle {triangle}: {found} {wanted}");
        }
        let sum: f64 = few.points.iter().map(|point| f64::from(point.area)).sum();
        assert!(capacity < 1_000 || (sum / scene.area() - 1.0).abs() < 0.05, "{sum} of {}", scene.area());
    }
}

fn of_map(samples: &[SurfaceSample], map: u32) -> impl Iterator<Item = &SurfaceSample> {
    samples.iter().filter(move |sample| sample.map == map && sample.area > 0.0)
}

#[test]
fn every_map_takes_points_of_the_whole_surface() {
    let scene = pass_test::scene("cornell-box");
    let Some(stored) = run(&scene, &[("max_factor", 16_u32.into())]) else { return };
    let all = stored.points.len();
    // Maps that do not fill a block; fewer samples than there are points, and more.
    for (maps, per_map) in [(40, 20_u32), (5, 20_000)] {
        let Some(samples) = stored.port.samples(&scene, 0.0, maps, per_map) else { return };
        let made = all.min((maps * per_map) as usize);
        assert_eq!(samples.iter().filter(|sample| sample.area > 0.0).count(), made);
        let sums =
            (0..maps).map(|map| of_map(&samples, map).map(|sample| f64::from(sample.area)).sum::<f64>());
        let mean = sums.sum::<f64>() / f64::from(maps);
        assert!((mean / scene.area() - 1.0).abs() < 1e-2, "{mean} of {} m²", scene.area());
    }
}

/// Its triangle, and where it lies, exactly.
fn key(sample: &SurfaceSample) -> (u32, [u32; 3]) {
    (sample.triangle, sample.position.map(f32::to_bits))
}

#[test]
fn the_splat_factor_is_how_many_maps_take_a_point() {
    let scene = pass_test::scene("plane");
    for (factor, maps) in [(1.0_f32, 1), (3.0, 3), (0.25, 1)] {
        let Some(stored) = run(&scene, &[("splat_factor", factor.into())]) else { return };
        let all = stored.points.len();
        assert_eq!(stored.requested, (all as f32 * factor) as u32);
        let Some(samples) = stored.port.samples(&scene, 0.0, 8, 10_000) else { return };
        let mut taken = std::collections::BTreeMap::<(u32, [u32; 3]), Vec<u32>>::new();
        for sample in samples.iter().filter(|sample| sample.area > 0.0) {
            taken.entry(key(sample)).or_default().push(sample.map);
        }
        assert_eq!(taken.len(), all.min(stored.requested as usize), "factor {factor}");
        for of_point in taken.values_mut() {
            of_point.sort_unstable();
            of_point.dedup();
            assert_eq!(of_point.len(), maps, "factor {factor}: {of_point:?} are different maps");
        }
        for map in 0..8 {
            let sum: f64 = of_map(&samples, map).map(|sample| f64::from(sample.area)).sum();
            assert!((sum / scene.area() - 1.0).abs() < 0.02, "factor {factor}, map {map}: {sum}");
        }
    }
}

#[test]
fn points_where_the_surface_is_cut_out_stand_for_nothing() {
    let scene = pass_test::rooms::half_plane();
    let Some(stored) = run(&scene, &[]) else { return };
    for point in &stored.points {
        // Filtering spreads the edge over a texel, and the texture repeats at the border.
        assert!(point.position[0] > -0.1 || point.position[0] < -0.9 || point.area == 0.0, "{point:?}");
        assert!(point.position[0] < 0.1 || point.position[0] > 0.9 || point.area > 0.0, "{point:?}");
    }
}
