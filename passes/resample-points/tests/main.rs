//! The choice of points, and its frequencies.

mod cpu_reference;

use interfaces::surface_points::SurfacePoint;
use pass_test::random::{hash2, unit_float};
use pass_test::statistics::{assert_follows, chi_squared, chi_squared_limit};
use pass_test::{Harness, elements};
use resample_points::PASS;
use std::collections::HashSet;

const METHODS: [&str; 3] = ["systematic", "race", "retries"];

/// The chosen points.
struct Chosen {
    /// Marks of the points: their indices.
    indices: Vec<u32>,
    /// The number of points, those included that are empty.
    count: usize,
    counters: [u32; 2],
}

/// Points that know their index, and where they were traced from.
fn points(count: u32) -> Vec<SurfacePoint> {
    let point = |i: u32| SurfacePoint { seed: hash2(i, 9), mark: i, ..SurfacePoint::default() };
    (0..count).map(point).collect()
}

fn random(i: u32, dimension: u32) -> f64 {
    unit_float(hash2(hash2(77, dimension), i))
}

fn harness(method: &str, iteration: u32, points: &[SurfacePoint]) -> Harness<'static> {
    let origin = |point: &SurfacePoint| SurfacePoint { mark: !point.mark, ..SurfacePoint::default() };
    let origins: Vec<SurfacePoint> = points.iter().map(origin).collect();
    let harness = Harness::new(PASS).set("method", method).surface_points("points", iteration, points);
    harness.surface_points("origins", iteration, &origins)
}

trait Weights {
    fn density(self, density: &[f32]) -> Self;
    fn radiosity(self, luminance: &[f32]) -> Self;
}

impl Weights for Harness<'_> {
    fn density(self, density: &[f32]) -> Self {
        self.input("density", "Density", &[("count", density.len() as u32)], elements(density))
    }

    fn radiosity(self, luminance: &[f32]) -> Self {
        let grey: Vec<[f32; 4]> = luminance.iter().map(|l| [*l, *l, *l, f32::NAN]).collect();
        self.input("radiosity", "Radiosity", &[("count", luminance.len() as u32)], elements(&grey))
    }
}

/// Runs the pass, and asserts what holds of every result: points are whole, with their origins, none of them twice and in their
/// order (but for ties of a race), and those that are empty come last.
fn run(harness: Harness<'_>, given: &[SurfacePoint]) -> Option<Chosen> {
    let outputs = harness.run()?;
    let (header, chosen) = outputs.surface_points("resampled");
    let (header_of_origins, origins) = outputs.surface_points("resampled_origins");
    assert_eq!((header, chosen.len()), (header_of_origins, origins.len()));
    let indices: Vec<u32> =
        chosen.iter().take_while(|point| !point.is_none()).map(|point| point.mark).collect();
    for (i, (point, origin)) in std::iter::zip(&chosen, &origins).enumerate() {
        let Some(index) = indices.get(i) else {
            assert_eq!((*point, *origin), (SurfacePoint::NONE, SurfacePoint::NONE), "place {i}");
            continue;
        };
        assert_eq!((*point, origin.mark), (given[*index as usize], !index), "place {i}");
    }
    assert_eq!(indices.iter().collect::<HashSet<_>>().len(), indices.len(), "a point is there twice");
    let counters: Vec<u32> = outputs.read("counters");
    let counters = [counters[0], counters[1]];
    assert_eq!(counters, [chosen.len() as u32, indices.len() as u32]);
    Some(Chosen { indices, count: chosen.len(), counters })
}

pass_test::shaders_are_valid!(PASS);

#[test]
fn as_many_are_chosen_as_are_wanted() {
    for method in METHODS {
        for (of, count) in
            [(1, 1), (16, 1), (100, 99), (2048, 128), (2049, 2048), (5000, 300), (32_768, 2048)]
        {
            let all = points(of);
            let density: Vec<f32> = (0..of).map(|i| (1.0 / (0.01 + random(i, 1))) as f32).collect();
            for harness in [harness(method, 5, &all), harness(method, 5, &all).density(&density)] {
                let Some(chosen) = run(harness.set("count", count), &all) else { return };
                let found = chosen.indices.len() as u32;
                assert_eq!(chosen.count as u32, count);
                // Retries end where few are left that no draw has found.
                let fewest = if method == "retries" { 4 * count / 5 } else { count };
                assert!((fewest..=count).contains(&found), "{method}: {found} of {of}, {count} wanted");
                let sorted = chosen.indices.is_sorted();
                assert!(sorted || method == "race", "{method}: the order is not that of the points");
            }
        }
    }
}

