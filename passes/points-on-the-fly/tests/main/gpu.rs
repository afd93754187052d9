//! The shaders against the CPU reference, on a GPU.

use crate::cpu_reference::{ANY_NUMBER, WHOLE, place, sample, scramble, starts, triangle_at, weights};
use crate::probe::Amplification;
use glam::{DVec3, Vec3};
use interfaces::points::SurfaceSample;
use pass_test::points::PointsPort;
use pass_test::random::{hash2, unit_float};
use pass_test::{Harness, soup};
use points_on_the_fly::PASS;
use scene::Scene;

fn precise(v: [f32; 3]) -> DVec3 {
    Vec3::from(v).as_dvec3()
}

/// The triangles as they are at that time [s].
fn triangles(scene: &Scene, time: f32) -> Vec<[DVec3; 3]> {
    let mut vertices = scene.vertices.clone();
    for moved in &scene.at(time).moved {
        let first = moved.first_vertex as usize;
        vertices[first..first + moved.vertices.len()].clone_from_slice(&moved.vertices);
    }
    scene
        .indices
        .chunks(3)
        .map(|corners| [0, 1, 2].map(|k| precise(vertices[corners[k] as usize].position)))
        .collect()
}

fn amplify(scene: &Scene, time: f32, rule: &str) -> Option<Amplification> {
    let outputs = Harness::new(PASS).with_scene(scene.clone()).time(time).set("rule", rule).run()?;
    Some(Amplification::read(&outputs, scene.triangles()))
}

fn compare(scene: &Scene, time: f32, rule: &str) -> Option<Amplification> {
    let found = amplify(scene, time, rule)?;
    let corners = triangles(scene, time);
    let factors = (rule == "tessellation").then_some([5, 64]);
    let weights = weights(&corners, factors);
    let seed = pass::pass_seed(0, "points-on-the-fly");
    let wanted = starts(&weights, |i| unit_float(hash2(seed, i)));
    assert_eq!((found.starts[0], found.starts[corners.len()]), (0, WHOLE));
    for (i, (found, wanted)) in std::iter::zip(found.starts.windows(2), wanted.windows(2)).enumerate() {
        let at_the_end = found[1] == WHOLE;
        let [found, wanted] = [found, wanted].map(|pair| f64::from(pair[1]) - f64::from(pair[0]));
        // Single precision, and a level that rounding took up or down; at the end is what roundings left.
        let share = if factors.is_some() { 0.07 } else { 1e-4 };
        let slack = share * wanted + if at_the_end { 200.0 } else { 2.0 };
        assert!((found - wanted).abs() <= slack, "triangle {i}: {found} {wanted}");
    }
    let requested = if factors.is_some() { weights.iter().sum::<f64>() } else { f64::from(ANY_NUMBER) };
    assert!(
        (f64::from(found.requested) - requested).abs() < 1e-3 * requested,
        "{} asked for, not {requested}",
        found.requested
    );
    assert_eq!(found.step, (1 << 63) / u64::from(found.requested));
    let (last, entries) = (corners.len() as u32 - 1, found.guide.len() as u64 - 1);
    for (entry, triangle) in (0..).zip(&found.guide) {
        let at =
            |number: u64| if entry == entries { last } else { triangle_at(&found.starts, number as u32) };
        assert_eq!(*triangle, at(entry * u64::from(WHOLE) / entries), "entry {entry} of the guide");
    }
    Some(found)
}

#[test]
fn shares_are_those_of_the_cpu_reference() {
    for rule in ["area", "tessellation"] {
        for scene in ["plane", "cornell-box", "atrium"] {
            compare(&pass_test::scene(scene), 0.0, rule);
        }
    }
}

#[test]
fn triangles_count_as_they_are_now() {
    let mut scene = pass_test::scene("cornell-box-moving");
    // A moving ball keeps its area: so let time 0 have it otherwise. What counts is the pose.
    let moving = scene.at(1.0).moved[0].first_vertex as usize;
    let count = scene.at(1.0).moved[0].vertices.len();
    for vertex in &mut scene.vertices[moving..moving + count] {
        vertex.position = [0.0; 3];
    }
    let Some(found) = compare(&scene, 1.0, "area") else { return };
    let Some(samples) = found.samples(&scene, 1.0, 4, 500) else { return };
    let area: f64 = triangles(&scene, 1.0).iter().map(|corners| weights(&[*corners], None)[0]).sum();
    assert!((sum_of_areas(&samples, 0) / area - 1.0).abs() < 0.02);
}

