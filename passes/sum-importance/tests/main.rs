//! Sums against those in double precision, and in the very order of summation.

use gpu_algorithms::reference::{segmented_scan, workgroup_prefix_sum};
use pass_test::random::{hash, hash2, unit_float};
use pass_test::{Harness, Outputs, RsmTexel};
use sum_importance::PASS;

pass_test::shaders_are_valid!(PASS);

/// Sums a map of importance, layer after layer.
fn sum(map: &[f32], size: (u32, u32)) -> Option<Outputs> {
    let texel = RsmTexel { position: [0.0; 4], normal: [0.0; 3], flux: [1.0; 4] };
    Harness::new(PASS).rsm(size, &vec![texel; map.len()]).importance(size, map).run()
}

/// A weight within so many decades around 1, or 0.
fn weight(i: u32, decades: f64) -> f32 {
    if hash(i).is_multiple_of(3) {
        0.0
    } else {
        10.0_f64.powf(decades * (unit_float(hash2(i, 1)) - 0.5)) as f32
    }
}

/// Asserts that shares of the sums of each segment are those in double precision, that they never fall, and that they stay where
/// nothing is added.
fn assert_sums(what: &str, found: &[f32], weights: &[f64], length: usize) {
    let (expected, totals) = segmented_scan(weights, length);
    let segments =
        found.chunks_exact(length).zip(expected.chunks_exact(length)).zip(weights.chunks_exact(length));
    assert_eq!(found.len(), weights.len(), "{what}");
    for ((segment, total), s) in segments.zip(totals).zip(0..) {
        let ((sums, expected), weights) = segment;
        let last = f64::from(sums[length - 1]);
        assert_eq!(last == 0.0, total == 0.0, "{what}, segment {s}: a sum of {last} in place of {total}");
        let mut before = 0.0;
        for ((sum, expected), weight) in sums.iter().zip(expected).zip(weights) {
            assert!(
                *sum >= before && (*weight > 0.0 || *sum == before),
                "{what}, segment {s}: {before}, {sum}"
            );
            let error = if total > 0.0 { f64::from(*sum) / last - expected / total } else { 0.0 };
            assert!(
                error.abs() < 2e-6,
                "{what}, segment {s}: {sum} of {last} in place of {expected} of {total}"
            );
            before = *sum;
        }
    }
}

#[test]
fn sums_are_those_in_double_precision() {
    // Rows, columns and maps of more than one chunk of 256; the range of weights that f32 has.
    for (size, layers, decades) in
        [((12, 7), 6, 4.0), ((300, 5), 2, 4.0), ((5, 700), 3, 60.0), ((3, 2), 300, 8.0), ((1, 1), 1, 1.0)]
    {
        let map: Vec<f32> = (0..size.0 * size.1 * layers).map(|i| weight(i, decades)).collect();
        let Some(outputs) = sum(&map, size) else { return };
        let weights: Vec<f64> = map.iter().map(|weight| f64::from(*weight)).collect();
        let (width, height) = (size.0 as usize, size.1 as usize);
        assert_sums("rows", &outputs.read("sums.rows"), &weights, width);
        let (_, rows) = segmented_scan(&weights, width);
        let totals: Vec<f32> = outputs.read("sums.totals");
        let (of_rows, rest) = totals.split_at(rows.len());
        assert_sums("columns", of_rows, &rows, height);
        let (_, maps) = segmented_scan(&rows, height);
        // A buffer ends with padding.
        assert_sums("maps", &rest[..maps.len()], &maps, maps.len());
    }
}

#[test]
fn what_is_no_weight_counts_for_nothing() {
    let nothing = [f32::NAN, -1.0, f32::NEG_INFINITY, -0.0];
    let Some(outputs) = sum(&nothing, (2, 2)) else { return };
    for (member, count) in [("rows", 4), ("totals", 3)] {
        let sums: Vec<f32> = outputs.read(&format!("sums.{member}"));
        assert!(sums[..count].iter().all(|sum| *sum == 0.0), "{member}: {sums:?}");
    }
    let Some(outputs) = sum(&[1.0, f32::NAN, f32::INFINITY, 1.0], (2, 2)) else { return };
    let totals: Vec<f32> = outputs.read("sums.totals");
    assert!(totals[0] > 0.0 && totals[1].is_finite() && totals[0] / totals[1] < 1e-30, "{totals:?}");
}

#[test]
fn sums_of_a_row_are_those_of_the_order_of_summation() {
    // 600 entries: two whole chunks and a part. The greatest is in [1, 2), so nothing is scaled.
    let row: Vec<f32> = (0..600)
        .map(|i| {
            if hash(i).is_multiple_of(3) { 0.0 } else { 2.0_f64.powf(-30.0 * unit_float(hash2(i, 1))) as f32 }
        })
        .chain([1.5])
        .collect();
    let Some(outputs) = sum(&row, (601, 1)) else { return };
    let mut expected: Vec<f32> = Vec::new();
    let mut before = 0.0;
    for chunk in row.chunks(256) {
        let mut sums = [0.0; 256];
        sums[..chunk.len()].copy_from_slice(chunk);
        workgroup_prefix_sum(&mut sums);
        expected.extend(sums[..chunk.len()].iter().map(|sum| before + sum));
        before += sums[255];
    }
    assert_eq!(outputs.read::<f32>("sums.rows"), expected);
}
