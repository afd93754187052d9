//! Sorts.

use crate::bench::Bench;
use crate::{LENGTHS, MANY, cx, numbers};
use gpu_algorithms::{RadixSort, reference};

/// The input of a sort.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Form {
    Pairs,
    Indices,
    Counted,
}

/// Sorts pairs of key and value.
fn sort(pairs: &[(u32, u32)], bits: u32, form: Form) -> Option<Vec<(u32, u32)>> {
    let (keys, values): (Vec<u32>, Vec<u32>) = pairs.iter().copied().unzip();
    let length = pairs.len() as u32;
    let counted = form == Form::Counted;
    let bound = if counted { length + 3000 } else { length };
    let sort = RadixSort {
        length: bound,
        count: counted.then_some("count"),
        bits,
        keys: "keys",
        values: (form != Form::Indices).then_some("values"),
        sorted_keys: "sorted_keys",
        sorted_values: "sorted_values",
        scratch: "sort",
    };
    let outputs = Bench::default()
        .input("count", &[length])
        .input("keys", &keys)
        .input("values", &values)
        .output("sorted_keys", bound as usize)
        .output("sorted_values", bound as usize)
        .steps(sort.scratch(&cx()).unwrap(), sort.steps(&cx()).unwrap())
        .run()?;
    let [keys, values] = ["sorted_keys", "sorted_values"].map(|name| outputs.read::<u32>(name));
    Some(std::iter::zip(keys, values).take(pairs.len()).collect())
}

fn pairs(length: u32, bound: u64) -> Vec<(u32, u32)> {
    std::iter::zip(numbers(length, bound), 0..).collect()
}

#[test]
fn pairs_are_sorted_and_equal_keys_keep_their_order() {
    for length in LENGTHS.into_iter().chain([MANY]) {
        // All of 32 bits; many that are equal.
        for (bits, bound) in [(32, 1 << 32), (7, 100)] {
            let pairs = pairs(length, bound);
            let Some(sorted) = sort(&pairs, bits, Form::Pairs) else { return };
            assert!(sorted == reference::sort(&pairs), "{length} keys below {bound}");
        }
    }
}

#[test]
fn values_may_be_indices() {
    for length in [0, 1, 2049, 5000] {
        // The values are the indices already.
        let pairs = pairs(length, 1 << 20);
        let Some(sorted) = sort(&pairs, 20, Form::Indices) else { return };
        assert!(sorted == reference::sort(&pairs), "{length} keys");
    }
}

#[test]
fn the_number_of_elements_may_be_read_from_a_buffer() {
    for length in [0, 1, 2048, 2049, 40_000] {
        let pairs = pairs(length, 1 << 32);
        let Some(sorted) = sort(&pairs, 32, Form::Counted) else { return };
        assert!(sorted == reference::sort(&pairs), "{length} keys");
    }
}

#[test]
fn extreme_keys_are_sorted() {
    for keys in [vec![u32::MAX; 3000], vec![0; 3000], (0..3000).rev().collect::<Vec<u32>>()] {
        let pairs: Vec<(u32, u32)> = std::iter::zip(keys, 7..).collect();
        let Some(sorted) = sort(&pairs, 32, Form::Pairs) else { return };
        assert!(sorted == reference::sort(&pairs), "keys like {}", pairs[0].0);
    }
}
