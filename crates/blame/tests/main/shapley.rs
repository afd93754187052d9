//! Shapley values.

use blame::{Game, Subset};

/// Shares by their definition: the mean over all orders.
fn by_orders(players: usize, value: &dyn Fn(Subset) -> f64) -> Vec<f64> {
    fn orders(left: &[usize]) -> Vec<Vec<usize>> {
        if left.is_empty() {
            return vec![Vec::new()];
        }
        let with = |first: usize| {
            let rest: Vec<usize> = left.iter().copied().filter(|player| *player != first).collect();
            orders(&rest).into_iter().map(move |mut order| {
                order.insert(0, first);
                order
            })
        };
        left.iter().flat_map(|first| with(*first)).collect()
    }
    let all = orders(&(0..players).collect::<Vec<_>>());
    let mut shares = vec![0.0; players];
    for order in &all {
        let mut subset = 0;
        for player in order {
            let with = subset | 1 << player;
            shares[*player] += (value(subset) - value(with)) / all.len() as f64;
            subset = with;
        }
    }
    shares
}

fn close(a: &[f64], b: &[f64], within: f64) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= within)
}

/// A value for each subset without any structure.
fn noise(subset: Subset) -> f64 {
    let mixed = (subset ^ 0x85eb_ca6b).wrapping_mul(0x9e37_79b9);
    let mixed = (mixed ^ mixed >> 15).wrapping_mul(0x2c1b_3c6d);
    f64::from((mixed ^ mixed >> 13) >> 8) / f64::from(1 << 24)
}

#[test]
fn shares_are_the_mean_over_all_orders() {
    for players in 1..=6 {
        let shares = Game::new(players, 6, 0).shares(&noise);
        let expected = by_orders(players, &noise);
        assert!(close(&shares, &expected, 1e-12), "{players}: {shares:?} {expected:?}");
        let whole = noise(0) - noise((1 << players) - 1);
        assert!((shares.iter().sum::<f64>() - whole).abs() < 1e-12);
    }
}

#[test]
fn independent_errors_are_owed_to_those_who_make_them() {
    let own = [0.5, 0.25, 0.0, 2.0];
    let value = |subset: Subset| (0..4).filter(|i| subset & 1 << i == 0).map(|i| own[i]).sum();
    assert!(close(&Game::new(4, 6, 0).shares(&value), &own, 1e-12));
}

/// A filter and the pattern that it removes: error is there only where both are.
#[test]
fn what_takes_two_is_owed_by_halves() {
    let value = |subset: Subset| if subset & 0b11 == 0 { 1.0 } else { 0.0 };
    assert!(close(&Game::new(3, 6, 0).shares(&value), &[0.5, 0.5, 0.0], 1e-12));
}

#[test]
fn no_players_have_no_shares() {
    let game = Game::new(0, 6, 0);
    assert_eq!((game.subsets(), game.shares(&noise)), (vec![0], vec![]));
}

#[test]
fn of_many_players_orders_are_drawn_and_intervals_hold_the_truth() {
    let exact = by_orders(7, &noise);
    let (mut outside, mut of) = (0, 0);
    for seed in 0..40 {
        let game = Game::new(7, 6, seed);
        assert!(game.is_sampled());
        let (subsets, shares, halves) = (game.subsets(), game.shares(&noise), game.halves(&noise));
        assert!(subsets.len() < 128 && subsets.contains(&0) && subsets.contains(&127), "{subsets:?}");
        let whole = noise(0) - noise(127);
        assert!((shares.iter().sum::<f64>() - whole).abs() < 1e-12);
        let misses = shares
            .iter()
            .zip(&halves)
            .zip(&exact)
            .filter(|((share, half), exact)| (*share - *exact).abs() > **half);
        outside += misses.count();
        of += 7;
    }
    // 5 % of 280 are 14, with a deviation of 3.6.
    assert!(outside <= 28, "{outside} of {of}");
    assert_eq!(Game::new(6, 6, 0).halves(&noise), vec![0.0; 6]);
}
