//! The mean of the estimator, by all proposals and acceptances that a chain can meet.

use crate::chains::{Map, SIZE, distribution, halton, importance, independent};
use crate::cpu_reference::{Chain, Weights};
use pass_test::random::{hash2, unit_float};

/// Expectation of flux · texels · w / f over all chains of this many samples, exactly.
fn expectation(f: &[f64], flux: &[f64], steps: u32, weights: Weights) -> f64 {
    let texels = f.len() as f64;
    let mean = f.iter().sum::<f64>() / texels;
    let new = if weights == Weights::Reservoir { Chain::reservoir } else { Chain::new };
    let start = |texel: usize| new(texel as u32, f[texel]);
    let of_chain = |chain: &Chain| flux[chain.texel as usize] * texels * chain.ratio(weights, mean);
    (0..f.len()).map(|texel| rest(start(texel), f, steps, &of_chain)).sum::<f64>() / texels
}

/// Mean of `of_chain` over what can come of a chain.
fn rest(chain: Chain, f: &[f64], steps: u32, of_chain: &dyn Fn(&Chain) -> f64) -> f64 {
    if chain.steps == steps {
        return of_chain(&chain);
    }
    let branch = |texel: usize, accept: bool| {
        let probability = if accept { chain.acceptance(f[texel]) } else { 1.0 - chain.acceptance(f[texel]) };
        if probability == 0.0 {
            return 0.0;
        }
        let mut next = chain;
        next.propose(texel as u32, f[texel], if accept { 1.0_f64.next_down() } else { 0.0 });
        probability * rest(next, f, steps, of_chain)
    };
    (0..f.len()).map(|texel| branch(texel, true) + branch(texel, false)).sum::<f64>() / f.len() as f64
}

const F: [f64; 4] = [0.5, 8.0, 1.0, 0.0];
const FLUX: [f64; 4] = [3.0, 5.0, 0.5, 0.0];

fn close(a: f64, b: f64) -> bool {
    (a / b - 1.0).abs() < 1e-12
}

#[test]
fn one_step_is_uniform_sampling() {
    for weights in [Weights::LocalMean, Weights::Single] {
        for (texel, f) in (0..).zip(F) {
            let ratio = Chain::new(texel, f).ratio(weights, 123.0);
            assert_eq!(ratio, if f > 0.0 { 1.0 } else { 0.0 });
        }
        assert!(close(expectation(&F, &FLUX, 1, weights), 8.5));
    }
    // Without weights: T Σ F f̄ / (T f).
    let biased = 9.5 / 4.0 * (3.0 / 0.5 + 5.0 / 8.0 + 0.5 / 1.0);
    assert!(close(expectation(&F, &FLUX, 1, Weights::None), biased));
}

/// TCAS §4.3.1: unbiased for M > 1 if f is proportional to what is estimated.
#[test]
fn the_local_mean_is_unbiased_for_what_is_proportional_to_the_importance() {
    let flux = F.map(|f| 3.0 * f);
    for steps in 1..7 {
        assert!(close(expectation(&F, &flux, steps, Weights::LocalMean), 28.5), "{steps}");
    }
}

/// Veach & Guibas 1997: a chain weighted by its first sample is in equilibrium from the start.
#[test]
fn the_single_weight_is_unbiased_whatever_is_estimated() {
    for steps in 1..7 {
        assert!(close(expectation(&F, &FLUX, steps, Weights::Single), 8.5), "{steps}");
    }
}

/// Talbot, Cline & Egbert 2005: resampling is unbiased wherever f is not 0.
#[test]
fn the_reservoir_is_unbiased_whatever_is_estimated() {
    for steps in 1..7 {
        assert!(close(expectation(&F, &FLUX, steps, Weights::Reservoir), 8.5), "{steps}");
    }
    // Of two proposals, each is chosen in proportion to its importance, whatever their order.
    for (first, second) in [(1.0, 3.0), (3.0, 1.0)] {
        assert_eq!(Chain::reservoir(0, first).acceptance(second), second / 4.0);
    }
}

#[test]
fn the_local_mean_takes_out_most_of_the_start_up_bias() {
    for steps in 2..7 {
        let bias = |weights| (expectation(&F, &FLUX, steps, weights) / 8.5 - 1.0).abs();
        let (reduced, all) = (bias(Weights::LocalMean), bias(Weights::None));
        assert!(reduced < all, "{steps} steps: {reduced}, {all}");
    }
}

/// Mean and standard deviation of the mean of `count` chains' flux · texels · w / f.
fn estimate(count: u32, of_chain: impl Fn(u32) -> f64) -> (f64, f64) {
    let (mut sum, mut squares) = (0.0, 0.0);
    for chain in 0..count {
        let light = of_chain(chain);
        sum += light;
        squares += light * light;
    }
    let count = f64::from(count);
    let mean = sum / count;
    (mean, ((squares / count - mean * mean) / count).sqrt())
}

/// The inverse transform's mean is the flux of all texels that have importance; that of Fig. 6 tends to it with M.
#[test]
fn means_are_those_of_the_inverse_transform() {
    const COUNT: u32 = 40_000;
    for layers in [1, 6] {
        let map = importance(layers);
        // Flux goes with importance, but not in proportion to it.
        let flux: Vec<f64> =
            (0..).zip(&map).map(|(i, f)| f64::from(*f).sqrt() * (0.2 + unit_float(hash2(i, 99)))).collect();
        let (total, texels) = (flux.iter().sum::<f64>(), map.len() as f64);
        let mean = map.iter().map(|f| f64::from(*f)).sum::<f64>() / texels;
        let table = Map { importance: &map, size: SIZE };
        for steps in [1, 5, 20, 100] {
            let last = distribution(&map, steps);
            let lit = (0..map.len()).filter(|i| map[*i] > 0.0);
            let biased: f64 = lit.map(|i| last[i] * texels * flux[i] * mean / f64::from(map[i])).sum();
            let estimated = |weights, numbers: &dyn Fn(u32, u32) -> [f64; 4]| {
                estimate(COUNT, |chain| {
                    let chain = table.chain(steps, |step| numbers(chain, step));
                    flux[chain.texel as usize] * texels * chain.ratio(weights, mean)
                })
            };
            let dealt: &dyn Fn(u32, u32) -> [f64; 4] = &|chain, step| halton(chain, step, COUNT, 0);
            for numbers in [&independent as &dyn Fn(u32, u32) -> [f64; 4], dealt] {
                let (single, deviation) = estimated(Weights::Single, numbers);
                assert!(
                    (single - total).abs() < 5.0 * deviation,
                    "single, {steps} steps: {single} of {total}"
                );
                let (none, deviation) = estimated(Weights::None, numbers);
                assert!((none - biased).abs() < 5.0 * deviation, "none, {steps} steps: {none} of {biased}");
                // Of the local mean's bias the paper says only that it is less.
                let (local, deviation) = estimated(Weights::LocalMean, numbers);
                let bias = (local - total).abs();
                let allowed = match steps {
                    1 => 0.0,
                    5 => 0.3 * (biased - total).abs(),
                    20 => 0.06 * total,
                    _ => 0.02 * total,
                };
                assert!(bias < allowed + 5.0 * deviation, "local mean, {steps} steps: {local} of {total}");
            }
        }
    }
}
