//! The shaders against the CPU reference, on a GPU.

use crate::chains::{Map, SIZE, distribution, halton, histogram, importance, times};
use crate::cpu_reference::{Chain, Weights};
use interfaces::virtual_lights::VirtualLight;
use pass_test::random::{halton3, hash, hash2, unit_float};
use pass_test::statistics::assert_follows;
use pass_test::{Harness, Outputs, RsmTexel};
use sample_metropolis::PASS;

const WEIGHTS: [(&str, Weights); 4] = [
    ("local-mean", Weights::LocalMean),
    ("single", Weights::Single),
    ("none", Weights::None),
    ("reservoir", Weights::Reservoir),
];

/// Settings and seed of a run.
#[derive(Clone, Copy)]
struct Run {
    count: u32,
    steps: u32,
    weights: &'static str,
    seed: u32,
}

/// Samples a reflective shadow map whose texel i lies at (i, 0, 0) and reflects 1 W in red, so that the red of a
/// light is texels / N · w / f.
fn run(map: &[f32], size: (u32, u32), run: Run) -> Option<Outputs> {
    let texel = |i| RsmTexel {
        position: [i as f32, 0.0, 0.0, 1.0],
        normal: [0.0, 1.2, 1.6],
        flux: [1.0, 0.0, 0.0, 0.0],
    };
    let texels: Vec<RsmTexel> = (0..map.len()).map(texel).collect();
    Harness::new(PASS)
        .set("count", run.count)
        .set("steps", run.steps)
        .set("weights", run.weights)
        .seed(run.seed)
        .rsm(size, &texels)
        .importance(size, map)
        .run()
}

fn draw(map: &[f32], size: (u32, u32), settings: Run) -> Option<Vec<VirtualLight>> {
    Some(run(map, size, settings)?.lights("lights"))
}

/// The chains of the CPU reference, with the numbers of the shader.
fn chains(map: &[f32], size: (u32, u32), run: Run) -> Vec<Chain> {
    let seed = pass::pass_seed(run.seed, "sample-metropolis");
    let map = Map { importance: map, size };
    let start = if run.weights == "reservoir" { Chain::reservoir } else { Chain::new };
    let chain = |chain| map.from(start, run.steps, |step| halton(chain, step, run.count, seed));
    (0..run.count).map(chain).collect()
}

#[test]
fn lights_are_those_of_the_cpu_reference() {
    let decades = |texels: u32, decades: f64| -> Vec<f32> {
        (0..texels).map(|i| 10.0_f64.powf(decades * (unit_float(hash2(i, 5)) - 0.5)) as f32).collect()
    };
    let maps = [
        (importance(1), SIZE),
        (importance(2), SIZE),
        (importance(7), SIZE),
        (decades(64 * 64 * 6, 4.0), (64, 64)),
        (decades(5 * 70 * 3, 60.0), (5, 70)),
    ];
    // More chains than texels, a power of two or not.
    for (steps, count, seed) in [(1, 1024, 0), (2, 1000, 7), (5, 1024, 0), (5, 1024, 7), (100, 300, 7)] {
        for (map, size) in &maps {
            for (name, weights) in WEIGHTS {
                let settings = Run { count, steps, weights: name, seed };
                let Some(lights) = draw(map, *size, settings) else { return };
                let chains = chains(map, *size, settings);
                let proposals = f64::from(count) * f64::from(steps);
                let mean = chains.iter().map(|chain| chain.sum).sum::<f64>() / proposals;
                assert_eq!(lights.len(), count as usize);
                let mut elsewhere = 0;
                for (light, chain) in lights.iter().zip(&chains) {
                    let expected = map.len() as f64 / f64::from(count) * chain.ratio(weights, mean);
                    let flux = f64::from(light.flux[0]);
                    // What is less than f32 holds is 0.
                    let tolerance = 1e-5 * expected + 1e-36;
                    let same = light.texel == chain.texel && (flux - expected).abs() <= tolerance;
                    elsewhere += u32::from(!same);
                    assert_eq!(light.position, [light.texel as f32, 0.0, 0.0]);
                    assert!((light.normal[2] - 0.8).abs() < 1e-6 && light.area == 0.0);
                }
                // A number within rounding of a texel's edge may fall to either side, and change the chain.
                assert!(
                    f64::from(elsewhere) <= 2.0 + 1e-4 * proposals,
                    "{name}, {count} chains of {steps}: {elsewhere} differ"
                );
            }
        }
    }
}

/// 4096 chains of 1024 steps are followed at once; the others after them.
#[test]
fn more_proposals_than_are_stored_take_parts() {
    let map = importance(1);
    let settings = Run { count: 4200, steps: 1024, weights: "local-mean", seed: 7 };
    let Some(lights) = draw(&map, SIZE, settings) else { return };
    let chains = chains(&map, SIZE, settings);
    let same = |(light, chain): &(&VirtualLight, &Chain)| light.texel == chain.texel;
    let alike = lights.iter().zip(&chains).skip(4096).filter(same).count();
    // A tenth of such long chains meets a number within rounding of a texel's edge.
    assert!(alike > 80, "{alike} of the last 104");
}

#[test]
fn chains_of_one_step_are_uniform_sampling() {
    let map: Vec<f32> = importance(6).iter().map(|f| f + 0.1).collect();
    for weights in ["local-mean", "single"] {
        let settings = Run { count: 1024, steps: 1, weights, seed: 0 };
        let Some(lights) = draw(&map, SIZE, settings) else { return };
        let expected = 6.0 * (SIZE.0 * SIZE.1) as f32 / 1024.0;
        assert!(lights.iter().all(|light| (light.flux[0] / expected - 1.0).abs() < 1e-6));
        // The texels of sample-uniform: elements in order, those of each base on a grid of their own.
        let seed = pass::pass_seed(0, "sample-metropolis");
        let uniform = |chain: u32| Map { importance: &map, size: SIZE }.texel(halton3(chain + 1, seed)).0;
        let elsewhere = (0..).zip(&lights).filter(|(chain, light)| light.texel != uniform(*chain)).count();
        assert!(elsewhere <= 2, "{elsewhere} lights are at another texel");
    }
}

