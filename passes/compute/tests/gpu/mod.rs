//! A shader of a user's, run.

use pass_test::Stand;

#[test]
fn a_buffer_is_made_from_a_buffer() {
    let numbers: Vec<u8> = (0..100u16).flat_map(|i| f32::from(i).to_le_bytes()).collect();
    for (word, divisor) in [("yes", 4.0), ("no", 1.0), ("twice", 16.0)] {
        let outputs = Stand::new(compute::PASS)
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
