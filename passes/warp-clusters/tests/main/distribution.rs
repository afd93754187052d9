//! Where seeds go, by the CPU reference.

use crate::cpu_reference::{Place, Pyramid, choose};
use crate::maps::{halton, importance, independent, map, texel};
use pass_test::statistics::{assert_follows, chi_squared, chi_squared_limit};

const COUNT: u32 = 50_000;

/// The number of places in each texel.
fn histogram(map: &Pyramid, places: &[Place]) -> Vec<u32> {
    let mut counts = vec![0; map.texels.len()];
    places.iter().for_each(|place| counts[map.texel_at(place) as usize] += 1);
    counts
}

fn places(map: &Pyramid, seeds: &[[f64; 2]], bottom: u32) -> Vec<Place> {
    seeds.iter().map(|seed| map.warp_seed(*seed, bottom)).collect()
}

/// Expected number at each texel if all levels are descended.
fn expected(map: &Pyramid, count: u32) -> Vec<f64> {
    let total: f64 = map.sums[0].iter().sum();
    map.sums[0].iter().map(|f| f / total * f64::from(count)).collect()
}

#[test]
fn sums_are_those_of_their_texels() {
    for (size, layers) in [([1, 1], 1), ([3, 1], 2), ([1, 5], 1), ([3, 7], 3), ([8, 8], 2), ([300, 3], 1)] {
        let map = map(&importance(size, layers), size);
        for level in 0..=map.top() {
            let [columns, rows] = map.size_at(level);
            let squares =
                (0..layers).flat_map(|l| (0..rows).flat_map(move |y| (0..columns).map(move |x| (l, x, y))));
            for (layer, x, y) in squares {
                let inside = |i: u32| {
                    let (row, column) = (i / size[0] % size[1], i % size[0]);
                    (i / (size[0] * size[1]), row >> level, column >> level) == (layer, y, x)
                };
                let sum: f64 = (0..).zip(&map.sums[0]).filter(|(i, _)| inside(*i)).map(|(_, f)| f).sum();
                assert!(
                    (map.sum_at(level, layer, [x, y]) - sum).abs() <= 1e-9 * sum,
                    "{size:?}, level {level}"
                );
            }
        }
        assert_eq!(map.size_at(map.top()), [1, 1]);
    }
}

#[test]
fn seeds_follow_the_importance() {
    for (size, layers) in [([12, 7], 1), ([12, 7], 5), ([16, 16], 1), ([1, 9], 3), ([300, 1], 1), ([3, 3], 7)]
    {
        let map = map(&importance(size, layers), size);
        for seeds in [halton(COUNT), independent(COUNT, 1)] {
            let places = places(&map, &seeds, 0);
            let counts = histogram(&map, &places);
            assert_follows(&counts, &expected(&map, COUNT));
            let nothing = counts.iter().zip(&map.sums[0]).filter(|(n, f)| **n > 0 && **f == 0.0).count();
            assert_eq!(nothing, 0, "texels without importance have seeds");
        }
    }
}

/// In a square of the last level all places are alike, so the test above distinguishes the two.
#[test]
fn fewer_levels_leave_squares_even() {
    let size = [13, 10];
    let map = map(&importance(size, 2), size);
    let total: f64 = map.sums[0].iter().sum();
    for bottom in 0..=map.top() {
        let area = |corner: u32, side: u32| (1 << bottom).min(side - corner);
        let even = |i: u32| {
            let (layer, x, y) =
                (i / (size[0] * size[1]), (i % size[0]) >> bottom, (i / size[0] % size[1]) >> bottom);
            let texels = area(x << bottom, size[0]) * area(y << bottom, size[1]);
            map.sum_at(bottom, layer, [x, y]) / f64::from(texels) / total * f64::from(COUNT)
        };
        let even: Vec<f64> = (0..map.texels.len() as u32).map(even).collect();
        let counts = histogram(&map, &places(&map, &independent(COUNT, 2), bottom));
        assert_follows(&counts, &even);
        let (statistic, freedom) = chi_squared(&counts, &expected(&map, COUNT));
        assert_eq!(statistic < chi_squared_limit(freedom), bottom == 0, "bottom {bottom}: {statistic}");
    }
}

/// Within a texel, places are as even as over the map.
#[test]
fn places_within_a_texel_are_even() {
    let size = [6, 5];
    let map = map(&importance(size, 2), size);
    for seeds in [halton(COUNT), independent(COUNT, 3)] {
        let mut cells = vec![0; 64];
        for place in places(&map, &seeds, 0) {
            let [x, y] = place.uv.map(|at| (at.fract() * 8.0) as usize);
            cells[8 * y + x] += 1;
        }
        assert_follows(&cells, &[f64::from(COUNT) / 64.0; 64]);
    }
}

/// The greatest difference between how many seeds a square of the pyramid has and its share of them.
fn unevenness(map: &Pyramid, seeds: &[[f64; 2]]) -> f64 {
    let counts: Vec<f32> = histogram(map, &places(map, seeds, 0)).iter().map(|n| *n as f32).collect();
    let counts = crate::maps::map(&counts, map.size);
    let total: f64 = map.sums[0].iter().sum();
    let squares = std::iter::zip(map.sums.iter().flatten(), counts.sums.iter().flatten());
    squares.map(|(f, n)| (n - f / total * seeds.len() as f64).abs()).fold(0.0, f64::max)
}

/// What warping is for, and sampling by one number is not: each square has its share of the seeds to within few, since it
/// is the image of a rectangle of the unit square (Clarberg et al. 2005).
#[test]
fn warped_seeds_are_as_even_as_the_sequence() {
    let size = [32, 32];
    for layers in [1, 3] {
        let map = map(&importance(size, layers), size);
        for count in [128, 1000, 4096] {
            let even = unevenness(&map, &halton(count));
            let random = (0..5).map(|salt| unevenness(&map, &independent(count, salt)));
            let random = random.fold(f64::INFINITY, f64::min);
            assert!(even < 7.0 && even < 0.75 * random, "{layers} layers, {count}: {even} against {random}");
        }
    }
}

#[test]
fn without_importance_seeds_stay_where_they_are() {
    let size = [10, 6];
    let map = map(&[0.0; 180], size);
    for seed in halton(100) {
        let place = map.warp_seed(seed, 0);
        assert_eq!(place.layer, (3.0 * seed[0]) as u32);
        let expected = [10.0 * (3.0 * seed[0]).fract(), 6.0 * seed[1]];
        assert!(std::iter::zip(place.uv, expected).all(|(a, b)| (a - b).abs() < 1e-5));
    }
}

#[test]
fn a_number_is_spread_over_what_it_chooses() {
    assert_eq!(choose(0.25, 1.0, 1.0), (0, 0.5));
    assert_eq!(choose(0.75, 1.0, 3.0), (1, 2.0 / 3.0));
    assert_eq!(choose(0.0, 0.0, 2.0), (1, 0.0));
    assert_eq!(choose(0.5, 2.0, 0.0), (0, 0.5));
    let one = Pyramid::new(vec![texel(0, 2.0)], [1, 1]);
    assert_eq!(one.warp_seed([0.25, 0.75], 0), Place { layer: 0, uv: [0.25, 0.75] });
}
