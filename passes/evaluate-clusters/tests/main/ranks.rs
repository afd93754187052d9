//! The free list: which clusters take part in it, and that none is lost or there twice.

use crate::cpu_reference::{Difference, Evaluation, compare, takes_part};
use crate::some::{DEFAULT, clusters, header, number, order, random};
use interfaces::clusters::{Cluster, NO_TEXEL, state};
use std::collections::BTreeSet;

#[test]
fn a_third_is_looked_at_and_no_cluster_twice() {
    for count in [1, 2, 3, 64, 100, 1000] {
        for subset in [1, 3, 7, 2000] {
            let looked_at = (0..u32::div_ceil(count, subset)).map(order(5, 9, count));
            let distinct: BTreeSet<u32> = looked_at.collect();
            assert_eq!(distinct.len() as u32, count.div_ceil(subset), "{count}, {subset}");
        }
    }
    // Other frames look at others, so that each has its turn.
    let seen: BTreeSet<u32> =
        (0..40).flat_map(|iteration| (0..34).map(order(0, iteration, 100)).collect::<Vec<_>>()).collect();
    assert_eq!(seen.len(), 100);
}

/// Checks what holds in any frame, whatever its clusters are.
fn check(evaluation: Evaluation, before: &[Cluster], iteration: u32, found: &[Cluster], counts: [u32; 2]) {
    let count = before.len() as u32;
    let ranks = evaluation.rank(before, &compare(before, evaluation.window), order(0, iteration, count));
    let (merged, split) = (ranks.merged.len(), ranks.split.len().min(ranks.merged.len()));
    assert_eq!(counts, [merged as u32, split as u32]);
    assert_eq!(found.len(), before.len());
    let distinct: BTreeSet<u32> = ranks.merged.iter().chain(&ranks.split).copied().collect();
    assert_eq!(distinct.len(), merged + ranks.split.len(), "a cluster is in a list twice");
    assert!((merged + ranks.split.len()) as u32 <= count.div_ceil(evaluation.subset));
    let (mut placed, mut waiting) = (0, 0);
    for (i, (before, after)) in (0..).zip(std::iter::zip(before, found)) {
        if !ranks.merged.contains(&i) {
            let evaluated = Cluster { delta: after.delta, mean_delta: after.mean_delta, ..*before };
            assert_eq!(
                *after,
                if takes_part(before) { evaluated } else { *before },
                "cluster {i} is not free"
            );
            continue;
        }
        assert!(takes_part(before), "cluster {i} has nothing to be freed of");
        placed += usize::from(after.state == state::PLACED);
        waiting += usize::from(after.state == state::TO_SEED);
        let rest = Cluster {
            uv: [0.0; 2],
            layer: 0,
            state: 0,
            texel: NO_TEXEL,
            generation: before.generation,
            ..Cluster::default()
        };
        assert_eq!(Cluster { uv: [0.0; 2], layer: 0, state: 0, ..*after }, rest, "cluster {i} is not empty");
    }
    assert_eq!((placed, waiting), (split, merged - split));
}

/// A thousand frames in which texels, areas and importance are others each time, on the way from frame to frame.
#[test]
fn clusters_are_neither_lost_nor_doubled() {
    let mut some = clusters(90, 3);
    let mut totals = [0, 0];
    for frame in 0..1000 {
        let difference = [Difference::Absolute, Difference::Relative][frame as usize % 2];
        let evaluation = Evaluation {
            window: [0, 64, 128][frame as usize % 3],
            subset: 1 + frame % 4,
            merge: f64::from(0.5 * number(frame, 1)),
            split: f64::from(0.5 * number(frame, 2)),
            difference,
        };
        let before = some.clone();
        let (header, found) =
            evaluation.evaluate(&header(90, frame), &before, order(0, frame, 90), random(0, frame));
        check(evaluation, &before, frame, &found, [header.merged, header.split]);
        totals = [totals[0] + header.merged, totals[1] + header.split];
        // What the passes after this one do: seed what waits, place it, and map texels to all.
        some = (0..)
            .zip(found)
            .map(|(i, cluster)| {
                let seeded = u32::from(cluster.state == state::TO_SEED);
                let of = |what: u32| number(frame, 1000 + 10 * i + what);
                Cluster {
                    area: of(0).powi(2),
                    importance: of(1),
                    uv: [512.0 * of(2), 512.0 * of(3)],
                    layer: u32::from(of(4) < 0.5),
                    texels: (30.0 * of(5)) as u32,
                    state: if of(6) < 0.95 { state::ALIVE } else { state::TO_SEED },
                    generation: cluster.generation + seeded,
                    ..cluster
                }
            })
            .collect();
    }
    let [merged, split] = totals;
    assert!(split > 1000 && merged > split, "{merged} merges, {split} splits: there was little to test");
}

#[test]
fn splits_take_the_free_clusters_in_order() {
    let some = clusters(400, 4);
    let evaluation = Evaluation { subset: 1, difference: Difference::Relative, ..DEFAULT };
    let ranks = evaluation.rank(&some, &compare(&some, 128), order(3, 2, 400));
    assert!(ranks.merged.len() > 20 && ranks.split.len() > 20, "{ranks:?}");
    let (_, found) = evaluation.evaluate(&header(400, 2), &some, order(3, 2, 400), random(3, 2));
    for (free, taken) in std::iter::zip(&ranks.merged, &ranks.split) {
        let (placed, within) = (&found[*free as usize], &some[*taken as usize]);
        assert_eq!((placed.state, placed.layer), (state::PLACED, within.layer));
        let [x, y] = [0, 1].map(|axis| placed.uv[axis] - within.uv[axis]);
        let texels = x.hypot(y).powi(2) * std::f32::consts::PI;
        assert!(
            texels <= within.texels as f32 * 1.001,
            "a place {texels} texels from the centre of {within:?}"
        );
    }
    // The split cluster itself stays where it is.
    for taken in &ranks.split {
        assert_eq!(found[*taken as usize].uv, some[*taken as usize].uv);
    }
}

/// As many places near the centre as far from it, for their area, and in all directions.
#[test]
fn places_are_even_over_the_disc() {
    let one = Cluster { texels: 314, ..crate::some::alive(1.0, 1.0, [100.0, 50.0]) };
    let small = Cluster { area: 0.1, ..one };
    let mut some = vec![small; 6000];
    some.extend([one; 6000]);
    let evaluation = Evaluation { subset: 1, split: 0.05, ..DEFAULT };
    let (header, found) = evaluation.evaluate(&header(12_000, 0), &some, |place| place, random(0, 0));
    assert_eq!((header.merged, header.split), (6000, 6000));
    let mut cells = vec![0; 40];
    for placed in &found[..6000] {
        let (x, y) = (f64::from(placed.uv[0]) - 100.0, f64::from(placed.uv[1]) - 50.0);
        let ring = ((x * x + y * y) / 99.95 * 5.0) as usize;
        let sector = ((y.atan2(x) / std::f64::consts::TAU + 0.5) * 8.0) as usize;
        cells[8 * ring.min(4) + sector.min(7)] += 1;
    }
    pass_test::statistics::assert_follows(&cells, &[150.0; 40]);
}