#[test]
fn where_there_are_too_few_all_are_chosen() {
    let some = |count: u32, there: u32| -> Vec<SurfacePoint> {
        let mut all = points(count);
        for point in &mut all {
            if !point.mark.is_multiple_of(count / there.max(1)) || there == 0 {
                *point = SurfacePoint { mark: point.mark, ..SurfacePoint::NONE };
            }
        }
        all
    };
    for method in ["systematic", "race"] {
        for (of, there, count) in
            [(64, 8, 16), (64, 16, 16), (4096, 32, 2048), (2048, 2048, 2048), (64, 0, 16), (1, 1, 100)]
        {
            let all = some(of, there);
            let density: Vec<f32> = (0..of).map(|i| 10f64.powf(75.0 * random(i, 2) - 37.0) as f32).collect();
            for harness in [harness(method, 0, &all), harness(method, 0, &all).density(&density)] {
                let Some(chosen) = run(harness.set("count", count), &all) else { return };
                let mut found = chosen.indices;
                found.sort_unstable();
                let expected: Vec<u32> =
                    all.iter().filter(|point| !point.is_none()).map(|point| point.mark).collect();
                assert_eq!((found, chosen.counters[0]), (expected, count), "{method}: {there} of {of}");
            }
        }
    }
    let none = some(64, 0);
    let Some(chosen) = run(harness("retries", 0, &none).set("count", 10u32), &none) else { return };
    assert_eq!(chosen.counters, [10, 0]);
}

/// Eight classes of points with weights from 1 to 128: how many of each class are chosen.
fn classes(
    method: &str,
    iterations: u32,
    weigh: impl Fn(Harness<'static>, &[f32]) -> Harness<'static>,
) -> Option<[u32; 8]> {
    let all = points(16_384);
    let weights: Vec<f32> = all.iter().map(|point| (1 << class(point.mark)) as f32).collect();
    let mut counts = [0; 8];
    for iteration in 0..iterations {
        let chosen = run(weigh(harness(method, iteration, &all), &weights).set("count", 1024), &all)?;
        for index in chosen.indices {
            counts[class(index)] += 1;
        }
    }
    Some(counts)
}

fn class(index: u32) -> usize {
    // Few of the greatest weight, of which some are certain.
    (hash2(index, 3) | 0x80).leading_zeros().min(24) as usize % 8
}

/// Expected numbers of each class, from the probability of each point.
fn expected(probabilities: &[f64], iterations: u32) -> [f64; 8] {
    let mut sums = [0.0; 8];
    for (i, probability) in (0..).zip(probabilities) {
        sums[class(i)] += probability * f64::from(iterations);
    }
    sums
}

#[test]
fn points_are_chosen_in_proportion_to_their_weights() {
    let iterations = 6;
    let weights: Vec<f64> = (0..16_384).map(|i| f64::from(1 << class(i))).collect();
    let inverse = |harness: Harness<'static>, weights: &[f32]| {
        harness.density(&weights.iter().map(|w| 1.0 / w).collect::<Vec<f32>>())
    };
    let luminance = |harness: Harness<'static>, weights: &[f32]| harness.radiosity(weights);
    let both = |harness: Harness<'static>, weights: &[f32]| {
        let share: Vec<f32> = (0..weights.len() as u32).map(|i| (0.1 + random(i, 7)) as f32).collect();
        let rest: Vec<f32> = std::iter::zip(weights, &share).map(|(w, s)| w * s).collect();
        harness.density(&share).radiosity(&rest)
    };
    for method in METHODS {
        let Some(found) = classes(method, iterations, inverse) else { return };
        let total = found.iter().sum::<u32>();
        let probabilities = match method {
            "systematic" => cpu_reference::systematic(&weights, 1024),
            _ => cpu_reference::successive(&weights, f64::from(total) / f64::from(iterations)),
        };
        assert_follows(&found, &expected(&probabilities, iterations));
        if method != "retries" {
            assert_eq!(total, 1024 * iterations);
        }
    }
    let by_definition = expected(&cpu_reference::systematic(&weights, 1024), iterations);
    assert_follows(&classes("systematic", iterations, luminance).unwrap(), &by_definition);
    assert_follows(&classes("systematic", iterations, both).unwrap(), &by_definition);
    // These classes differ enough that a test of equal probabilities fails.
    let equal = expected(&[1024.0 / 16_384.0; 16_384], iterations);
    let (statistic, freedom) = chi_squared(&classes("systematic", iterations, luminance).unwrap(), &equal);
    assert!(statistic > 2.0 * chi_squared_limit(freedom));
}

