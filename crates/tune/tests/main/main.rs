//! Searches of grids whose best points are known.

use std::convert::Infallible;
use tune::{Axis, Evaluate, Measured, Options, Point, Target, front, full, search};

/// A renderer on paper: error of too few lights, of small maps, of interleaving; noise of a seed.
struct Paper {
    noise: f64,
    runs: usize,
}

const LIGHTS: [f64; 6] = [64.0, 128.0, 256.0, 512.0, 1024.0, 2048.0];
const MAPS: [f64; 5] = [16.0, 32.0, 64.0, 128.0, 256.0];
const BLOCKS: [f64; 5] = [1.0, 2.0, 4.0, 8.0, 16.0];

fn axes() -> Vec<Axis> {
    let ordered = |values: usize, start: usize| Axis { values, start, ordered: true };
    let unordered = Axis { values: 2, start: 0, ordered: false };
    vec![ordered(6, 4), ordered(5, 2), ordered(5, 2), ordered(5, 2), unordered.clone(), unordered]
}

impl Paper {
    fn exact(point: &Point) -> Measured {
        let (lights, map) = (LIGHTS[point[0]], MAPS[point[1]]);
        let blocks = BLOCKS[point[2]] * BLOCKS[point[3]];
        let filtered = point[4] == 0;
        let rays = point[5] == 1;
        let noise = 40.0 / lights * blocks.powf(0.6) / if filtered { 8.0 } else { 1.0 };
        let bias = if rays { 0.0 } else { 0.8 / map } + if filtered { 0.002 * blocks.sqrt() } else { 0.0 };
        let gathering = lights / blocks * if rays { 0.08 } else { 0.01 };
        let maps = if rays { 0.0 } else { lights * map * map * 2e-6 };
        Measured {
            error: 0.004 + noise + bias,
            ms: 1.0 + gathering + maps + if filtered { 0.3 } else { 0.0 },
        }
    }
}

impl Evaluate for Paper {
    type Error = Infallible;

    fn evaluate(&mut self, point: &Point, seed: u32) -> Result<Option<Measured>, Infallible> {
        self.runs += 1;
        // Blocks of 16 × 16 with few lights are refused, as a pipeline may be.
        if point[2] == 4 && point[3] == 4 && point[0] == 0 {
            return Ok(None);
        }
        let exact = Paper::exact(point);
        // What makes no difference has the same random numbers: maps where there are rays, and how blocks are shaped.
        let mut same = point.clone();
        same[1] *= usize::from(point[5] == 0);
        (same[2], same[3]) = (point[2] + point[3], 0);
        let hash = |salt: u64| {
            let mixed = same.iter().fold(u64::from(seed) ^ salt, |hash, value| {
                (hash ^ *value as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29)
            });
            (mixed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let scale = |salt| 1.0 + self.noise * hash(salt);
        Ok(Some(Measured { error: exact.error * scale(1), ms: exact.ms * scale(2) }))
    }
}

fn grid() -> Vec<Point> {
    axes().iter().fold(vec![Vec::new()], |points, axis| {
        let with =
            |point: &Point| (0..axis.values).map(|value| [&point[..], &[value]].concat()).collect::<Vec<_>>();
        points.iter().flat_map(with).collect()
    })
}

fn options(points: usize) -> Options {
    Options { points, kept: 16, judges: 8 }
}

/// The least error in a time, and the least time for an error, of the whole grid.
fn best(target: Target) -> f64 {
    let all = grid().into_iter().map(|point| Paper::exact(&point));
    let good = all.filter_map(|measured| match target {
        Target::Ms(most) => (measured.ms <= most).then_some(measured.error),
        Target::Error(most) => (measured.error <= most).then_some(measured.ms),
    });
    good.fold(f64::INFINITY, f64::min)
}

#[test]
fn a_tenth_of_the_grid_is_enough_to_come_within_a_twentieth_of_its_front() {
    let count = grid().len();
    assert_eq!(count, 3000);
    let targets = [2.0, 3.0, 5.0, 10.0, 30.0]
        .map(Target::Ms)
        .into_iter()
        .chain([0.2, 0.1, 0.05, 0.03].map(Target::Error));
    for target in targets {
        let mut paper = Paper { noise: 0.02, runs: 0 };
        let outcome = search(&axes(), target, &options(count / 10 - 100), &mut paper).unwrap();
        assert!(
            outcome.runs <= count / 10 && outcome.runs == paper.runs,
            "{target:?}: {} runs",
            outcome.runs
        );
        let winner = &outcome.tried[outcome.winner.unwrap_or_else(|| panic!("{target:?} has no winner"))];
        let exact = Paper::exact(&winner.point);
        let (found, expected) = match target {
            Target::Ms(_) => (exact.error, best(target)),
            Target::Error(_) => (exact.ms, best(target)),
        };
        assert!(found <= 1.05 * expected, "{target:?}: {found} for {expected}, {:?}", winner.point);
        assert!(winner.judged_by.len() == 8 && winner.meets(target));
    }
}

#[test]
fn what_nothing_reaches_has_no_winner() {
    let mut paper = Paper { noise: 0.0, runs: 0 };
    for target in [Target::Ms(0.5), Target::Error(0.001)] {
        let outcome = search(&axes(), target, &options(60), &mut paper).unwrap();
        assert_eq!(outcome.winner, None);
        assert!(outcome.tried.len() > 40);
    }
}

#[test]
fn all_points_are_measured_where_that_is_asked() {
    let mut paper = Paper { noise: 0.0, runs: 0 };
    let target = Target::Ms(5.0);
    let outcome = full(&axes(), target, 2, &mut paper).unwrap();
    // 20 of 3,000 cannot be.
    assert_eq!((outcome.tried.len(), outcome.runs), (2980, 6000));
    let winner = &outcome.tried[outcome.winner.unwrap()];
    assert_eq!(winner.error().0, best(target));
}

#[test]
fn a_grid_of_a_point_and_of_no_axes_is_searched() {
    struct One;
    impl Evaluate for One {
        type Error = Infallible;
        fn evaluate(&mut self, _: &Point, _: u32) -> Result<Option<Measured>, Infallible> {
            Ok(Some(Measured { error: 0.1, ms: 1.0 }))
        }
    }
    for axes in [vec![], vec![Axis { values: 1, start: 0, ordered: true }]] {
        let outcome = search(&axes, Target::Ms(2.0), &options(10), &mut One).unwrap();
        assert_eq!((outcome.tried.len(), outcome.winner), (1, Some(0)));
    }
}

#[test]
fn a_front_is_what_nothing_beats() {
    let points = [(2.0, 1.0), (1.0, 2.0), (3.0, 1.0), (1.0, 3.0), (4.0, 0.5), (f64::NAN, 0.0), (2.0, 1.0)];
    assert_eq!(front(&points), [1, 0, 4]);
    assert_eq!(front(&[]), Vec::<usize>::new());
}
