//! A shader of a user's, run.

use frame_graph::Extent;
use frame_graph::port::OutputOverride;
use pass_test::Harness;

#[test]
fn a_buffer_is_made_from_a_buffer() {
    let numbers: Vec<u8> = (0..100u16).flat_map(|i| f32::from(i).to_le_bytes()).collect();
    for (word, divisor) in [("yes", 4.0), ("no", 1.0), ("twice", 16.0)] {
        let outputs = Harness::new(compute::PASS)
            .shader("passes/compute/tests/halve.wgsl")
            .set("divisor", 4.0f32)
            .set("done", word)
            .input("numbers", "Buffer", &[], vec![("", pass_test::buffer(400), numbers.clone())])
            .run();
        let Some(outputs) = outputs else { return };
        let halves: Vec<f32> = outputs.read("halves");
        for (i, half) in halves.iter().enumerate() {
            // Poison was there before the pass; whatever it does not write is zero.
            assert_eq!(*half, if i < 99 { i as f32 / divisor } else { 0.0 }, "number {i}, {word}");
        }
    }
}

#[test]
fn entry_points_go_on_from_what_those_before_left() {
    // 700 numbers: ten whole groups and a part of one.
    let numbers: Vec<u8> = (0..700u16).flat_map(|i| f32::from(i % 8).to_le_bytes()).collect();
    let half = OutputOverride { size: Some(Extent::Frame { num: 1, den: 2 }), ..OutputOverride::default() };
    for (rounds, squared) in [(0u32, false), (3, false), (5, true)] {
        let outputs = Harness::new(compute::PASS)
            .shader("passes/compute/tests/chain.wgsl")
            .frame(20, 14)
            .out("mean", half.clone())
            .set("rounds", rounds)
            .set("squared", squared)
            .input(
                "numbers",
                "Buffer",
                &[("count", 700)],
                vec![("", pass_test::buffer(2800), numbers.clone())],
            )
            .run();
        let Some(outputs) = outputs else { return };
        let sum = (0..700).map(|i| f64::from(i % 8)).sum::<f64>()
            + f64::from(rounds * rounds.saturating_sub(1) / 2);
        let mean = sum / 700.0;
        let expected = if squared { mean * mean } else { mean };
        let picture: Vec<[f32; 4]> = outputs.read("picture");
        assert_eq!(picture.len(), 20 * 14);
        for (i, texel) in picture.iter().enumerate() {
            assert_eq!(texel[1..3], [(i % 20) as f32, (i / 20) as f32]);
            // The mean goes through 16 bits: 11 of mantissa, twice where it is squared.
            let error = f64::from(texel[0]) - expected;
            assert!(error.abs() < expected * 1e-3, "{rounds} rounds, texel {i}: {} for {expected}", texel[0]);
        }
    }
}