/// Each of a few points, over many iterations.
#[test]
fn every_point_has_its_chance() {
    let all = points(20);
    let weights: Vec<f32> = (0..20).map(|i| (1.0 + 9.0 * random(i, 5)) as f32).collect();
    let double: Vec<f64> = weights.iter().map(|w| f64::from(*w)).collect();
    let mut counts = [0; 20];
    let iterations = 60;
    for iteration in 0..iterations {
        let harness = harness("systematic", iteration, &all).radiosity(&weights).set("count", 6);
        let Some(chosen) = run(harness, &all) else { return };
        assert_eq!(chosen.indices.len(), 6);
        for index in chosen.indices {
            counts[index as usize] += 1;
        }
    }
    let expected: Vec<f64> =
        cpu_reference::systematic(&double, 6).iter().map(|p| p * f64::from(iterations)).collect();
    assert_follows(&counts, &expected);
}

/// Points whose density rises across a strip, weighted by it: what is chosen is uniform by area.
#[test]
fn known_densities_are_undone() {
    let all = points(16_384);
    // From 0.1 to 1, with a density in proportion to x: the least dense are not certain.
    let x: Vec<f64> = (0..16_384).map(|i| (0.01 + 0.99 * random(i, 1)).sqrt()).collect();
    let density: Vec<f32> = x.iter().map(|x| (2.0 * x / 0.99) as f32).collect();
    for method in METHODS {
        let mut strips = [0; 16];
        for iteration in 0..4 {
            let harness = harness(method, iteration, &all).density(&density).set("count", 512);
            let Some(chosen) = run(harness, &all) else { return };
            for index in &chosen.indices {
                strips[((x[*index as usize] - 0.1) / 0.9 * 15.999) as usize] += 1;
            }
        }
        let expected = [f64::from(strips.iter().sum::<u32>()) / 16.0; 16];
        assert_follows(&strips, &expected);
    }
}

#[test]
fn weights_may_span_all_numbers() {
    let all = points(4096);
    let spread = |from: f64, decades: f64| -> Vec<f32> {
        (0..4096).map(|i| 10f64.powf(from + decades * random(i, 4)) as f32).collect()
    };
    for (density, radiosity) in [
        (spread(-15.0, 30.0), None),
        (spread(-37.0, 75.0), None),
        (spread(-30.0, 0.0), Some(spread(8.0, 30.0))),
        (spread(20.0, 18.0), Some(spread(-37.0, 30.0))),
    ] {
        let weights: Vec<f64> = (0..4096)
            .map(|i| radiosity.as_ref().map_or(1.0, |r: &Vec<f32>| f64::from(r[i])) / f64::from(density[i]))
            .collect();
        for method in METHODS {
            let mut harness = harness(method, 1, &all).density(&density).set("count", 256);
            if let Some(radiosity) = &radiosity {
                harness = harness.radiosity(radiosity);
            }
            let Some(chosen) = run(harness, &all) else { return };
            assert!(chosen.indices.len() == 256 || method == "retries", "{method}: {}", chosen.indices.len());
            if method == "systematic" {
                let probabilities = cpu_reference::systematic(&weights, 256);
                for (index, probability) in (0..).zip(&probabilities) {
                    assert!(
                        *probability < 1.0 - 1e-5 || chosen.indices.contains(&index),
                        "{index} is certain"
                    );
                    assert!(
                        *probability > 1e-12 || !chosen.indices.contains(&index),
                        "{index}: {probability}"
                    );
                }
            }
        }
    }
}

/// What is no weight: negative, NaN, and a density of 0; infinite ones are the greatest.
#[test]
fn odd_weights_are_no_weights() {
    let all = points(64);
    let density: Vec<f32> = (0..64)
        .map(|i| match i % 4 {
            0 => 1.0,
            1 => 0.0,
            2 => f32::NAN,
            _ => -1.0,
        })
        .collect();
    for method in METHODS {
        let Some(chosen) = run(harness(method, 0, &all).density(&density).set("count", 12), &all) else {
            return;
        };
        assert!(chosen.indices.iter().all(|index| index.is_multiple_of(4)), "{method}: {:?}", chosen.indices);
        assert!(chosen.indices.len() >= 10);
    }
}

#[test]
fn every_iteration_chooses_others() {
    let all = points(1000);
    for method in METHODS {
        let at = |iteration: u32, seed: u32| {
            Some(run(harness(method, iteration, &all).seed(seed).set("count", 100), &all)?.indices)
        };
        let Some(first) = at(0, 0) else { return };
        assert_eq!(at(0, 0).unwrap(), first, "{method}");
        assert_ne!(at(1, 0).unwrap(), first, "{method}");
        assert_ne!(at(0, 1).unwrap(), first, "{method}");
    }
}

/// More retries leave fewer places empty.
#[test]
fn retries_fill_places() {
    let all = points(400);
    let mut before = 0;
    for retries in [0, 1, 8, 64] {
        let harness = harness("retries", 0, &all).set("count", 390).set("retries", retries);
        let Some(chosen) = run(harness, &all) else { return };
        let found = chosen.indices.len();
        assert!(found > before, "{found} after {retries} retries, {before} before");
        before = found;
    }
    // Without any, of N draws from N points all but the share 1/e find one that no other has found.
    let harness = harness("retries", 0, &points(4096)).set("count", 4096).set("retries", 0);
    let found = run(harness, &points(4096)).unwrap().indices.len() as f64;
    assert!((found / 4096.0 - (1.0 - (-1.0f64).exp())).abs() < 0.02, "{found} of 4096");
}

