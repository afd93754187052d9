use pass_test::random::{hash, unit_float};
use sample_inverse_transform::twin::{Choice, choose, cumulate, prefix_sum, weight_of};

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
        prefix_sum(&mut sums);
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

#[test]
fn runs_are_summed_each_by_itself() {
    let (sums, totals) = cumulate(&[1.0, 2.0, 3.0, 10.0, 20.0, 30.0], 3);
    assert_eq!(sums, [1.0, 3.0, 6.0, 10.0, 30.0, 60.0]);
    assert_eq!(totals, [6.0, 60.0]);
}

#[test]
fn choice_is_strict_and_never_of_a_zero() {
    // Weights 0, 1, 0, 3, 0.
    let sums = [0.0, 1.0, 1.0, 4.0, 4.0];
    assert_eq!(choose(&sums, 0.0), Choice { index: 1, probability: 0.25, rest: 0.0 });
    assert_eq!(choose(&sums, 0.125), Choice { index: 1, probability: 0.25, rest: 0.5 });
    assert_eq!(choose(&sums, 0.25), Choice { index: 3, probability: 0.75, rest: 0.0 });
    assert_eq!(choose(&sums, 0.625), Choice { index: 3, probability: 0.75, rest: 0.5 });
    // A number that rounds to 1 still finds the last weight, not the zero behind it.
    assert_eq!(choose(&sums, 1.0).index, 3);
}

#[test]
fn rare_choices_do_not_weigh_more_than_numbers_resolve() {
    let choice = choose(&[1e-30, 1.0], 0.0);
    assert_eq!((choice.index, choice.probability), (0, 1.0 / 16_777_216.0));
}

#[test]
fn weights_are_finite_and_not_negative() {
    for (x, expected) in [
        (f32::NAN, 0.0),
        (-f32::NAN, 0.0),
        (-1.0, 0.0),
        (-0.0, 0.0),
        (f32::NEG_INFINITY, 0.0),
        (f32::INFINITY, f64::from(f32::MAX)),
        (1e-30, f64::from(1e-30_f32)),
        (2.5, 2.5),
    ] {
        assert_eq!(weight_of(x), expected, "{x}");
    }
}
