//! The distribution of the last sample, against the exact one of Metropolis-Hastings.

use crate::cpu_reference::{self, Chain, importance_of};
use pass_test::random::{halton3, hash, hash2, radical_inverse, shuffled, unit_float};
use pass_test::statistics::{assert_follows, chi_squared, chi_squared_limit};

pub(crate) const SIZE: (u32, u32) = (12, 7);

/// A map with zeros, a row of zeros, and values over two decades.
pub(crate) fn importance(layers: u32) -> Vec<f32> {
    (0..layers * SIZE.0 * SIZE.1)
        .map(|i| {
            let bits = hash2(i, 17);
            if i / SIZE.0 % SIZE.1 == 3 || bits.is_multiple_of(4) {
                0.0
            } else {
                10.0_f32.powf(2.0 * unit_float(hash(bits)) as f32)
            }
        })
        .collect()
}

/// The element that is proposed to a chain at a step.
pub(crate) fn element(chain: u32, step: u32, count: u32, seed: u32) -> u32 {
    cpu_reference::element(chain, step, count, |place| shuffled(place, count, hash2(seed, step)))
}

/// A map and where its texels are.
pub(crate) struct Map<'a> {
    pub(crate) importance: &'a [f32],
    pub(crate) size: (u32, u32),
}

impl Map<'_> {
    /// The texel of three numbers, for layer, column, row, and its f.
    pub(crate) fn texel(&self, numbers: [f64; 3]) -> (u32, f64) {
        let (width, height) = self.size;
        let pick = |number: f64, of: u32| ((number * f64::from(of)) as u32).min(of - 1);
        let layers = self.importance.len() as u32 / (width * height);
        let row = pick(numbers[0], layers) * height + pick(numbers[2], height);
        let texel = row * width + pick(numbers[1], width);
        (texel, importance_of(self.importance[texel as usize]))
    }

    /// A chain of this many samples, of four numbers each.
    pub(crate) fn chain(&self, steps: u32, numbers: impl Fn(u32) -> [f64; 4]) -> Chain {
        self.from(Chain::new, steps, numbers)
    }

    /// A chain of this many samples that begins as `start` makes it.
    pub(crate) fn from(
        &self,
        start: fn(u32, f64) -> Chain,
        steps: u32,
        numbers: impl Fn(u32) -> [f64; 4],
    ) -> Chain {
        let sample = |step| {
            let [layer, column, row, threshold] = numbers(step);
            (self.texel([layer, column, row]), threshold)
        };
        let ((texel, f), _) = sample(0);
        let mut chain = start(texel, f);
        for step in 1..steps {
            let ((texel, f), threshold) = sample(step);
            chain.propose(texel, f, threshold);
        }
        chain
    }
}

/// Four numbers that are independent, unlike those of a sequence.
pub(crate) fn independent(chain: u32, step: u32) -> [f64; 4] {
    [0, 1, 2, 3].map(|dimension| unit_float(hash2(hash2(chain, step), dimension)))
}

/// Four numbers as the shader has them.
pub(crate) fn halton(chain: u32, step: u32, count: u32, seed: u32) -> [f64; 4] {
    let element = element(chain, step, count, seed);
    let [layer, column, row] = halton3(element, seed);
    let shift = if seed == 0 { 0.0 } else { unit_float(hash2(seed, 3)) };
    [layer, column, row, (radical_inverse(7, element) + shift).fract()]
}

/// Probability of each texel after this many samples: the transition matrix of Metropolis-Hastings, M - 1 times.
pub(crate) fn distribution(map: &[f32], steps: u32) -> Vec<f64> {
    let f: Vec<f64> = map.iter().map(|&f| importance_of(f)).collect();
    let uniform = 1.0 / f.len() as f64;
    let mut p = vec![uniform; f.len()];
    for _ in 1..steps {
        let mut next = p.clone();
        for (from, &f_from) in f.iter().enumerate() {
            for (to, &f_to) in f.iter().enumerate().filter(|(_, f)| **f > 0.0) {
                let moved = p[from] * uniform * (f_to / f_from).min(1.0);
                next[from] -= moved;
                next[to] += moved;
            }
        }
        p = next;
    }
    p
}

