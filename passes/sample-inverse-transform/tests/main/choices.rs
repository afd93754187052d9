use crate::cpu_reference::{Choice, choose, weight_of};

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
