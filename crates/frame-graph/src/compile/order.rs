//! The order in which passes run.
//!
//! Every order must respect the flow of data. Finding the one that needs the least memory is hard, so three
//! are computed and the best is taken: that of the file, one that frees the most at each step, and one that
//! follows each output to its sources.

use super::Work;
use crate::link::{GraphLink, GraphPass};
use petgraph::graph::{DiGraph, EdgeReference, NodeIndex};
use petgraph::visit::{
    DfsPostOrder, EdgeFiltered, EdgeRef as _, IntoEdgeReferences as _, IntoNeighbors as _, Reversed,
};
use smallvec::SmallVec;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Returns the order with the lowest peak of transient memory; among equal ones, that of the file.
pub(super) fn order(work: &Work<'_>, file: Vec<NodeIndex>) -> Vec<NodeIndex> {
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

/// Returns the links of this frame between passes that run.
fn links<'g>(
    work: &'g Work<'_>,
) -> EdgeFiltered<&'g DiGraph<GraphPass, GraphLink>, impl Fn(EdgeReference<'g, GraphLink>) -> bool> {
    EdgeFiltered::from_fn(&work.graph.passes, |link| link.weight().waits() && work.runs(link.target()))
}

/// The state of Kahn's algorithm. `toposort` and `Topo` of petgraph break ties by the order of their search; here, a heap
/// chooses among the passes that are ready.
struct Waits<'w, 'g> {
    work: &'w Work<'g>,
    /// For each pass, the number of links that it still waits for.
    left: Vec<u32>,
}

impl<'w, 'g> Waits<'w, 'g> {
    /// Returns the state before the first pass, and the passes that wait for nothing.
    fn new(work: &'w Work<'g>) -> (Waits<'w, 'g>, impl Iterator<Item = NodeIndex> + use<'w, 'g>) {
        let mut left = vec![0; work.graph.passes.node_count()];
        for link in links(work).edge_references() {
            left[link.target().index()] += 1;
        }
        let roots: Vec<NodeIndex> = work.running().filter(|pass| left[pass.index()] == 0).collect();
        (Waits { work, left }, roots.into_iter())
    }

    /// Marks a pass as done; calls `ready` with each pass that waited only for it.
    fn done(&mut self, pass: NodeIndex, mut ready: impl FnMut(NodeIndex)) {
        for reader in links(self.work).neighbors(pass) {
            let left = &mut self.left[reader.index()];
            *left -= 1;
            if *left == 0 {
                ready(reader);
            }
        }
    }
}

/// Returns the order of the file, as far as the flow of data allows.
pub(super) fn by_file(work: &Work<'_>) -> Vec<NodeIndex> {
    let (mut waits, roots) = Waits::new(work);
    let mut ready: BinaryHeap<Reverse<NodeIndex>> = roots.map(Reverse).collect();
    let mut order = Vec::with_capacity(waits.left.len());
    while let Some(Reverse(pass)) = ready.pop() {
        order.push(pass);
        waits.done(pass, |next| ready.push(Reverse(next)));
    }
    order
}

/// Returns the order that chooses, at each step, the pass after which the fewest bytes are alive.
fn by_bytes(work: &Work<'_>) -> Vec<NodeIndex> {
    let (mut waits, roots) = Waits::new(work);
    let mut left: Vec<u32> = work.resources.iter().map(|r| r.readers).collect();
    // Bytes that are alive after the pass but were not before, for transient resources.
    let cost = |pass: NodeIndex, left: &[u32]| -> i64 {
        let made = work.numbers.made_by(pass).map(|r| &work.resources[r]);
        let made = made.filter(|r| !r.persistent && r.readers > 0).map(|r| r.bytes as i64);
        let last = work.reads(pass).filter(|r| left[*r] == 1 && !work.resources[*r].persistent);
        made.sum::<i64>() - last.map(|r| work.resources[r].bytes as i64).sum::<i64>()
    };
    // A pass may be in the heap more than once: costs only decrease, and the lowest comes first.
    let mut heap: BinaryHeap<Reverse<(i64, NodeIndex)>> = BinaryHeap::new();
    let mut done = vec![false; waits.left.len()];
    heap.extend(roots.map(|root| Reverse((cost(root, &left), root))));
    let mut order = Vec::with_capacity(waits.left.len());
    while let Some(Reverse((_, pass))) = heap.pop() {
        if std::mem::replace(&mut done[pass.index()], true) {
            continue;
        }
        order.push(pass);
        for link in work.graph.inputs(pass).filter(|link| link.waits()) {
            let mut cheaper = false;
            for r in work.numbers.of_source(&link.from) {
                left[r] -= 1;
                cheaper |= left[r] == 1 && !work.resources[r].persistent;
            }
            if cheaper {
                // The last remaining reader may be ready: it now frees the resource.
                let readers = links(work);
                let readers = readers.neighbors(link.from.pass);
                for reader in readers.filter(|r| !done[r.index()] && waits.left[r.index()] == 0) {
                    heap.push(Reverse((cost(reader, &left), reader)));
                }
            }
        }
        waits.done(pass, |next| heap.push(Reverse((cost(next, &left), next))));
    }
    order
}

/// Returns the order that follows each output to its sources, which come right before their readers.
fn by_depth(work: &Work<'_>) -> Vec<NodeIndex> {
    let links = links(work);
    let producers = Reversed(&links);
    let mut order = Vec::with_capacity(work.graph.passes.node_count());
    let mut search = DfsPostOrder::empty(producers);
    let outputs = work.wanted.iter().map(|i| work.graph.outputs[*i as usize].from.pass);
    for root in outputs.filter(|pass| work.runs(*pass)).chain(work.running()) {
        search.move_to(root);
        while let Some(pass) = search.next(producers) {
            order.push(pass);
        }
    }
    order
}

/// Returns the most transient bytes that any single pass reads and writes.
fn floor(work: &Work<'_>, order: &[NodeIndex]) -> u64 {
    let transient = |r: usize| if work.resources[r].persistent { 0 } else { work.resources[r].bytes };
    let needs = |pass: &NodeIndex| {
        let mut read: SmallVec<[usize; 8]> = work.reads(*pass).collect();
        read.sort_unstable();
        read.dedup();
        read.into_iter().chain(work.numbers.made_by(*pass)).map(transient).sum::<u64>()
    };
    order.iter().map(needs).max().unwrap_or(0)
}

/// Returns the largest sum of transient bytes that are alive at once.
fn peak(work: &Work<'_>, order: &[NodeIndex]) -> u64 {
    let mut left: Vec<u32> = work.resources.iter().map(|r| r.readers).collect();
    let (mut alive, mut peak) = (0u64, 0u64);
    for pass in order {
        let transient = |r: &usize| !work.resources[*r].persistent;
        let made = work.numbers.made_by(*pass);
        alive += made.clone().filter(transient).map(|r| work.resources[r].bytes).sum::<u64>();
        peak = peak.max(alive);
        alive -=
            made.filter(transient).filter(|r| left[*r] == 0).map(|r| work.resources[r].bytes).sum::<u64>();
        for r in work.reads(*pass) {
            left[r] -= 1;
            if left[r] == 0 && transient(&r) {
                alive -= work.resources[r].bytes;
            }
        }
    }
    peak
}
