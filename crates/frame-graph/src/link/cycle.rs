//! The order of data, and the errors where there is none.

use super::{Linker, Links, Wire};
use crate::codes;
use crate::description::{At, Link, Off};
use data_file::Diagnostic;
use petgraph::algo::{astar, tarjan_scc, toposort};
use petgraph::graph::{EdgeReference, NodeIndex};
use petgraph::visit::{EdgeFiltered, EdgeRef as _};
use std::cmp::Reverse;

/// A wire as an edge of [`Links`].
type Edge<'l> = EdgeReference<'l, Wire>;

/// Returns whether the reader waits for the producer in the same frame.
fn waits(edge: Edge<'_>) -> bool {
    !edge.weight().end.past
}

impl<'a> Linker<'a> {
    /// Returns the links between passes as things are, and an order in which each pass comes after those whose data of the
    /// same frame it reads. Reports loops; what is returned is then not to be used.
    ///
    /// There must be no loop with everything on either. What `off:` names may be linked to only while something is off.
    pub(super) fn order(&mut self) -> (Links, Vec<NodeIndex>) {
        let mut found = self.sorted(false);
        if found.is_some() && !self.live.is_empty() {
            found = self.sorted(true);
        }
        found.unwrap_or_default()
    }

    fn sorted(&mut self, live: bool) -> Option<(Links, Vec<NodeIndex>)> {
        let links = self.links(live);
        let order = toposort(&EdgeFiltered::from_fn(&links, waits), None);
        match order {
            Ok(order) => Some((links, order)),
            Err(_) => {
                self.report_loops(&links, live);
                None
            }
        }
    }

    /// Returns the wires as a graph: with `live`, as things are; for what is off, always those that it would read.
    fn links(&self, live: bool) -> Links {
        let mut links = Links::with_capacity(self.nodes.len(), self.nodes.len() * 2);
        let mut index = vec![NodeIndex::end(); self.nodes.len()];
        for node in (0..self.nodes.len()).filter(|node| self.uses[*node].is_some()) {
            index[node] = links.add_node(node as u32);
        }
        for node in 0..self.nodes.len() {
            let wires =
                if live && self.on[node] == Some(true) { self.wires_now(node) } else { &self.wires[node] };
            for wire in wires {
                links.add_edge(index[wire.end.node as usize], index[node], *wire);
            }
        }
        links
    }

    fn report_loops(&mut self, links: &Links, live: bool) {
        let now = EdgeFiltered::from_fn(links, waits);
        for component in tarjan_scc(&now) {
            // The wire that leads furthest back in the file is the one best made `prev`: a file is written in
            // the order in which data flows.
            let mut members = component.clone();
            members.sort_unstable();
            let inside = members
                .iter()
                .flat_map(|pass| links.edges(*pass))
                .filter(|edge| waits(*edge) && members.binary_search(&edge.target()).is_ok());
            let best = inside.max_by_key(|edge| {
                let (producer, reader) = (edge.source().index(), edge.target().index());
                (producer as i64 - reader as i64, Reverse(reader), edge.weight().link)
            });
            if let Some(best) = best {
                let error = self.loop_error(links, best, members.len(), live);
                self.errors.push(error);
            }
        }
    }

    /// Returns the error about the shortest loop through a wire.
    fn loop_error(&self, links: &Links, best: Edge<'_>, size: usize, live: bool) -> Diagnostic {
        let now = EdgeFiltered::from_fn(links, waits);
        let path = astar(&now, best.target(), |pass| pass == best.source(), |_| 1, |_| 0);
        let path = path.map_or_else(Vec::new, |(_, path)| path);
        // Petgraph lists the newest edge first: the last is that of the first input.
        let first =
            |ends: &[NodeIndex]| links.edges_connecting(ends[0], ends[1]).filter(|edge| waits(*edge)).last();
        let steps: Vec<Edge<'_>> = path.windows(2).filter_map(first).collect();
        let node = |pass: NodeIndex| &self.nodes[links[pass] as usize];
        let text = |edge: &Edge<'_>| {
            let used = |pass: NodeIndex| self.uses[links[pass] as usize].as_ref();
            let wire = edge.weight();
            let port = used(edge.source()).map_or("", |u| &*u.names.outputs[wire.end.port as usize].0);
            let input = used(edge.target()).map_or("", |u| &*u.names.inputs[wire.input as usize].0);
            (format!("{}.{port}", node(edge.source()).name), format!("{}.{input}", node(edge.target()).name))
        };
        let link = |edge: &Edge<'_>| -> &Link { self.link_of(links[edge.target()] as usize, edge.weight()) };
        let names: Vec<&str> = path.iter().map(|pass| &*node(*pass).name).collect();
        let message = match names.split_last() {
            Some((last, [])) => format!("`{last}` waits for itself"),
            Some((last, rest)) => format!("`{}` and `{last}` wait for each other", rest.join("`, `")),
            None => String::new(),
        };
        let mut error = Diagnostic::new(&codes::CYCLE, message)
            .label(self.span(link(&best).place), format!("suggested: \"prev {}\"", link(&best).target));
        let mut texts = Vec::new();
        for step in &steps {
            let (from, to) = text(step);
            error = error.label(self.span(link(step).place), format!("{to} waits for {from}"));
            texts.push(format!("{from} → {to}"));
        }
        let (from, to) = text(&best);
        texts.push(format!("{from} → {to}"));
        for edge in steps.iter().chain([&best]) {
            // A link to a pass that is off, whose `off:` leads to another.
            let target = self.resolved.index.get(&link(edge).target.pass).map(|i| &self.nodes[*i as usize]);
            if live
                && let Some(target) = target.filter(|target| target.name != node(edge.source()).name)
                && let Some(At { value: Off::Link(_), place }) = &target.decl.off
            {
                error =
                    error.label(self.span(*place), format!("in place of `{}`, which is off", target.name));
            }
        }
        error = error.note(format!("the loop: {}", texts.join("; ")));
        if size > path.len() {
            error = error.note(format!("{} more passes are in loops with these", size - path.len()));
        }
        error
    }
}