#[test]
fn samples_where_the_surface_is_cut_out_are_none() {
    let scene = pass_test::rooms::half_plane();
    let Some(found) = amplify(&scene, 0.0, "area") else { return };
    let Some(samples) = found.samples(&scene, 0.0, 3, 1_000) else { return };
    for sample in &samples {
        // Filtering spreads the edge over a texel.
        assert!(sample.position[0] > -0.1 || sample.area == 0.0, "{sample:?}");
        assert!(sample.position[0] < 0.1 || sample.area > 0.0, "{sample:?}");
    }
    assert!((sum_of_areas(&samples, 1) / 2.0 - 1.0).abs() < 0.1, "half of 4 m²");
}

fn sum_of_areas(samples: &[SurfaceSample], map: u32) -> f64 {
    samples.iter().filter(|sample| sample.map == map).map(|sample| f64::from(sample.area)).sum()
}

#[test]
fn samples_are_those_of_the_cpu_reference() {
    let scene = pass_test::scene("cornell-box");
    let corners = triangles(&scene, 0.0);
    let seed = PointsPort::seed();
    // Fewer samples than are requested, and more; blocks of maps that are not full.
    for (rule, maps, per_map) in
        [("area", 3, 700), ("area", 70, 33), ("tessellation", 40, 50), ("tessellation", 5, 20_000)]
    {
        let Some(found) = amplify(&scene, 0.0, rule) else { return };
        let Some(samples) = found.samples(&scene, 0.0, maps, per_map) else { return };
        let wanted = found.wanted(maps, per_map);
        let mut made = 0;
        for (index, got) in (0..).zip(&samples) {
            let Some(place) = place(index, &wanted) else {
                assert_eq!(got.area, 0.0, "sample {index}");
                continue;
            };
            made += 1;
            let second = unit_float(scramble(place.stratum.reverse_bits(), hash2(seed, place.map)));
            let expected = sample(&place, maps, second, &found.starts, |triangle, k| {
                corners[triangle as usize][k as usize]
            });
            assert_eq!(got.map, place.map, "sample {index}");
            assert!(
                (f64::from(got.area) / expected.area - 1.0).abs() < 1e-4,
                "sample {index}: {got:?} {expected:?}"
            );
            let near = precise(got.position).abs_diff_eq(expected.position, 1e-4)
                && precise(got.normal).abs_diff_eq(expected.normal, 1e-4);
            assert!(near, "sample {index}: {got:?} {expected:?}");
        }
        assert_eq!(made, found.requested.min(maps * per_map));
    }
}

#[test]
fn what_samples_stand_for_is_the_surface() {
    let scene = pass_test::scene("atrium");
    let all = scene.area();
    for rule in ["area", "tessellation"] {
        let Some(found) = amplify(&scene, 0.0, rule) else { return };
        let Some(samples) = found.samples(&scene, 0.0, 40, 2_000) else { return };
        for map in [0, 31, 39] {
            let sum = sum_of_areas(&samples, map);
            // Measured over maps: 4e-6 by area, and 14 % by tessellation, whose few samples of large triangles weigh.
            let slack = if rule == "area" { 1e-4 } else { 0.3 };
            assert!((sum / all - 1.0).abs() < slack, "{rule}, map {map}: {sum} of {all} m²");
        }
        let mean = (0..40).map(|map| sum_of_areas(&samples, map)).sum::<f64>() / 40.0;
        assert!((mean / all - 1.0).abs() < 0.01, "{rule}: {mean} of {all} m²");
    }
}

