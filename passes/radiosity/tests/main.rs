//! Radiosity against closed forms, and what is kept of it.

use glam::{Vec2, Vec3, vec3};
use interfaces::radiosity::PointRadiosity;
use interfaces::surface_points::SurfacePoint;
use pass_test::rooms::{self, floor_and_wall, furnace, point_on};
use pass_test::{Harness, elements, scene};
use radiosity::PASS;
use scene::Scene;
use std::f64::consts::PI;

pass_test::shaders_are_valid!(PASS);

/// The pass over these points.
fn harness<'a>(scene: &Scene, points: &[SurfacePoint]) -> Harness<'a> {
    Harness::new(PASS).with_scene(scene.clone()).surface_points("points", 0, points)
}

fn run(harness: Harness<'_>) -> Option<Vec<PointRadiosity>> {
    Some(harness.run()?.read("radiosity"))
}

/// Points all over a scene, which face `towards`.
fn points_of(scene: &Scene, towards: Vec3, count: u32) -> Vec<SurfacePoint> {
    let place = |i: u32| {
        let fraction = |step: f32| (i as f32 * step).fract();
        Vec2::new(0.1 + 0.3 * fraction(0.618), 0.1 + 0.3 * fraction(0.414))
    };
    (0..count).map(|i| point_on(scene, i % scene.triangles() as u32, place(i), towards, 1 + 77 * i)).collect()
}

fn assert_near(found: f32, expected: f64, tolerance: f64, what: &str) {
    assert!((f64::from(found) / expected - 1.0).abs() < tolerance, "{what}: {found}, not {expected}");
}

/// Where all surfaces emit E and reflect ρ, every path brings the same: B = ρ π E Σ ρᵏ over the bounces before.
#[test]
fn in_a_furnace_every_path_brings_the_same() {
    let (emitted, albedo) = ([0.5, 0.25, 1.0], [0.2, 0.5, 0.8]);
    let scene = furnace(emitted, albedo);
    let points = points_of(&scene, Vec3::ZERO, 24);
    for (bounces, paths, reflectance) in [(1, 1, "mean"), (3, 16, "mean"), (3, 5, "textured")] {
        let harness = harness(&scene, &points).set("bounces", bounces).set("paths", paths);
        let Some(found) = run(harness.set("albedo", reflectance)) else { return };
        for (point, found) in points.iter().zip(found) {
            for c in 0..3 {
                let series: f64 = (0..bounces).map(|k| albedo[c].powi(k as i32)).sum();
                let expected = point.albedo()[c] * PI * emitted[c] * series;
                assert_near(found.radiosity[c], expected, 2e-5, &format!("{bounces} bounces, {paths} paths"));
            }
        }
    }
}

/// Under the spot the irradiance is 1 W/m² (scenes/plane.ron).
#[test]
fn direct_light_reaches_the_side_it_falls_on() {
    let scene = scene("plane");
    // Triangles share the middle of the square, which is below the spot.
    let middle = (0..scene.triangles() as u32)
        .flat_map(|triangle| [[0.0, 0.5], [0.5, 0.0], [0.5, 0.5]].map(|place| (triangle, place)))
        .find(|(triangle, place)| {
            Vec3::from(point_on(&scene, *triangle, Vec2::from(*place), Vec3::Y, 1).position).length() < 1e-6
        });
    let (triangle, place) = middle.expect("the diagonal goes through the middle");
    let points = [Vec3::Y, Vec3::NEG_Y].map(|side| point_on(&scene, triangle, place.into(), side, 9));
    let Some(found) = run(harness(&scene, &points)) else { return };
    for c in 0..3 {
        assert_near(found[0].radiosity[c], points[0].albedo()[c], 1e-4, "above");
    }
    assert_eq!(found[1].radiosity, [0.0; 3], "below");
}

#[test]
fn what_is_in_the_way_shades() {
    let radiosity_below = |height: f32| {
        let floor = rooms::quad([-1.0, 0.0, -1.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0], 0);
        let screen = rooms::quad([-0.5, height, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], 0);
        let mut scene = rooms::room(&[floor, screen], vec![rooms::matte([0.5; 3], [0.0; 3])]);
        scene.lights[0].intensity = Vec3::ONE;
        let middle = point_on(&scene, 0, Vec2::new(0.0, 0.5), Vec3::Y, 3);
        assert_eq!(middle.position, [0.0; 3]);
        Some(run(harness(&scene, &[middle]).set("bounces", 1))?[0].radiosity[0])
    };
    // The spot hangs 1 m above the floor: above a screen at half a metre, and below one at 2 m.
    let (Some(shaded), Some(lit)) = (radiosity_below(0.5), radiosity_below(2.0)) else { return };
    assert_eq!(shaded, 0.0);
    assert!(lit > 0.1, "{lit}");
}

