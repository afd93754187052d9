//! The order in which passes run.
//!
//! Every order must respect the flow of data. Finding the one that needs the least memory is hard, so three
//! are computed and the best is taken: that of the file, one that frees the most at each step, and one that
//! follows each output to its sources.

use super::Work;
use smallvec::SmallVec;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Returns the order with the lowest peak of transient memory; among equal ones, that of the file.
pub(super) fn order(work: &Work<'_>, file: Vec<u32>) -> Vec<u32> {
    let mut best = (peak(work, &file), file);
    // No order needs less memory than the pass that needs the most while it runs.
    if best.0 <= floor(work, &best.1) {
        return best.1;
    }
    for other in [by_bytes(work), by_depth(work)] {
        let peak = peak(work, &other);
        if peak < best.0 {
            best = (peak, other);
        }
    }
    best.1
}

/// For each pass, the number of links of this frame that it waits for, and the passes that wait for it, as
/// ranges of a list.
struct Waits {
    count: Vec<u32>,
    first: Vec<u32>,
    readers: Vec<u32>,
}

impl Waits {
    fn new(work: &Work<'_>) -> Waits {
        let passes = &work.graph.passes;
        let mut count = vec![0; passes.len()];
        let mut first = vec![0; passes.len() + 1];
        let each = |f: &mut dyn FnMut(usize, usize)| {
            for (i, pass) in passes.iter().enumerate().filter(|(i, _)| work.runs(*i)) {
                for input in pass.inputs.iter().filter(|i| i.past.is_none() && i.constant.is_none()) {
                    f(i, input.from.pass as usize);
                }
            }
        };
        each(&mut |reader, producer| {
            count[reader] += 1;
            first[producer + 1] += 1;
        });
        for i in 0..passes.len() {
            first[i + 1] += first[i];
        }
        let mut next = first.clone();
        let mut readers = vec![0; first[passes.len()] as usize];
        each(&mut |reader, producer| {
            readers[next[producer] as usize] = reader as u32;
            next[producer] += 1;
        });
        Waits { count, first, readers }
    }

    /// Marks a pass as done; calls `ready` with each pass that waited only for it.
    fn done(&mut self, pass: u32, mut ready: impl FnMut(u32)) {
        for at in self.first[pass as usize]..self.first[pass as usize + 1] {
            let reader = self.readers[at as usize];
            self.count[reader as usize] -= 1;
            if self.count[reader as usize] == 0 {
                ready(reader);
            }
        }
    }
}

fn roots(work: &Work<'_>, waits: &Waits) -> Vec<u32> {
    (0..work.graph.passes.len()).filter(|i| work.runs(*i) && waits.count[*i] == 0).map(|i| i as u32).collect()
}

/// Returns the order of the file, as far as the flow of data allows.
pub(super) fn by_file(work: &Work<'_>) -> Vec<u32> {
    let mut waits = Waits::new(work);
    let mut ready: BinaryHeap<Reverse<u32>> = roots(work, &waits).into_iter().map(Reverse).collect();
    let mut order = Vec::with_capacity(work.graph.passes.len());
    while let Some(Reverse(pass)) = ready.pop() {
        order.push(pass);
        waits.done(pass, |next| ready.push(Reverse(next)));
    }
    order
}

