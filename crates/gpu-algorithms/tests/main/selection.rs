//! Selection by rank.

use crate::bench::Bench;
use crate::{LENGTHS, cx, numbers};
use gpu_algorithms::{reference, select};

/// `key_of_f32` of shaders/algorithms/sort-keys.wgsl.
fn key_of(x: f32) -> u32 {
    let bits = x.to_bits();
    bits ^ if bits >> 31 == 1 { u32::MAX } else { 1 << 31 }
}

#[test]
fn the_number_of_each_rank_is_found() {
    for length in LENGTHS {
        let floats: Vec<f32> = numbers(length, 1 << 32)
            .into_iter()
            .map(|x| (x as f32 - 2e9) * 2.0_f32.powi(x as i32 % 60))
            .collect();
        let keys: Vec<u32> = floats.iter().map(|x| key_of(*x)).collect();
        let words: Vec<u32> = floats.iter().map(|x| x.to_bits()).collect();
        // The smallest, a quantile, the greatest, and beyond.
        for rank in [0, length * 9 / 10, length.saturating_sub(1), length + 5] {
            let shader = pass::request("crates/gpu-algorithms/tests/main/select.wgsl", &[]);
            let outputs = Bench::default()
                .input("count", &[length, rank])
                .input("numbers", &words)
                .output("found", 2)
                .steps(
                    [select::scratch(&cx(), "scratch").unwrap()],
                    select::steps(&cx(), &shader, length, "scratch").unwrap(),
                )
                .run();
            let Some(outputs) = outputs else { return };
            let wanted = reference::select(&keys, rank);
            let found: Vec<u32> = outputs.read("found");
            assert_eq!(found[0], wanted, "rank {rank} of {length}");
            assert!(length == 0 || words.contains(&found[1]), "rank {rank} of {length}");
        }
    }
}

#[test]
fn keys_are_in_the_order_of_their_numbers() {
    let rising = [f32::NEG_INFINITY, -1e30, -1.0, -1e-40, -0.0, 0.0, 1e-40, 1.0, 1e30, f32::INFINITY];
    assert!(rising.windows(2).all(|pair| key_of(pair[0]) < key_of(pair[1])));
}

#[test]
fn equal_numbers_share_their_ranks() {
    let words = [2.0_f32, 1.0, 2.0, 2.0, 1.0].map(f32::to_bits);
    for (rank, wanted) in [(0, 1.0_f32), (1, 1.0), (2, 2.0), (4, 2.0)] {
        let shader = pass::request("crates/gpu-algorithms/tests/main/select.wgsl", &[]);
        let outputs = Bench::default()
            .input("count", &[5, rank])
            .input("numbers", &words)
            .output("found", 2)
            .steps(
                [select::scratch(&cx(), "scratch").unwrap()],
                select::steps(&cx(), &shader, 5, "scratch").unwrap(),
            )
            .run();
        let Some(outputs) = outputs else { return };
        assert_eq!(outputs.read::<u32>("found")[1], wanted.to_bits(), "rank {rank}");
    }
}