#[test]
fn samples_of_a_map_are_more_even_than_random_ones() {
    // 256 samples of one map on the square: boxes of 1/64 hold 4; independent ones would vary by ±2.
    let scene = pass_test::scene("plane");
    let Some(found) = amplify(&scene, 0.0, "area") else { return };
    let Some(samples) = found.samples(&scene, 0.0, 4, 256) else { return };
    let bounds = triangles(&scene, 0.0).concat();
    let side = |c: usize| bounds.iter().map(|p| p[c]).fold(f64::NEG_INFINITY, f64::max);
    let flat = (0..3).find(|c| side(*c) == 0.0).unwrap();
    let [u, v] = [(flat + 1) % 3, (flat + 2) % 3];
    for map in 0..4 {
        let mut boxes = [0; 64];
        for sample in samples.iter().filter(|sample| sample.map == map) {
            let cell = |c: usize| (((f64::from(sample.position[c]) / side(c) + 1.0) * 4.0) as usize).min(7);
            boxes[cell(u) * 8 + cell(v)] += 1;
        }
        let variance = boxes.iter().map(|n| (f64::from(*n) - 4.0).powi(2)).sum::<f64>() / 64.0;
        assert!(variance < 1.0, "map {map}: variance {variance}, of random samples 4");
    }
}

#[test]
fn triangles_of_any_shape_at_any_scale() {
    for scale in [1e-3, 1.0, 1e6] {
        let mut corners: Vec<[f32; 3]> =
            (0..9000).map(|i| [0, 1, 2].map(|c| scale * unit_float(hash2(i, c)) as f32)).collect();
        // Two corners alike, first, in the middle and last: triangles without area.
        for first in [0, 4500, 8997] {
            corners[first + 1] = corners[first];
        }
        for rule in ["area", "tessellation"] {
            let scene = soup(&corners);
            let Some(found) = compare(&scene, 0.0, rule) else { return };
            let Some(samples) = found.samples(&scene, 0.0, 2, 3000) else { return };
            assert!(
                samples
                    .iter()
                    .all(|s| s.area.is_finite() && s.position.iter().chain(&s.normal).all(|x| x.is_finite()))
            );
        }
    }
}

#[test]
fn no_triangles_and_none_with_an_area() {
    for rule in ["area", "tessellation"] {
        let Some(outputs) = Harness::new(PASS).scene("empty").set("rule", rule).run() else { return };
        assert_eq!(outputs.read::<u32>("points")[4], 0, "an empty interval");
        assert_eq!(*outputs.fact("points", "count"), pass::Value::U32(0));
        let scene = soup(&[[1.0; 3]; 6]);
        let Some(found) = amplify(&scene, 0.0, rule) else { return };
        let Some(samples) = found.samples(&scene, 0.0, 2, 10) else { return };
        assert!(samples.iter().all(|sample| sample.area == 0.0), "{samples:?}");
    }
}

/// At the least level a tessellator divides nothing: each triangle has its three corners.
#[test]
fn a_triangle_that_is_not_divided_has_three_points() {
    let scene = pass_test::scene("cornell-box");
    let harness = Harness::new(PASS).with_scene(scene.clone()).set("rule", "tessellation");
    let Some(outputs) = harness.set("min_factor", 1u32).set("max_factor", 1u32).run() else { return };
    let found = Amplification::read(&outputs, scene.triangles());
    assert_eq!(found.requested, 3 * scene.triangles() as u32);
}

/// The third edge, across from the first corner, is the longest of all.
#[test]
fn levels_rise_with_every_edge() {
    let right = |side: f32| [[0.0; 3], [side, 0.0, 0.0], [0.0, side, 0.0]];
    compare(&soup(&[right(1.0), right(4.0), right(10.0)].concat()), 0.0, "tessellation");
}

/// Consumers take as many points as they want, where there are triangles.
#[test]
fn there_are_as_many_points_as_are_wanted() {
    let Some(outputs) = Harness::new(PASS).scene("plane").run() else { return };
    assert_eq!(*outputs.fact("points", "count"), pass::Value::U32(ANY_NUMBER));
}

#[test]
fn a_splat_factor_asks_for_so_many_samples_a_vertex() {
    let scene = pass_test::scene("cornell-box");
    let requested = |factor: f32| {
        let harness = Harness::new(PASS).with_scene(scene.clone()).set("rule", "tessellation");
        let words: Vec<u32> = harness.set("splat_factor", factor).run()?.read("points");
        Some(words[0])
    };
    let (Some(one), Some(third), Some(twice)) = (requested(1.0), requested(0.3), requested(2.0)) else {
        return;
    };
    assert_eq!((third, twice), ((one as f32 * 0.3) as u32, 2 * one));
}