/// Counts of the last samples.
pub(crate) fn histogram(texels: usize, last: impl Iterator<Item = u32>) -> Vec<u32> {
    let mut observed = vec![0; texels];
    last.for_each(|texel| observed[texel as usize] += 1);
    observed
}

pub(crate) fn times(p: &[f64], count: u32) -> Vec<f64> {
    p.iter().map(|p| p * f64::from(count)).collect()
}

#[test]
fn last_samples_follow_metropolis_hastings() {
    const COUNT: u32 = 40_000;
    for layers in [1, 6] {
        let map = importance(layers);
        let texels = Map { importance: &map, size: SIZE };
        for steps in [1, 5, 20, 100] {
            let expected = times(&distribution(&map, steps), COUNT);
            let run = |numbers: &dyn Fn(u32, u32) -> [f64; 4]| {
                let last = (0..COUNT).map(|chain| texels.chain(steps, |step| numbers(chain, step)).texel);
                let observed = histogram(map.len(), last);
                assert_follows(&observed, &expected);
            };
            run(&independent);
            run(&|chain, step| halton(chain, step, COUNT, 0));
            run(&|chain, step| halton(chain, step, COUNT, 9));
        }
    }
}

/// Each step leaves the target as it is and takes the distance to it down by the mean of f over its maximum at
/// least (Mengersen & Tweedie 1996).
#[test]
fn chains_tend_to_the_importance() {
    let map = importance(2);
    let total: f64 = map.iter().map(|f| f64::from(*f)).sum();
    let greatest = f64::from(map.iter().copied().fold(0.0, f32::max));
    let rate = 1.0 - total / map.len() as f64 / greatest;
    let distance = |steps: u32| {
        let p = distribution(&map, steps);
        0.5 * std::iter::zip(&p, &map).map(|(p, f)| (p - f64::from(*f) / total).abs()).sum::<f64>()
    };
    for steps in [1, 5, 20, 100] {
        let (distance, bound) = (distance(steps), rate.powf(f64::from(steps - 1)));
        assert!(distance <= bound + 1e-12, "{steps} steps: {distance}, {bound}");
    }
    assert!(distance(1) > 0.4 && distance(5) < 0.25 && distance(100) < 1e-3);
}

#[test]
fn last_samples_of_long_chains_follow_the_importance() {
    const COUNT: u32 = 40_000;
    for layers in [1, 6] {
        let map = importance(layers);
        let total: f64 = map.iter().map(|f| f64::from(*f)).sum();
        let target: Vec<f64> = map.iter().map(|f| f64::from(*f) / total).collect();
        let texels = Map { importance: &map, size: SIZE };
        let run = |steps| {
            let last =
                (0..COUNT).map(|chain| texels.chain(steps, |step| halton(chain, step, COUNT, 0)).texel);
            histogram(map.len(), last)
        };
        assert_follows(&run(100), &times(&target, COUNT));
        // Chains of five do not yet: the test tells them apart.
        let (statistic, freedom) = chi_squared(&run(5), &times(&target, COUNT));
        assert!(statistic > chi_squared_limit(freedom), "{statistic} of {freedom}");
    }
}

#[test]
fn chains_leave_what_has_no_importance_and_do_not_go_there() {
    let mut chain = Chain::new(0, 0.0);
    chain.propose(1, 0.0, 0.999);
    assert_eq!(chain.texel, 0);
    chain.propose(2, 1e-30, 0.0);
    assert_eq!((chain.texel, chain.importance), (2, 1e-30));
    chain.propose(3, 0.0, 0.999_999_9);
    assert_eq!(chain.texel, 2);
    // A rise is accepted whatever the number; a fall of 60 decades with none of 24 bits.
    chain.propose(4, 1e30, 0.0);
    assert_eq!(chain.texel, 4);
    chain.propose(5, 1e-30, 1.0 - 1.0 / 16_777_216.0);
    assert_eq!(chain.texel, 4);
    chain.propose(6, 0.5e30, 0.5);
    assert_eq!(chain.texel, 6);
    chain.propose(7, 0.25e30, 0.49);
    assert_eq!((chain.texel, chain.steps), (6, 8));
}
