//! Sums.

use crate::bench::Bench;
use crate::{LENGTHS, MANY, cx, numbers};
use gpu_algorithms::{reduce, reference};
use pass::Define;

/// The words of the sum of the first `length` of at most `bound` weights.
fn sum_of(weights: &[f32], bound: u32, of: &str, few: bool) -> Option<Vec<u32>> {
    let words: Vec<u32> = weights.iter().map(|weight| weight.to_bits()).collect();
    let shader = pass::request("crates/gpu-algorithms/tests/main/sum.wgsl", &[("SUM", Define::from(of))]);
    let bytes = match of {
        "scaled" => 8,
        "vec4" => 16,
        _ => 4,
    };
    let steps = if few {
        vec![reduce::few(&shader)]
    } else {
        reduce::steps(&cx(), &shader, bound, "scratch").unwrap()
    };
    let outputs = Bench::default()
        .input("count", &[weights.len() as u32])
        .input("weights", &words)
        .output("sum", bytes as usize / 4)
        .steps((!few).then(|| reduce::scratch(&cx(), "scratch", bound, bytes).unwrap()), steps)
        .run()?;
    Some(outputs.read("sum"))
}

fn weights(length: u32) -> Vec<f32> {
    numbers(length, 1 << 24).into_iter().map(|x| x as f32 / 1024.0).collect()
}

fn exact(weights: &[f32]) -> f64 {
    reference::sum(weights.iter().map(|weight| f64::from(*weight)))
}

#[test]
fn sums_are_those_of_double_precision() {
    for length in LENGTHS.into_iter().chain([MANY]) {
        let weights = weights(length);
        let wanted = exact(&weights);
        for few in [false, true] {
            let Some(words) = sum_of(&weights, length, "f32", few) else { return };
            let sum = f64::from(f32::from_bits(words[0]));
            // 8 additions in a thread, 8 in a workgroup, and again; `few` adds every 256th in turn.
            let additions = if few { f64::from(length) / 256.0 + 8.0 } else { 32.0 };
            assert!((sum - wanted).abs() <= additions * 6e-8 * wanted, "{length}: {sum} {wanted}");
        }
    }
}

#[test]
fn scaled_sums_leave_the_range_of_single_precision() {
    for length in [0, 1, 257, 2049, 131_073] {
        for magnitude in [-30, 0, 31] {
            let unit = 10.0_f64.powi(magnitude);
            let weights: Vec<f32> =
                weights(length).into_iter().map(|weight| (f64::from(weight) * unit) as f32).collect();
            let Some(words) = sum_of(&weights, length, "scaled", false) else { return };
            let sum = f64::from(f32::from_bits(words[0])) * 2.0_f64.powi(words[1] as i32);
            let wanted = exact(&weights);
            assert!((sum - wanted).abs() <= 2e-6 * wanted, "{length} of 1e{magnitude}: {sum} {wanted}");
        }
    }
}

#[test]
fn vectors_are_summed_channel_by_channel() {
    for length in [0, 1, 257, 2049, 131_073] {
        let weights = weights(length);
        let wanted = exact(&weights);
        for few in [false, true] {
            let Some(words) = sum_of(&weights, length, "vec4", few) else { return };
            let sum = words.into_iter().map(f32::from_bits).map(f64::from).collect::<Vec<_>>();
            for (sum, wanted) in sum.iter().zip([wanted, -wanted, f64::from(length), 0.0]) {
                let additions = if few { f64::from(length) / 256.0 + 8.0 } else { 32.0 };
                assert!((sum - wanted).abs() <= additions * 6e-8 * wanted.abs(), "{length}: {sum} {wanted}");
            }
        }
    }
}

#[test]
fn fewer_elements_than_the_bound_are_summed_alone() {
    for length in [0, 1, 2048, 2049] {
        let weights = weights(length);
        let [Some(bound), Some(own)] =
            [sum_of(&weights, 100_000, "f32", false), sum_of(&weights, length, "f32", false)]
        else {
            return;
        };
        assert_eq!(bound, own, "{length}");
    }
}
