//! δ, its mean, and what follows from them: Eq. 4.6 to 4.8.

use crate::cpu_reference::{Delta, Difference, Evaluation, compare, measure};
use crate::some::{DEFAULT, alive, clusters};
use interfaces::clusters::{Cluster, state};

#[test]
fn delta_is_the_share_of_the_greatest_area_times_the_importance() {
    let mut some = vec![
        alive(2.0, 0.5, [0.0; 2]),
        alive(8.0, 0.25, [0.0; 2]),
        alive(1.0, 1.0, [0.0; 2]),
        Cluster { state: state::TO_SEED, ..alive(100.0, 1.0, [0.0; 2]) },
        Cluster { texels: 0, ..alive(100.0, 1.0, [0.0; 2]) },
    ];
    assert_eq!(measure(&some), [0.125, 0.25, 0.125, 0.0, 0.0]);
    // NaN, and what is negative, have no area and no importance.
    (some[0].area, some[2].importance) = (f32::NAN, -1.0);
    assert_eq!(measure(&some), [0.0, 0.25, 0.0, 0.0, 0.0]);
    some[1].area = 0.0;
    some[2].area = 0.0;
    assert_eq!(measure(&some), [0.0; 5]);
}

/// The definition by brute force, which counts each neighbour as often as its δ says.
#[test]
fn the_mean_is_over_neighbours_in_the_square_weighted_by_themselves() {
    for (count, window) in [(1, 128), (40, 128), (300, 64), (300, 0), (300, 1000)] {
        let some = clusters(count, 1);
        let deltas = measure(&some);
        for (i, found) in compare(&some, window).iter().enumerate() {
            let (mut above, mut below) = (0.0, 0.0);
            for (j, other) in some.iter().enumerate() {
                let [x, y] = [0, 1].map(|axis| f64::from(other.uv[axis]) - f64::from(some[i].uv[axis]));
                let inside = window == 0 || x.abs().max(y.abs()) <= f64::from(window);
                if inside && other.layer == some[i].layer {
                    above += deltas[j] * deltas[j];
                    below += deltas[j];
                }
            }
            let expected = if below > 0.0 { above / below } else { 0.0 };
            assert!(
                (found.mean - expected).abs() < 1e-12,
                "{count}, cluster {i}: {} for {expected}",
                found.mean
            );
            assert_eq!(found.own, deltas[i]);
        }
    }
}

/// Returns which clusters are merged and which are split.
fn ranks(evaluation: Evaluation, some: &[Cluster]) -> (Vec<u32>, Vec<u32>) {
    let all = Evaluation { subset: 1, ..evaluation };
    let ranks = all.rank(some, &compare(some, all.window), |place| place);
    (ranks.merged, ranks.split)
}

#[test]
fn too_small_is_merged_and_too_large_is_split() {
    // The mean of δ = 0.1, 1, 0.5, 0.9 is 0.828: it is that of the large ones.
    let some: Vec<Cluster> = [0.1, 1.0, 0.5, 0.9].map(|area| alive(area, 1.0, [9.0; 2])).to_vec();
    assert_eq!(ranks(DEFAULT, &some), (vec![0], vec![1]));
    assert_eq!(ranks(Evaluation { merge: 0.3, ..DEFAULT }, &some), (vec![0, 2], vec![1]));
    // Of half the importance, all differ by half; relative to the mean they differ as before.
    let dim: Vec<Cluster> = some.iter().map(|one| Cluster { importance: 0.5, ..*one }).collect();
    assert_eq!(ranks(DEFAULT, &dim), (vec![], vec![]));
    let relative = Evaluation { difference: Difference::Relative, ..DEFAULT };
    assert_eq!(ranks(relative, &some), (vec![0], vec![1]));
    assert_eq!(ranks(relative, &dim), (vec![0], vec![1]));
}

/// Why a relative difference is offered: with one outlier, all others are small, and nothing differs.
#[test]
fn one_large_cluster_keeps_all_others_from_merging() {
    let mut some: Vec<Cluster> = [0.1, 1.0, 0.5, 0.9].map(|area| alive(area, 1.0, [9.0; 2])).to_vec();
    some.push(alive(10.0, 1.0, [400.0; 2]));
    assert_eq!(ranks(DEFAULT, &some), (vec![], vec![]));
    let relative = Evaluation { difference: Difference::Relative, ..DEFAULT };
    assert_eq!(ranks(relative, &some), (vec![0], vec![1]));
}

#[test]
fn thresholds_of_nothing_and_of_all() {
    let some = clusters(300, 2);
    let deltas = compare(&some, DEFAULT.window);
    let at = |thresholds: f64, difference| {
        ranks(Evaluation { merge: thresholds, split: thresholds, difference, ..DEFAULT }, &some)
    };
    // At 0 every cluster is merged or split that is not alone, whichever difference.
    let count = |wanted: &dyn Fn(&Delta) -> bool| deltas.iter().filter(|delta| wanted(delta)).count();
    let smaller = count(&|delta| delta.own < delta.mean && delta.own > 0.0);
    let without_area = (0..300).filter(|i| deltas[*i].own == 0.0 && deltas[*i].mean > 0.0);
    let without_area = without_area.filter(|i| some[*i].texels > 0 && some[*i].state == state::ALIVE).count();
    for difference in [Difference::Absolute, Difference::Relative] {
        let (merged, split) = at(0.0, difference);
        assert_eq!(merged.len(), smaller + without_area);
        assert_eq!(split.len(), count(&|delta| delta.own > delta.mean));
        assert!(merged.len() > 100 && split.len() > 20, "{} and {}", merged.len(), split.len());
    }
    // At 1 nothing is merged: δ and its mean are in [0, 1]. Twice the mean is split if that is what the difference is to.
    assert_eq!(at(1.0, Difference::Absolute), (vec![], vec![]));
    let (merged, split) = at(1.0, Difference::Relative);
    assert_eq!((merged.len(), split.len()), (0, count(&|delta| delta.own > 2.0 * delta.mean)));
}

#[test]
fn alone_or_among_equals_nothing_moves() {
    for difference in [Difference::Absolute, Difference::Relative] {
        let evaluation = Evaluation { merge: 1e-6, split: 1e-6, difference, ..DEFAULT };
        let nothing = (vec![], vec![]);
        assert_eq!(ranks(evaluation, &[alive(3.0, 0.5, [4.0; 2])]), nothing);
        assert_eq!(ranks(evaluation, &vec![alive(3.0, 0.7, [4.0; 2]); 1000]), nothing);
        assert_eq!(ranks(evaluation, &[Cluster::default(); 10]), nothing);
        // Farther apart than the window, or in other layers, each is alone.
        let row = [0.0, 129.0, 258.0].map(|x| alive(1.0 + x, 1.0, [x, 0.0]));
        assert_eq!(ranks(evaluation, &row), nothing);
        let stacked = [0, 1, 2].map(|layer| Cluster { layer, ..alive(1.0 + layer as f32, 1.0, [5.0; 2]) });
        assert_eq!(ranks(evaluation, &stacked), nothing);
        assert_ne!(ranks(Evaluation { window: 0, ..evaluation }, &row), nothing);
    }
}
