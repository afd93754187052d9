use crate::chains::element;
use pass_test::random::{hash2, radical_inverse, shuffled};
use pass_test::statistics::assert_follows;

#[test]
fn shuffles_are_permutations() {
    for count in (1..40).chain([64, 127, 1000, 1023, 1024, 1025]) {
        for step in 1..6 {
            let mut seen = vec![0; count as usize];
            (0..count).for_each(|i| seen[shuffled(i, count, hash2(3, step)) as usize] += 1);
            assert!(seen.iter().all(|n| *n == 1), "{count}, step {step}: {seen:?}");
        }
    }
    assert_eq!(shuffled(0, 1, u32::MAX), 0);
    // The greatest count: the last index and those about the middle.
    for i in [0, 1, (1 << 20) - 1, 1 << 20, (1 << 21) - 1] {
        assert!(shuffled(i, 1 << 21, hash2(0, 1)) < 1 << 21);
    }
}

#[test]
fn chains_share_no_proposal_and_leave_none_out() {
    for (count, steps) in [(1, 7), (30, 5), (1024, 5), (100, 100)] {
        let mut seen = vec![0; (count * steps) as usize];
        for step in 0..steps {
            for chain in 0..count {
                let element = element(chain, step, count, 0);
                seen[element as usize - 1] += 1;
                assert_eq!((element - 1) / count, step, "a step is a run of the sequence");
            }
        }
        assert!(seen.iter().all(|n| *n == 1), "{count} chains, {steps} steps");
    }
}

/// Proposals to a chain at different steps are independent.
#[test]
fn steps_are_dealt_independently() {
    const COUNT: u32 = 1024;
    const CELLS: u32 = 4;
    for base in [2, 3, 5, 7] {
        for (a, b) in [(0, 1), (1, 2), (0, 4), (2, 3)] {
            let mut observed = vec![0; (CELLS * CELLS) as usize];
            for seed in 0..40 {
                for chain in 0..COUNT {
                    let cell = |step| {
                        let element = element(chain, step, COUNT, seed);
                        (radical_inverse(base, element) * f64::from(CELLS)) as u32
                    };
                    observed[(cell(a) * CELLS + cell(b)) as usize] += 1;
                }
            }
            let expected = f64::from(40 * COUNT) / f64::from(CELLS * CELLS);
            assert_follows(&observed, &vec![expected; observed.len()]);
        }
    }
}

/// Why the elements of a step are not dealt in order.
#[test]
fn in_order_a_chain_would_stay_in_its_layer() {
    let layer = |element: u32| (radical_inverse(2, element) * 64.0) as u32;
    for chain in [0, 1, 77, 1000] {
        let in_order = |step: u32| layer(chain + 1024 * step + 1);
        assert!((1..5).all(|step| in_order(step) == in_order(0)), "chain {chain}");
        let dealt = |step: u32| layer(element(chain, step, 1024, 0));
        assert!((1..5).any(|step| dealt(step) != dealt(0)), "chain {chain}");
    }
}
