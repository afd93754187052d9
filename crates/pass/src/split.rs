//! Splits dispatches whose threads would loop for too long.

use crate::Compute;

/// The most loop iterations that a thread executes in one dispatch. A driver treats a dispatch that runs for seconds as a
/// hang, and lavapipe silently ends all loops of a thread after 65,535 iterations.
const LOOP_ITERATIONS: u32 = 32_768;

/// Returns how many items, of this many loop iterations each, a thread takes in one dispatch.
pub const fn most_items(iterations: u32) -> u32 {
    let most = LOOP_ITERATIONS / if iterations == 0 { 1 } else { iterations };
    if most == 0 { 1 } else { most }
}

/// Returns the dispatches, at least one, into which one is split whose threads loop over `items`.
pub fn split_count(items: u32, iterations: u32) -> u32 {
    items.div_ceil(most_items(iterations)).max(1)
}

impl Compute {
    /// Splits a dispatch whose threads loop over `items`, of this many loop iterations each. Members of `settings` say
    /// which a dispatch takes: from `begin` to `end`, exclusive; `last` is 1 for the last dispatch, which takes all that
    /// remain.
    pub fn split(self, items: u32, iterations: u32) -> impl ExactSizeIterator<Item = Compute> {
        let (most, count) = (most_items(iterations), split_count(items, iterations));
        (0..count).map(move |part| {
            let (begin, last) = (part * most, part + 1 == count);
            let end = if last { u32::MAX } else { begin + most };
            self.clone().value("begin", begin).value("end", end).value("last", u32::from(last))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{LOOP_ITERATIONS, most_items, split_count};
    use crate::{Compute, Threads, Value, request};

    #[test]
    fn parts_take_each_item_once_and_no_more_than_a_thread_may() {
        for (items, iterations) in
            [(0, 1), (1, 0), (32_768, 1), (32_769, 1), (70_000, 5), (5, 100_000), (100_000, 265)]
        {
            let step = Compute::new(request("a.wgsl", &[]), "main", Threads::Row(1));
            let parts: Vec<_> = step.split(items, iterations).collect();
            assert_eq!(parts.len() as u32, split_count(items, iterations));
            let mut next = 0;
            for (i, part) in parts.iter().enumerate() {
                let value = |name: &str| match part.values.iter().find(|(known, _)| known == name) {
                    Some((_, Value::U32(value))) => *value,
                    other => panic!("{name}: {other:?}"),
                };
                let (begin, end, last) = (value("begin"), value("end"), value("last") == 1);
                assert_eq!((begin, last), (next, i + 1 == parts.len()));
                let taken = end.min(items).saturating_sub(begin);
                assert!(taken <= most_items(iterations), "{items} × {iterations}: {begin}..{end}");
                assert!(taken <= 1 || taken * iterations <= LOOP_ITERATIONS);
                next = end;
            }
            assert_eq!(next, u32::MAX, "the last takes all that remain");
        }
    }
}
