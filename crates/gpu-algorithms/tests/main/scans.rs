//! Scans, compactions and scans of segments.

use crate::bench::Bench;
use crate::{LENGTHS, MANY, cx, numbers};
use gpu_algorithms::{reference, scan, segmented_scan};
use pass::Value;

/// Scans the first `length` of at most `bound` numbers.
fn scan_of(numbers: &[u32], bound: u32) -> Option<(Vec<(u32, u32)>, u32)> {
    let length = numbers.len();
    let shader = pass::request("crates/gpu-algorithms/tests/main/scan.wgsl", &[]);
    let outputs = Bench::default()
        .input("count", &[length as u32])
        .input("numbers", numbers)
        .output("sums", 2 * length)
        .output("total", 1)
        .steps(
            scan::scratch(&cx(), "scratch", bound).unwrap(),
            scan::steps(&cx(), &shader, bound, "scratch").unwrap(),
        )
        .run()?;
    let sums: Vec<u32> = outputs.read("sums");
    let sums = sums.chunks_exact(2).take(length).map(|pair| (pair[0], pair[1])).collect();
    Some((sums, outputs.read("total")[0]))
}

#[test]
fn prefix_sums_are_exact() {
    // Sums that wrap are sums modulo 2³².
    for length in LENGTHS.into_iter().chain([MANY]) {
        let numbers = numbers(length, 1 << 32);
        let Some((sums, total)) = scan_of(&numbers, length) else { return };
        assert!(sums == reference::scan(&numbers), "the sums of {length} numbers");
        assert_eq!(total, sums.last().map_or(0, |last| last.1), "{length} numbers");
    }
}

#[test]
fn fewer_elements_than_the_bound_are_summed_alone() {
    for length in [0, 1, 2047, 2048, 2049, 6000] {
        let numbers = numbers(length, 100);
        let Some((sums, total)) = scan_of(&numbers, 600_000) else { return };
        assert!(sums == reference::scan(&numbers), "the sums of {length} numbers");
        assert_eq!(total, numbers.iter().sum::<u32>(), "{length} numbers");
    }
}

#[test]
fn compactions_keep_the_order_and_leave_no_gaps() {
    for length in LENGTHS {
        for (what, numbers) in [
            ("some", numbers(length, 1000)),
            ("all", vec![1; length as usize]),
            ("none", vec![0; length as usize]),
        ] {
            let shader = pass::request("crates/gpu-algorithms/tests/main/compact.wgsl", &[]);
            let outputs = Bench::default()
                .input("count", &[length])
                .input("numbers", &numbers)
                .output("kept", length as usize)
                .output("total", 1)
                .steps(
                    scan::scratch(&cx(), "scratch", length).unwrap(),
                    scan::steps(&cx(), &shader, length, "scratch").unwrap(),
                )
                .run();
            let Some(outputs) = outputs else { return };
            let wanted = reference::compact(length, |i| numbers[i as usize] % 2 == 1);
            let kept: Vec<u32> = outputs.read("kept");
            assert_eq!(outputs.read::<u32>("total")[0] as usize, wanted.len(), "{what} of {length}");
            assert!(kept[..wanted.len()] == wanted, "{what} of {length}");
        }
    }
}

#[test]
fn segments_are_summed_each_by_itself() {
    for (length, rows, layers) in
        [(1, 1, 1), (3, 5, 2), (255, 3, 1), (256, 1, 2), (257, 2, 2), (4097, 2, 1), (70_000, 1, 1)]
    {
        let segments = (rows * layers) as usize;
        // From 1e-30 to 1e30, a third of them zero.
        let weight = |x: u32| if x.is_multiple_of(3) { 0.0 } else { 10.0_f32.powf(x as f32 / 50.0 - 30.0) };
        let weights: Vec<f32> = numbers(length * rows * layers, 3000).into_iter().map(weight).collect();
        let words: Vec<u32> = weights.iter().map(|weight| weight.to_bits()).collect();
        let shader = pass::request("crates/gpu-algorithms/tests/main/segments.wgsl", &[]);
        let step = segmented_scan(&shader, rows, layers)
            .value("length", Value::U32(length))
            .value("rows", Value::U32(rows));
        let outputs = Bench::default()
            .input("weights", &words)
            .output("sums", weights.len())
            .output("totals", 2 * segments)
            .steps([], [step])
            .run();
        let Some(outputs) = outputs else { return };
        let exact: Vec<f64> = weights.iter().map(|weight| f64::from(*weight)).collect();
        let (wanted, wanted_totals) = reference::segmented_scan(&exact, length as usize);
        let sums: Vec<f32> = outputs.read("sums");
        let totals: Vec<u32> = outputs.read("totals");
        for segment in 0..segments {
            let unit = 2.0_f64.powi(totals[2 * segment + 1] as i32);
            let total = f64::from(f32::from_bits(totals[2 * segment])) * unit;
            let within = 1e-5 * wanted_totals[segment];
            assert!((total - wanted_totals[segment]).abs() <= within, "total {segment} of {length}");
            let mut before = 0.0;
            for i in segment * length as usize..(segment + 1) * length as usize {
                assert!((f64::from(sums[i]) * unit - wanted[i]).abs() <= within, "sum {i} of {length}");
                assert!(sums[i] >= before, "sum {i} of {length} falls");
                assert!(weights[i] > 0.0 || sums[i] == before, "sum {i} of {length} moves at a zero");
                before = sums[i];
            }
        }
    }
}

/// Equal weights round to the same side wherever they are added to one sum; in parts, a million of them lose no more than a few
/// bits.
#[test]
fn a_long_segment_of_equal_weights_keeps_its_digits() {
    let length = 1 << 20;
    let weight = 0.7_f32;
    let shader = pass::request("crates/gpu-algorithms/tests/main/segments.wgsl", &[]);
    let step = segmented_scan(&shader, 1, 1).value("length", Value::U32(length)).value("rows", Value::U32(1));
    let outputs = Bench::default()
        .input("weights", &vec![weight.to_bits(); length as usize])
        .output("sums", length as usize)
        .output("totals", 2)
        .steps([], [step])
        .run();
    let Some(outputs) = outputs else { return };
    let totals: Vec<u32> = outputs.read("totals");
    let total = f64::from(f32::from_bits(totals[0])) * 2.0_f64.powi(totals[1] as i32);
    let error = total / (f64::from(length) * f64::from(weight)) - 1.0;
    // -4e-5 where blocks are added one by one.
    assert!(error.abs() < 1e-6, "{error:e}");
}