/// A sun lights a wall, which lights the floor before it. The share of the wall in what the floor sees is known: that of a
/// rectangle on edge, from a patch in front of its middle.
#[test]
fn the_second_bounce_is_that_of_the_view_factor() {
    let scene = floor_and_wall();
    // From a patch at distance a from the wall of width 2 b and height c, F = 1/π (atan(b / a) - a / √(a² + c²) atan(b / √(a² + c²))).
    let factor = |a: f64| {
        let (b, slant) = (0.5_f64, a.hypot(1.0));
        ((b / a).atan() - a / slant * (b / slant).atan()) / PI
    };
    let points: Vec<_> =
        (1..200).map(|seed| point_on(&scene, 0, Vec2::new(0.0, 0.5), Vec3::Y, seed)).collect();
    let [x, _, z] = points[0].position;
    assert_eq!([x, z], [0.5, 0.0]);
    let Some(found) = run(harness(&scene, &points).set("bounces", 2).set("paths", 64)) else { return };
    let expected = points[0].albedo()[0] * 0.6 * 2.0 * factor(0.5);
    let (mean, error) = pass_test::statistics::spread(found.iter().map(|found| found.radiosity[0]));
    assert!((mean - expected).abs() < 4.0 * error + 1e-4 * expected, "{mean} ± {error}, not {expected}");
    assert!(error < 0.01 * expected, "{error}");
    // With one bounce there is none of it: the sun shines along the floor.
    let Some(first) = run(harness(&scene, &points).set("bounces", 1)) else { return };
    assert!(first.iter().all(|found| found.radiosity == [0.0; 3]));
}

/// Below a lamp that emits 1, a point that reflects ρ has the radiosity ρ π F, with the view factor F; on its other side none.
#[test]
fn a_point_below_a_lamp_has_its_view_factor() {
    for (height, side, most) in [(0.5_f32, 0.05_f32, 0.001), (0.5, 0.4, 0.005), (0.1, 0.4, 0.005)] {
        let scene = rooms::floor_and_lamp(height, side);
        let point = |towards, seed| point_on(&scene, 0, Vec2::new(0.0, 0.5), towards, seed);
        let below = (1..200).map(|seed| point(Vec3::Y, seed));
        let points: Vec<_> = below.chain([point(Vec3::NEG_Y, 3)]).collect();
        assert_eq!(points[0].position, [0.0; 3]);
        let Some(found) = run(harness(&scene, &points).set("bounces", 1).set("paths", 16)) else { return };
        let half = f64::from(side) / 2.0;
        let factor = rooms::view_factor(f64::from(height), [-half, half], [-half, half]);
        let expected = points[0].albedo()[0] * PI * factor;
        let (mean, error) =
            pass_test::statistics::spread(found[..199].iter().map(|found| found.radiosity[0]));
        let what = format!("height {height}, side {side}");
        assert!(
            (mean - expected).abs() < 4.0 * error + 1e-5 * expected,
            "{what}: {mean} ± {error}, not {expected}"
        );
        assert!(error < most * expected, "{what}: ± {error} of {expected}");
        assert_eq!(found[199].radiosity, [0.0; 3], "{what}: on the other side");
    }
}

/// Half the side of the lamp of [`wall_by_lit_floor`] \[m\].
const HALF_LAMP: f32 = 0.025;

/// A wall beside a floor that a small lamp lights, 0.4 m above its middle.
fn wall_by_lit_floor(albedo_of_floor: f64) -> Scene {
    let half = HALF_LAMP;
    let quads = [
        rooms::quad([0.0, 0.0, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], 2),
        rooms::quad([0.0, 0.0, -0.5], [0.0, 0.4, 0.0], [0.0, 0.0, 1.0], 0),
        rooms::quad([0.5 - half, 0.4, -half], [2.0 * half, 0.0, 0.0], [0.0, 0.0, 2.0 * half], 1),
    ];
    let (wall, lamp) = (rooms::matte([0.6; 3], [0.0; 3]), rooms::matte([0.0; 3], [1.0; 3]));
    rooms::room(&quads, vec![wall, lamp, rooms::matte([albedo_of_floor; 3], [0.0; 3])])
}

#[test]
fn black_surfaces_reflect_no_lamp() {
    let scene = wall_by_lit_floor(0.0);
    let points = [point_on(&scene, 2, Vec2::new(0.0, 0.5), Vec3::X, 3)];
    let radiosities = |bounces: u32| run(harness(&scene, &points).set("bounces", bounces).set("paths", 64));
    let (Some(one), Some(two)) = (radiosities(1), radiosities(2)) else { return };
    assert!(one[0].radiosity[0] > 0.0, "the wall sees the lamp");
    assert_eq!(one[0].radiosity, two[0].radiosity);
}