#[test]
fn inputs_have_one_length() {
    let words = std::panic::catch_unwind(|| {
        let harness = Harness::new(PASS).surface_points("points", 0, &points(5));
        harness.surface_points("origins", 0, &points(6)).run().is_none()
    });
    match words {
        Ok(skipped) => assert!(skipped, "there is no adapter"),
        Err(words) => {
            let words = words.downcast::<String>().expect("a message");
            assert!(words.contains("`origins` has 6 elements, but `points` has 5 elements"), "{words}");
        }
    }
}

/// What is chosen has the density of the points times how much more likely it is chosen: sums over what is chosen, each over its
/// density, are those over all points.
#[test]
fn the_density_of_what_is_chosen_gives_unbiased_sums() {
    let all = points(4000);
    let density: Vec<f32> = (0..4000).map(|i| (0.2 + random(i, 1)) as f32).collect();
    let radiosity: Vec<f32> = (0..4000).map(|i| (0.1 + random(i, 2).powi(2)) as f32).collect();
    // Of a function of the index that has nothing to do with either.
    let function = |i: u32| f64::from(i % 7);
    let whole: f64 =
        (0..4000_u32).map(|i| function(i) / f64::from(density[i as usize])).sum::<f64>() / 4000.0;
    for by_area in [false, true] {
        let mut estimates = Vec::new();
        for iteration in 0..24 {
            let harness = harness("systematic", iteration, &all).density(&density);
            let harness = if by_area { harness } else { harness.radiosity(&radiosity) };
            let Some(outputs) = harness.set("count", 500u32).set("by_area", by_area).run() else { return };
            let (_, chosen) = outputs.surface_points("resampled");
            let told: Vec<f32> = outputs.read("resampled_density");
            let sum: f64 =
                chosen.iter().zip(&told).map(|(point, told)| function(point.mark) / f64::from(*told)).sum();
            estimates.push((sum / chosen.len() as f64) as f32);
            if by_area {
                let even = told[..500].iter().all(|other| (other / told[0] - 1.0).abs() < 1e-3);
                assert!(even, "what is uniform by area has one density");
            }
        }
        let (mean, error) = pass_test::statistics::spread(estimates.into_iter());
        assert!((mean - whole).abs() < 4.0 * error, "by area {by_area}: {mean} ± {error}, not {whole}");
        assert!(error < 0.2 * whole, "± {error} of {whole}");
    }
}

#[test]
fn other_methods_tell_no_density() {
    let all = points(100);
    for method in ["race", "retries"] {
        let Some(outputs) = harness(method, 1, &all).density(&[1.0; 100]).set("count", 10u32).run() else {
            return;
        };
        assert!(outputs.read::<f32>("resampled_density").iter().all(|told| *told == 0.0));
    }
}

/// The arrivals of a race, -log(1 - x) over the weight with one random number x for each point, and who is first.
#[test]
fn a_race_takes_those_that_arrive_first() {
    let all = points(1000);
    let weights: Vec<f32> = (0..1000).map(|i| (0.05 + random(i, 6)) as f32).collect();
    for (iteration, count) in [(3, 1), (4, 100), (5, 999)] {
        let arrival = |i: &u32| {
            let x = f64::from(hash2(hash2(0, iteration), *i)) / 2f64.powi(32);
            -(-x).ln_1p() / f64::from(weights[*i as usize])
        };
        let mut expected: Vec<u32> = (0..1000).collect();
        expected.sort_by(|a, b| arrival(a).total_cmp(&arrival(b)));
        expected.truncate(count as usize);
        expected.sort_unstable();
        let Some(chosen) =
            run(harness("race", iteration, &all).radiosity(&weights).set("count", count), &all)
        else {
            return;
        };
        let mut found = chosen.indices;
        found.sort_unstable();
        assert_eq!(found, expected, "the first {count}");
    }
}

/// A random number that single precision rounds to 1 stands for an arrival that is late, but not infinitely late.
#[test]
fn the_greatest_random_number_arrives_too() {
    let (iteration, late) = (568_371, 12);
    assert!(hash2(hash2(0, iteration), late) > 0xffff_ff80, "it rounds to 1");
    let mut weights = vec![1.0; 16];
    weights[late as usize] = 1e30;
    let harness = harness("race", iteration, &points(16)).radiosity(&weights).set("count", 1u32);
    let Some(chosen) = run(harness, &points(16)) else { return };
    assert_eq!(chosen.indices, [late]);
}
