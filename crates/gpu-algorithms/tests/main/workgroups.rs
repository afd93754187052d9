//! Sums of a workgroup.

use gpu_algorithms::reference::workgroup_prefix_sum;
use pass_test::random::{hash, unit_float};

/// Weights from 2^-100 to 2^27, a third of them zero.
fn weights(seed: u32) -> Vec<f32> {
    (0..256)
        .map(|i| {
            let bits = hash(seed * 256 + i);
            let magnitude = (bits % 128) as i32 - 100;
            if bits.is_multiple_of(3) {
                0.0
            } else {
                (1.0 + unit_float(hash(bits)) as f32) * 2.0_f32.powi(magnitude)
            }
        })
        .collect()
}

#[test]
fn sums_of_a_workgroup_are_monotone_and_stand_still_at_zeros() {
    for seed in 0..500 {
        let values = weights(seed);
        let mut sums = values.clone();
        workgroup_prefix_sum(&mut sums);
        let mut exact = 0.0;
        for i in 0..256 {
            let before = if i > 0 { sums[i - 1] } else { 0.0 };
            assert!(sums[i] >= before, "seed {seed}: sum {i} falls from {before} to {}", sums[i]);
            if values[i] == 0.0 {
                assert_eq!(sums[i], before, "seed {seed}: sum {i} moves at a zero");
            }
            exact += f64::from(values[i]);
            // Eight additions, each with a relative error of 2^-24.
            assert!(
                (f64::from(sums[i]) - exact).abs() <= 8.0 * exact / 16_777_216.0,
                "seed {seed}: sum {i} is off"
            );
        }
    }
}