/// A wall sees the floor that a lamp lights: paths sample the lamp where they meet the floor.
#[test]
fn the_second_bounce_of_a_lamp_is_that_of_what_it_lights() {
    let scene = wall_by_lit_floor(0.6);
    // The middle of the wall's diagonal, of its first triangle.
    let points: Vec<_> =
        (1..200).map(|seed| point_on(&scene, 2, Vec2::new(0.0, 0.5), Vec3::X, seed)).collect();
    let [_, at, z] = points[0].position;
    assert_eq!((points[0].position[0], z), (0.0, 0.0));
    let radiosities = |bounces: u32| run(harness(&scene, &points).set("bounces", bounces).set("paths", 32));
    let (Some(one), Some(two)) = (radiosities(1), radiosities(2)) else { return };
    let of_bounce = one.iter().zip(&two).map(|(one, two)| two.radiosity[0] - one.radiosity[0]);
    let (mean, error) = pass_test::statistics::spread(of_bounce);
    let (steps, at, half) = (200, f64::from(at), f64::from(HALF_LAMP));
    let step = 1.0 / f64::from(steps);
    let mut irradiance = 0.0;
    for i in 0..steps {
        for j in 0..steps {
            let (x, z) = ((f64::from(i) + 0.5) * step, (f64::from(j) + 0.5) * step - 0.5);
            let factor = rooms::view_factor(0.4, [0.5 - half - x, 0.5 + half - x], [-half - z, half - z]);
            let distance2 = x * x + at * at + z * z;
            irradiance += 0.6 * factor * x * at / (distance2 * distance2) * step * step;
        }
    }
    let expected = points[0].albedo()[0] * irradiance;
    assert!((mean - expected).abs() < 4.0 * error + 1e-3 * expected, "{mean} ± {error}, not {expected}");
    assert!(error < 0.01 * expected, "± {error} of {expected}");
}

/// Neither the place of a point among the others nor the frame changes what it is.
#[test]
fn a_point_has_one_radiosity_wherever_it_stands() {
    let scene = scene("cornell-box");
    let points = points_of(&scene, vec3(0.27, 0.27, 0.27), 100);
    let Some(found) = run(harness(&scene, &points)) else { return };
    let turned: Vec<_> = points.iter().cycle().skip(33).take(100).copied().collect();
    let again = run(harness(&scene, &turned).frame_index(7).seed(5)).expect("the adapter is still there");
    for (i, again) in again.iter().enumerate() {
        assert_eq!(*again, found[(i + 33) % 100], "point {i}");
    }
    assert!(found.iter().filter(|found| found.radiosity[0] > 0.0).count() > 50);
    // Another seed takes other paths.
    let others: Vec<_> =
        points.iter().map(|point| SurfacePoint { seed: point.seed ^ 0x5555, ..*point }).collect();
    let others = run(harness(&scene, &others)).expect("the adapter is still there");
    assert!(others.iter().zip(&found).filter(|(a, b)| a.radiosity != b.radiosity).count() > 50);
}

#[test]
fn what_is_known_is_kept_and_nothing_else() {
    let scene = scene("cornell-box");
    let mut points = points_of(&scene, vec3(0.27, 0.27, 0.27), 64);
    points[5] = SurfacePoint::NONE;
    let Some(found) = run(harness(&scene, &points)) else { return };
    assert_eq!(found[5], PointRadiosity::default());
    assert!(found.iter().enumerate().all(|(i, found)| i == 5 || found.key != 0));
    // What is handed in is told apart by its value, not by its key, but for three: one that another point has left, one
    // that was never known, one of other settings.
    let mut past: Vec<_> =
        found.iter().map(|found| PointRadiosity { radiosity: [-1.0; 3], ..*found }).collect();
    past[7].key ^= 1;
    past[8].key = 0;
    let with = |past: &[PointRadiosity], age: u32, paths: u32| {
        run(harness(&scene, &points)
            .set("paths", paths)
            .past("past", "Radiosity", age, elements(past))
            .fact("count", past.len() as u32))
        .expect("the adapter is still there")
    };
    for (i, again) in with(&past, 1, 16).iter().enumerate() {
        let expected = if [5, 7, 8].contains(&i) { found[i] } else { past[i] };
        assert_eq!(*again, expected, "point {i}");
    }
    assert!(with(&past, 1, 8).iter().all(|again| again.radiosity != [-1.0; 3]), "other settings");
    assert_eq!(with(&past, 0, 16), found, "without history");
}
