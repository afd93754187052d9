//! The shaders against the CPU reference, on a GPU.

use crate::cpu_reference::{Difference, Evaluation, compare, takes_part};
use crate::some::{DEFAULT, alive, clusters, header, number, order, random};
use evaluate_clusters::PASS;
use interfaces::clusters::{self, Cluster, ClustersHeader, state};
use pass_test::Harness;

/// Runs the pass.
fn run(
    evaluation: Evaluation,
    seed: u32,
    header: &ClustersHeader,
    some: &[Cluster],
) -> Option<(ClustersHeader, Vec<Cluster>)> {
    let mut bytes = clusters::to_bytes(header, some);
    // `to_bytes` says how many there are; a buffer without history does not.
    bytes[..4].copy_from_slice(&header.count.to_le_bytes());
    let difference = match evaluation.difference {
        Difference::Absolute => "absolute",
        Difference::Relative => "relative",
    };
    let members = vec![("", pass_test::buffer(bytes.len() as u64), bytes)];
    let outputs = Harness::new(PASS)
        .seed(seed)
        .set("window", evaluation.window)
        .set("subset", evaluation.subset)
        .set("merge", evaluation.merge as f32)
        .set("split", evaluation.split as f32)
        .set("difference", difference)
        .past("clusters", "Clusters", 1, members)
        .fact("count", some.len() as u32)
        .run()?;
    let bytes: Vec<u8> = outputs.read("evaluated");
    let (head, rest) = bytes.split_at(size_of::<ClustersHeader>());
    Some((bytemuck::pod_read_unaligned(head), bytemuck::pod_collect_to_vec(rest)))
}

/// Asserts that the pass does what the CPU reference does. No difference may be within rounding of a threshold.
fn assert_same(
    evaluation: Evaluation,
    seed: u32,
    iteration: u32,
    some: &[Cluster],
) -> Option<ClustersHeader> {
    let given = header(some.len() as u32, iteration);
    let (head, found) = run(evaluation, seed, &given, some)?;
    let near = |threshold: f64| {
        let deltas = compare(some, evaluation.window);
        let apart = std::iter::zip(some, deltas)
            .map(move |(cluster, delta)| (evaluation.difference_of(cluster, delta).abs() - threshold).abs());
        apart.fold(f64::INFINITY, f64::min)
    };
    let apart = near(evaluation.merge).min(near(evaluation.split));
    assert!(apart > 3e-6, "a cluster is within {apart} of a threshold: take others");
    let count = some.len() as u32;
    let pass_seed = pass::pass_seed(seed, "evaluate-clusters");
    let (expected_head, expected) =
        evaluation.evaluate(&given, some, order(pass_seed, iteration, count), random(pass_seed, iteration));
    assert_eq!(head, expected_head);
    for (i, (found, expected)) in found.iter().zip(&expected).enumerate() {
        let close = |a: f32, b: f32| (a - b).abs() <= 2e-5 * b.abs() + 1e-36;
        let measured = close(found.delta, expected.delta) && close(found.mean_delta, expected.mean_delta);
        assert!(measured, "cluster {i}: {found:?} for {expected:?}");
        // The sine and the cosine have few bits on some GPUs.
        let near = (0..2).all(|axis| (found.uv[axis] - expected.uv[axis]).abs() < 0.02);
        assert!(near, "cluster {i}: {:?} for {:?}", found.uv, expected.uv);
        let rounded = Cluster {
            delta: found.delta,
            mean_delta: found.mean_delta,
            uv: if found.state == state::PLACED { found.uv } else { expected.uv },
            ..*expected
        };
        // By bits, since an area may be NaN.
        let same = bytemuck::bytes_of(found) == bytemuck::bytes_of(&rounded);
        assert!(same, "cluster {i}: {found:?} for {rounded:?}");
    }
    Some(head)
}

#[test]
fn clusters_become_what_the_cpu_reference_makes_of_them() {
    let mut totals = [0, 0];
    for (count, window, subset, salt) in
        [(1, 128, 1, 1), (2, 128, 3, 2), (128, 128, 3, 3), (128, 0, 1, 4), (300, 64, 1, 5), (1000, 128, 2, 6)]
    {
        for difference in [Difference::Absolute, Difference::Relative] {
            for (seed, iteration) in [(0, 0), (3, 17)] {
                let evaluation = Evaluation { window, subset, difference, ..DEFAULT };
                let Some(head) = assert_same(evaluation, seed, iteration, &clusters(count, salt)) else {
                    return;
                };
                totals = [totals[0] + head.merged, totals[1] + head.split];
            }
        }
    }
    assert!(totals[1] > 100 && totals[0] > totals[1], "{totals:?}: there was little to test");
}

/// A cluster at the edge of the window counts, and one beyond it does not.
#[test]
fn the_edge_of_the_window_is_in_it() {
    let cluster = |i: u32| alive(0.2 + 0.6 * number(i, 3), 1.0, [(i * 16) as f32, (i % 3 * 16) as f32]);
    let some: Vec<Cluster> = (0..20).map(cluster).collect();
    for window in [15, 16, 17] {
        let evaluation = Evaluation { window, subset: 1, difference: Difference::Relative, ..DEFAULT };
        if assert_same(evaluation, 1, 5, &some).is_none() {
            return;
        }
    }
}