#[test]
fn last_samples_follow_metropolis_hastings() {
    for layers in [1, 7] {
        let map = importance(layers);
        let total: f64 = map.iter().map(|f| f64::from(*f)).sum();
        for (steps, seed) in [(1, 0), (5, 0), (20, 3), (100, 3)] {
            let settings = Run { count: 50_000, steps, weights: "local-mean", seed };
            let Some(lights) = draw(&map, SIZE, settings) else { return };
            let observed = histogram(map.len(), lights.iter().map(|light| light.texel));
            assert_follows(&observed, &times(&distribution(&map, steps), settings.count));
            if steps == 100 {
                let target: Vec<f64> = map.iter().map(|f| f64::from(*f) / total).collect();
                assert_follows(&observed, &times(&target, settings.count));
            }
        }
    }
}

/// The purpose of this sampler: lights move only where they met what changed (TCAS §4.3).
#[test]
fn a_change_of_one_texel_moves_only_chains_that_met_it() {
    let settings = Run { count: 1024, steps: 5, weights: "local-mean", seed: 0 };
    let before = importance(6);
    let mut after = before.clone();
    let changed = 6 * SIZE.0 + 5;
    after[changed as usize] += 300.0;
    let Some(a) = draw(&before, SIZE, settings) else { return };
    let Some(b) = draw(&after, SIZE, settings) else { return };
    let moved = std::iter::zip(&a, &b).filter(|(a, b)| a != b);
    let sums = std::iter::zip(chains(&before, SIZE, settings), chains(&after, SIZE, settings));
    let met = sums.filter(|(before, after)| before.sum != after.sum).count();
    let moved = moved.count();
    assert!(moved > 0 && moved <= met + 1, "{moved} of 1024 lights moved, {met} met the texel");
    assert!(met < 30, "{met}: 5 of 504 texels are met by a chain");
}

#[test]
fn nothing_and_one_texel() {
    for (weights, _) in WEIGHTS {
        let settings = Run { count: 100, steps: 5, weights, seed: 3 };
        let Some(dark) = draw(&[0.0; 64], (8, 8), settings) else { return };
        assert_eq!(dark.len(), 100);
        assert!(dark.iter().all(|light| light.flux == [0.0; 3]), "{weights}: {dark:?}");

        for f in [1e-30, 1.2e-38, 1e30, f32::MAX] {
            let mut map = [0.0; 128];
            map[77] = f;
            let Some(lights) = draw(&map, (8, 8), Run { count: 4096, ..settings }) else { return };
            let lit = lights.iter().filter(|light| light.flux[0] > 0.0);
            assert!(lit.clone().all(|light| light.texel == 77), "{weights}, {f}");
            let carried: f32 = lit.map(|light| light.flux[0]).sum();
            // The proposals that hit the texel are 160 of 20,480. Without weights each chain that met it counts, of
            // which there are 1 - (1 - 1/128)^5 = 3.8 %, and carries f̄ / f = 1/128.
            let expected = if weights == "none" { 128.0 / 128.0 * 0.0384 } else { 1.0 };
            assert!((carried / expected - 1.0).abs() < 0.25, "{weights}, {f}: {carried} of {expected}");
        }
    }
}

#[test]
fn every_number_is_finite_whatever_the_importance() {
    let wide: Vec<f32> = (0..128_u32)
        .map(|i| if i % 5 == 0 { 0.0 } else { 10.0_f64.powf(60.0 * unit_float(hash(i)) - 30.0) as f32 })
        .collect();
    let mut strange = wide.clone();
    (strange[3], strange[4], strange[127]) = (f32::NAN, -5.0, f32::INFINITY);
    (strange[8], strange[9]) = (f32::from_bits(1), -f32::NAN);
    for (weights, _) in WEIGHTS {
        for (count, steps) in [(1, 1), (1, 5), (1000, 1), (1000, 5), (200, 1024)] {
            let settings = Run { count, steps, weights, seed: 1 };
            for map in [&wide, &strange] {
                let Some(lights) = draw(map, (8, 8), settings) else { return };
                let greatest = 128.0 / count as f32 * 16_777_216.0;
                for light in &lights {
                    assert!((0.0..=greatest).contains(&light.flux[0]), "{weights}, {steps} steps: {light:?}");
                    let nothing = [3, 4, 9].contains(&light.texel) && steps > 100;
                    assert!(!nothing || light.flux[0] == 0.0, "{weights}: {light:?}");
                }
            }
            for f in [f32::MAX, 1.0, f32::MIN_POSITIVE] {
                let Some(lights) = draw(&[f; 128], (8, 8), settings) else { return };
                let even = |light: &VirtualLight| (light.flux[0] * count as f32 / 128.0 - 1.0).abs() < 1e-5;
                assert!(lights.iter().all(even), "{weights} of {f}: {:?}", lights[0]);
            }
        }
    }
}

#[test]
fn one_texel_and_one_light() {
    let settings = Run { count: 1, steps: 5, weights: "local-mean", seed: 0 };
    let Some(one) = draw(&[2.0], (1, 1), settings) else { return };
    assert_eq!((one.len(), one[0].flux[0]), (1, 1.0));
    let many = draw(&[2.0], (1, 1), Run { count: 100, ..settings }).unwrap_or_default();
    assert!(many.len() == 100 && many.iter().all(|light| light.texel == 0 && light.flux[0] == 0.01));
}
