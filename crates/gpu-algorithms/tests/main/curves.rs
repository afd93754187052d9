//! Hilbert's curve.

use crate::bench::Bench;
use pass::{Compute, Threads};

/// Every cell is in one place, and each place is beside the one before: which no other order has by chance.
#[test]
fn neighbouring_places_are_neighbouring_cells() {
    let shader = pass::request("crates/gpu-algorithms/tests/main/hilbert.wgsl", &[]);
    let find = Compute::new(shader, "find", Threads::Row(4096));
    let Some(outputs) = Bench::default().output("places", 4096).steps([], [find]).run() else { return };
    let places: Vec<u32> = outputs.read("places");
    let mut order: Vec<usize> = (0..4096).collect();
    order.sort_by_key(|cell| places[*cell]);
    assert!((0..4096).all(|i| places[order[i]] == i as u32), "the curve fills the corner first");
    let cell = |i: usize| [i & 15, (i >> 4) & 15, i >> 8];
    for pair in order.windows(2) {
        let (from, to) = (cell(pair[0]), cell(pair[1]));
        let way: usize = std::iter::zip(from, to).map(|(a, b)| a.abs_diff(b)).sum();
        assert_eq!(way, 1, "from {from:?} to {to:?}");
    }
}