/// More than one workgroup of merges, and more splits than 16 bits of a packed count would hold if they were not counted
/// in parts.
#[test]
fn many_clusters_are_ranked() {
    let cluster = |i: u32| {
        let small = i.is_multiple_of(2);
        // Each pair is alone in its window, and differs from all others.
        let uv = [(i / 2 % 256) as f32 * 4.0, (i / 512) as f32 * 4.0];
        Cluster { texels: 4, ..alive(if small { 0.01 } else { 1.0 }, 0.5 + 0.5 * number(i / 2, 3), uv) }
    };
    let evaluation =
        Evaluation { window: 1, subset: 1, difference: Difference::Relative, merge: 0.4, split: 0.005 };
    for count in [2048, 8192] {
        let some: Vec<Cluster> = (0..count).map(cluster).collect();
        let Some(head) = assert_same(evaluation, 1, 5, &some) else { return };
        assert_eq!((head.merged, head.split), (count / 2, count / 2));
    }
}

/// The most clusters: the passes over neighbours are in two dispatches, and a third is looked at.
#[test]
fn the_most_clusters_are_evaluated() {
    // Most have no texels, as where a map has fewer than there are clusters.
    let cluster = |i: u32| {
        let texels = if i % 512 < 8 { 5 } else { 0 };
        Cluster { texels, ..alive(number(i, 1).powi(2), 1.0, [512.0 * number(i, 2), 512.0 * number(i, 3)]) }
    };
    let some: Vec<Cluster> = (0..65_536).map(cluster).collect();
    let head = header(65_536, 3);
    let evaluation = Evaluation { difference: Difference::Relative, ..DEFAULT };
    let Some((found, _)) = run(evaluation, 0, &head, &some) else { return };
    let alive: Vec<Cluster> = some.iter().filter(|cluster| takes_part(cluster)).copied().collect();
    let deltas = compare(&alive, 128);
    let by_index = |index: u32| {
        let place = (index % 512 < 8).then_some(index / 512 * 8 + index % 512)?;
        Some(evaluation.difference_of(&alive[place as usize], deltas[place as usize]))
    };
    let differences: Vec<f64> =
        (0..65_536_u32.div_ceil(3)).map(order(0, 3, 65_536)).filter_map(by_index).collect();
    let merged = differences.iter().filter(|difference| **difference < -0.4).count() as u32;
    let split = differences.iter().filter(|difference| **difference > 0.15).count() as u32;
    assert!(merged > 20 && split > 5, "{merged}, {split}: there was little to test");
    assert_eq!((found.merged, found.split), (merged, split.min(merged)));
}

#[test]
fn before_the_first_frame_there_is_nothing() {
    let nothing = ClustersHeader::default();
    for count in [1, 100] {
        let empty = vec![Cluster::default(); count];
        let Some((header, found)) = run(DEFAULT, 0, &nothing, &empty) else { return };
        assert_eq!((header, found), (nothing, empty));
    }
    // The history buffer itself, before anything has written it.
    let room = pass_test::buffer(clusters::to_bytes(&nothing, &[Cluster::default(); 9]).len() as u64);
    let first =
        Harness::new(PASS).past("clusters", "Clusters", 0, vec![("", room, Vec::new())]).fact("count", 9u32);
    let bytes: Vec<u8> = first.run().unwrap().read("evaluated");
    assert!(bytes.iter().all(|byte| *byte == 0));
}

#[test]
fn any_scale_and_strange_numbers() {
    let scaled = |area: f32, importance: f32| -> Vec<Cluster> {
        let some = clusters(200, 7).into_iter();
        some.map(|one| Cluster { area: one.area * area, importance: one.importance * importance, ..one })
            .collect()
    };
    let relative = Evaluation { difference: Difference::Relative, subset: 1, ..DEFAULT };
    for (area, importance) in [(1e30, 1.0), (1e-30, 1.0), (1.0, 1e37), (1.0, 1e-30), (1e30, 1e30)] {
        if assert_same(relative, 0, 1, &scaled(area, importance)).is_none() {
            return;
        }
    }
    let mut strange = clusters(200, 8);
    let wanted = strange.iter_mut().filter(|one| takes_part(one));
    for (one, value) in wanted.zip([f32::NAN, -f32::NAN, -1.0, f32::NEG_INFINITY, 0.0, -0.0]) {
        one.area = value;
    }
    for (one, value) in strange.iter_mut().rev().filter(|one| takes_part(one)).zip([f32::NAN, -1.0, 0.0]) {
        one.importance = value;
    }
    assert_same(relative, 0, 1, &strange);
    // No area at all, and one that is infinite.
    let flat: Vec<Cluster> = strange.iter().map(|one| Cluster { area: f32::NAN, ..*one }).collect();
    let head = assert_same(relative, 0, 1, &flat).unwrap();
    assert_eq!((head.merged, head.split), (0, 0));
    strange[3].area = f32::INFINITY;
    let (_, found) = run(relative, 0, &header(200, 1), &strange).unwrap();
    assert!(found.iter().all(|one| one.delta.is_finite() && one.mean_delta.is_finite()));
}

#[test]
fn thresholds_of_nothing_and_of_all() {
    let some = clusters(300, 9);
    for difference in [Difference::Absolute, Difference::Relative] {
        let at = |merge, split| Evaluation { merge, split, subset: 1, difference, ..DEFAULT };
        let Some((all, _)) = run(at(0.0, 0.0), 0, &header(300, 1), &some) else { return };
        assert!(all.merged > 100 && all.split > 20, "{all:?}");
        let (none, found) = run(at(1.0, 1.0), 0, &header(300, 1), &some).unwrap();
        assert_eq!(none.merged, 0);
        assert_eq!(none.split, 0, "nothing is split without a cluster that is free");
        assert!(std::iter::zip(&found, &some).all(|(a, b)| (a.uv, a.state) == (b.uv, b.state)));
    }
}