/// Returns the order that chooses, at each step, the pass after which the fewest bytes are alive.
fn by_bytes(work: &Work<'_>) -> Vec<u32> {
    let mut waits = Waits::new(work);
    let mut left: Vec<u32> = work.resources.iter().map(|r| r.readers).collect();
    // Bytes that are alive after the pass but were not before, for transient resources.
    let cost = |pass: u32, left: &[u32]| -> i64 {
        let made = work
            .numbers
            .made_by(pass as usize)
            .map(|r| &work.resources[r])
            .filter(|r| !r.persistent && r.readers > 0);
        let made: i64 = made.map(|r| r.bytes as i64).sum();
        let mut freed = 0;
        for input in &work.graph.passes[pass as usize].inputs {
            if input.past.is_none() && input.constant.is_none() {
                let last = work
                    .numbers
                    .of_source(&input.from)
                    .filter(|r| left[*r] == 1 && !work.resources[*r].persistent);
                freed += last.map(|r| work.resources[r].bytes as i64).sum::<i64>();
            }
        }
        made - freed
    };
    // A pass may be in the heap more than once: costs only decrease, and the lowest comes first.
    let mut heap: BinaryHeap<Reverse<(i64, u32)>> = BinaryHeap::new();
    let mut done = vec![false; work.graph.passes.len()];
    for root in roots(work, &waits) {
        heap.push(Reverse((cost(root, &left), root)));
    }
    let mut order = Vec::with_capacity(work.graph.passes.len());
    while let Some(Reverse((_, pass))) = heap.pop() {
        if std::mem::replace(&mut done[pass as usize], true) {
            continue;
        }
        order.push(pass);
        for input in &work.graph.passes[pass as usize].inputs {
            if input.past.is_some() || input.constant.is_some() {
                continue;
            }
            let mut cheaper = false;
            for r in work.numbers.of_source(&input.from) {
                left[r] -= 1;
                cheaper |= left[r] == 1 && !work.resources[r].persistent;
            }
            if cheaper {
                // The last remaining reader may be ready: it now frees the resource.
                let range = waits.first[input.from.pass as usize]..waits.first[input.from.pass as usize + 1];
                for at in range {
                    let reader = waits.readers[at as usize];
                    if !done[reader as usize] && waits.count[reader as usize] == 0 {
                        heap.push(Reverse((cost(reader, &left), reader)));
                    }
                }
            }
        }
        waits.done(pass, |next| heap.push(Reverse((cost(next, &left), next))));
    }
    order
}

/// Returns the order that follows each output to its sources, which come right before their readers.
fn by_depth(work: &Work<'_>) -> Vec<u32> {
    let passes = &work.graph.passes;
    let mut order = Vec::with_capacity(passes.len());
    let mut seen = vec![false; passes.len()];
    let mut stack: Vec<(u32, u32)> = Vec::new();
    let outputs = work.wanted.iter().map(|i| work.graph.outputs[*i as usize].from.pass);
    let roots = outputs.chain(0..passes.len() as u32).filter(|i| work.runs(*i as usize));
    for root in roots {
        if !std::mem::replace(&mut seen[root as usize], true) {
            stack.push((root, 0));
        }
        while let Some((pass, next)) = stack.last_mut() {
            match passes[*pass as usize].inputs.get(*next as usize) {
                Some(input) => {
                    *next += 1;
                    let producer = input.from.pass;
                    let waits = input.past.is_none() && input.constant.is_none();
                    if waits && !std::mem::replace(&mut seen[producer as usize], true) {
                        stack.push((producer, 0));
                    }
                }
                None => {
                    order.push(*pass);
                    stack.pop();
                }
            }
        }
    }
    order
}

/// Returns the most transient bytes that any single pass reads and writes.
fn floor(work: &Work<'_>, order: &[u32]) -> u64 {
    let transient = |r: usize| if work.resources[r].persistent { 0 } else { work.resources[r].bytes };
    let needs = |pass: &u32| {
        let inputs = &work.graph.passes[*pass as usize].inputs;
        let mut read: SmallVec<[usize; 8]> = inputs
            .iter()
            .filter(|i| i.past.is_none() && i.constant.is_none())
            .flat_map(|i| work.numbers.of_source(&i.from))
            .collect();
        read.sort_unstable();
        read.dedup();
        read.into_iter().chain(work.numbers.made_by(*pass as usize)).map(transient).sum::<u64>()
    };
    order.iter().map(needs).max().unwrap_or(0)
}

/// Returns the largest sum of transient bytes that are alive at once.
fn peak(work: &Work<'_>, order: &[u32]) -> u64 {
    let mut left: Vec<u32> = work.resources.iter().map(|r| r.readers).collect();
    let (mut alive, mut peak) = (0u64, 0u64);
    for pass in order {
        let transient = |r: &usize| !work.resources[*r].persistent;
        let made = work.numbers.made_by(*pass as usize);
        alive += made.clone().filter(transient).map(|r| work.resources[r].bytes).sum::<u64>();
        peak = peak.max(alive);
        alive -=
            made.filter(transient).filter(|r| left[*r] == 0).map(|r| work.resources[r].bytes).sum::<u64>();
        for input in &work.graph.passes[*pass as usize].inputs {
            if input.past.is_none() && input.constant.is_none() {
                for r in work.numbers.of_source(&input.from) {
                    left[r] -= 1;
                    if left[r] == 0 && transient(&r) {
                        alive -= work.resources[r].bytes;
                    }
                }
            }
        }
    }
    peak
}
