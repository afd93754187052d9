use crate::cpu_reference::{Cdf, Texel};
use pass_test::random::{halton3, hash, hash2, radical_inverse, unit_float};
use pass_test::statistics;

pub(crate) const SIZE: (u32, u32) = (12, 7);

/// A map with zeros, a row of zeros, and weights over four decades.
pub(crate) fn importance(layers: u32) -> Vec<f32> {
    let texels = SIZE.0 * SIZE.1;
    (0..layers * texels)
        .map(|i| {
            let row = i / SIZE.0 % SIZE.1;
            let bits = hash2(i, 17);
            if row == 3 || bits.is_multiple_of(4) {
                0.0
            } else {
                10.0_f32.powf(4.0 * unit_float(hash(bits)) as f32)
            }
        })
        .collect()
}

fn index(texel: &Texel) -> usize {
    ((texel.layer * SIZE.1 + texel.row) * SIZE.0 + texel.column) as usize
}

/// Numbers that are independent, unlike those of a sequence.
fn independent(i: u32) -> [f64; 3] {
    [0, 1, 2].map(|dimension| unit_float(hash2(i, dimension)))
}

/// Asserts that counts are those of independent samples, and that what has no importance is never sampled.
pub(crate) fn assert_follows(observed: &[u32], expected: &[f64]) {
    for (n, expected) in std::iter::zip(observed, expected) {
        assert!(*expected > 0.0 || *n == 0, "a texel of no importance was sampled");
    }
    statistics::assert_follows(observed, expected);
}

#[test]
fn halton_starts_as_in_the_textbook() {
    let expected = [
        [1.0 / 2.0, 1.0 / 3.0, 1.0 / 5.0],
        [1.0 / 4.0, 2.0 / 3.0, 2.0 / 5.0],
        [3.0 / 4.0, 1.0 / 9.0, 3.0 / 5.0],
        [1.0 / 8.0, 4.0 / 9.0, 4.0 / 5.0],
        [5.0 / 8.0, 7.0 / 9.0, 1.0 / 25.0],
    ];
    for (i, expected) in (1..).zip(expected) {
        assert_eq!(halton3(i, 0), expected, "element {i}");
    }
}

#[test]
fn every_run_of_a_power_of_the_base_visits_every_interval_once() {
    for (base, digits) in [(2, 9), (3, 6), (5, 4)] {
        let run = u32::pow(base, digits);
        for start in [0, run, 7 * run, 1000 * run] {
            let mut seen = vec![0; run as usize];
            // Elements on the edge of an interval may be rounded to the other side.
            let interval = |i| (radical_inverse(base, i) * f64::from(run) + 1e-9) as usize;
            (start..start + run).for_each(|i| seen[interval(i)] += 1);
            assert!(seen.iter().all(|n| *n == 1), "base {base}, from {start}");
        }
    }
}

#[test]
fn drawn_texels_follow_the_importance() {
    const DRAWS: u32 = 200_000;
    for layers in [1, 2, 6] {
        let map = importance(layers);
        let total: f64 = map.iter().map(|f| f64::from(*f)).sum();
        let cdf = Cdf::new(&map, SIZE);
        for dimensions in [3, 2] {
            let mut observed = vec![0_u32; map.len()];
            for i in 0..DRAWS {
                let texel = cdf.draw(independent(i), dimensions).expect("the map is not zero");
                observed[index(&texel)] += 1;
                let share = f64::from(map[index(&texel)]) / total;
                assert!((texel.probability - share).abs() < 1e-12, "{texel:?}: {share}");
            }
            let expected: Vec<f64> = map.iter().map(|f| f64::from(*f) / total * f64::from(DRAWS)).collect();
            assert_follows(&observed, &expected);
        }
    }
}

#[test]
fn virtual_lights_carry_the_flux_of_the_map() {
    const COUNT: u32 = 4096;
    for layers in [1, 2, 6] {
        let map = importance(layers);
        // Flux goes with importance, but not in proportion to it.
        let flux: Vec<f64> =
            (0..).zip(&map).map(|(i, f)| f64::from(*f) * (0.2 + unit_float(hash2(i, 99)))).collect();
        let reflected: f64 = flux.iter().sum();
        let total: f64 = map.iter().map(|f| f64::from(*f)).sum();
        let second_moment: f64 = std::iter::zip(&flux, &map)
            .filter(|(_, f)| **f > 0.0)
            .map(|(w, f)| w * w * total / f64::from(*f))
            .sum();
        let deviation = ((second_moment - reflected * reflected) / f64::from(COUNT)).sqrt();
        let cdf = Cdf::new(&map, SIZE);
        for dimensions in [3, 2] {
            for numbers in [|i| halton3(i + 1, 0), |i| halton3(i + 1, 5), independent] {
                let carried: f64 = (0..COUNT)
                    .filter_map(|i| cdf.draw(numbers(i), dimensions))
                    .map(|texel| flux[index(&texel)] / (f64::from(COUNT) * texel.probability))
                    .sum();
                let error = (carried - reflected).abs();
                assert!(
                    error < 5.0 * deviation,
                    "{layers} layers, {dimensions} numbers: {error} of {deviation}"
                );
            }
        }
    }
}

#[test]
fn maps_of_nothing_of_one_texel_and_of_extremes() {
    assert_eq!(Cdf::new(&[0.0; 12], (3, 2)).draw([0.5; 3], 3), None);
    assert_eq!(Cdf::new(&[f32::NAN, -1.0], (2, 1)).draw([0.5; 3], 3), None);

    let only = Texel { layer: 1, row: 1, column: 2, probability: 1.0 };
    let mut map = [0.0; 12];
    map[11] = 1e-30;
    let cdf = Cdf::new(&map, (3, 2));
    for number in [0.0, 0.3, 0.999_999_999] {
        assert_eq!(cdf.draw([number; 3], 3), Some(only));
        assert_eq!(cdf.draw([number; 3], 2), Some(only));
    }

    let one = Cdf::new(&[7.0], (1, 1)).draw([0.9; 3], 3);
    assert_eq!(one, Some(Texel { layer: 0, row: 0, column: 0, probability: 1.0 }));

    let wide = Cdf::new(&[1e-30, 1e30, 1e-30, 1e30], (2, 2));
    for i in 0..100 {
        let texel = wide.draw(independent(i), 3).expect("the map is not zero");
        assert_eq!((texel.column, texel.probability), (1, 0.5));
    }
}
