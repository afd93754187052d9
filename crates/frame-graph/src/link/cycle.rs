//! The order of data, and what is told where there is none.

use super::{Linker, Wire};
use crate::codes;
use crate::description::{At, Link, Off};
use crate::diagnostic::Diagnostic;
use crate::resolve::Node;
use petgraph::algo::tarjan_scc;
use petgraph::graph::DiGraph;
use std::collections::VecDeque;

impl<'a> Linker<'a> {
    /// All nodes, each after those whose data of the same frame it reads, whatever is on or off. Ties go by the
    /// order of the file. Where there is a loop, tells so; the order is then not to be used.
    ///
    /// A link of `off:` brings data that no link brings while the pass is on: where there is one, the order is
    /// that of the links as things are.
    pub(super) fn order(&mut self) -> Vec<u32> {
        let order = self.order_of(false);
        let links = |node: &Node| matches!(&node.decl.off, Some(At { value: Off::Link(_), .. }));
        match order {
            Some(order) if self.live.is_empty() || !self.nodes.iter().any(links) => order,
            Some(_) => self.order_of(true).unwrap_or_default(),
            None => Vec::new(),
        }
    }

    /// What a node reads: with `live`, as things are; of what is off, always what it would read.
    fn read_by(&self, node: usize, live: bool) -> &[Wire<'a>] {
        if live && self.on[node] == Some(true) { self.wires_now(node) } else { &self.wires[node] }
    }

    /// The order of data; `None` where there is a loop, which is reported.
    fn order_of(&mut self, live: bool) -> Option<Vec<u32>> {
        let count = self.nodes.len();
        let mut order = Vec::with_capacity(count);
        // 0: not seen, 1: on the way, 2: done. A loop is found when a pass on the way is met again.
        let mut state = vec![0u8; count];
        let mut stack: Vec<(u32, u32)> = Vec::new();
        let mut looped = false;
        for root in 0..count {
            if state[root] == 0 {
                state[root] = 1;
                stack.push((root as u32, 0));
            }
            while let Some((node, next)) = stack.last_mut() {
                let i = *node as usize;
                match self.read_by(i, live).get(*next as usize) {
                    Some(wire) => {
                        *next += 1;
                        let producer = wire.end.node;
                        if wire.end.past.is_some() {
                            continue;
                        }
                        match state[producer as usize] {
                            0 => {
                                state[producer as usize] = 1;
                                stack.push((producer, 0));
                            }
                            1 => looped = true,
                            _ => {}
                        }
                    }
                    None => {
                        state[i] = 2;
                        order.push(*node);
                        stack.pop();
                    }
                }
            }
        }
        if looped {
            self.tell_loops(live);
        }
        (!looped).then_some(order)
    }

    /// The wires that passes wait for: reader, producer, place of the wire.
    fn waits(&self, live: bool) -> Vec<(usize, usize, usize)> {
        let readers = (0..self.nodes.len()).map(|i| (i, self.read_by(i, live)));
        readers
            .flat_map(|(i, wires)| wires.iter().enumerate().map(move |(at, wire)| (i, at, wire)))
            .filter(|(_, _, wire)| wire.end.past.is_none())
            .map(|(i, at, wire)| (i, wire.end.node as usize, at))
            .collect()
    }

    fn tell_loops(&mut self, live: bool) {
        let mut graph = DiGraph::<(), ()>::new();
        let indices: Vec<_> = (0..self.nodes.len()).map(|_| graph.add_node(())).collect();
        let waits = self.waits(live);
        for (reader, producer, _) in &waits {
            graph.add_edge(indices[*producer], indices[*reader], ());
        }
        let mut component_of = vec![0; self.nodes.len()];
        let components = tarjan_scc(&graph);
        for (at, component) in components.iter().enumerate() {
            component.iter().for_each(|i| component_of[i.index()] = at);
        }
        let mut inside: Vec<Vec<(usize, usize, usize)>> = vec![Vec::new(); components.len()];
        for wait in waits.iter().filter(|(r, p, _)| component_of[*r] == component_of[*p]) {
            inside[component_of[wait.0]].push(*wait);
        }
        for (members, inside) in components.iter().zip(inside) {
            // The wire that leads furthest back in the file is the one best made `Prev`: a file is written in
            // the order in which data flows.
            let Some(best) = inside.iter().max_by_key(|(reader, producer, _)| {
                (*producer as i64 - *reader as i64, std::cmp::Reverse(*reader))
            }) else {
                continue;
            };
            let error = self.tell_loop(*best, &inside, members.len(), live);
            self.errors.push(error);
        }
    }

    /// The shortest loop through a wire.
    fn tell_loop(
        &self,
        best: (usize, usize, usize),
        inside: &[(usize, usize, usize)],
        size: usize,
        live: bool,
    ) -> Diagnostic {
        let (reader, producer, _) = best;
        // From the reader forwards to the producer, by breadth: `via` is the wire by which a pass was reached.
        let mut via: Vec<Option<(usize, usize, usize)>> = vec![None; self.nodes.len()];
        let mut queue = VecDeque::from([reader]);
        while let Some(at) = queue.pop_front() {
            if at == producer {
                break;
            }
            for wait in inside.iter().filter(|(r, p, _)| *p == at && *r != reader) {
                if via[wait.0].is_none() {
                    via[wait.0] = Some(*wait);
                    queue.push_back(wait.0);
                }
            }
        }
        let mut path = Vec::new();
        let mut at = producer;
        while at != reader
            && let Some(wait) = via[at]
        {
            path.push(wait);
            at = wait.1;
        }
        path.reverse();
        let text = |(reader, producer, at): &(usize, usize, usize)| {
            let wire = &self.read_by(*reader, live)[*at];
            let port =
                self.uses[*producer].as_ref().map_or("", |u| &*u.names.outputs[wire.end.port as usize].0);
            let input = self.uses[*reader].as_ref().map_or("", |u| &*u.names.inputs[wire.input as usize].0);
            (
                format!("{}.{port}", self.nodes[*producer].name),
                format!("{}.{input}", self.nodes[*reader].name),
            )
        };
        let link = |(reader, _, at): &(usize, usize, usize)| -> &Link {
            self.link_of(*reader, &self.read_by(*reader, live)[*at])
        };
        let (from, to) = text(&best);
        let mut names = vec![&*self.nodes[reader].name];
        names.extend(path.iter().map(|(r, _, _)| &*self.nodes[*r].name));
        let message = match names.split_last() {
            Some((last, [])) => format!("`{last}` waits for itself"),
            Some((last, rest)) => format!("`{}` and `{last}` wait for each other", rest.join("`, `")),
            None => String::new(),
        };
        let mut error = Diagnostic::new(&codes::CYCLE, message).label(
            self.span(link(&best).place),
            format!("suggested: Prev(port: \"{}\")", link(&best).target),
        );
        let mut steps = Vec::new();
        for wait in &path {
            let (from, to) = text(wait);
            error = error.label(self.span(link(wait).place), format!("{to} waits for {from}"));
            steps.push(format!("{from} → {to}"));
        }
        steps.push(format!("{from} → {to}"));
        for wait in path.iter().chain([&best]) {
            // A link to a pass that is off, whose `off:` leads to another.
            let target = self.resolved.index.get(&link(wait).target.pass).map(|i| &self.nodes[*i as usize]);
            if live
                && let Some(target) = target.filter(|node| node.name != self.nodes[wait.1].name)
                && let Some(At { value: Off::Link(_), place }) = &target.decl.off
            {
                error =
                    error.label(self.span(*place), format!("in place of `{}`, which is off", target.name));
            }
        }
        error = error.note(format!("the loop: {}", steps.join("; ")));
        if size > path.len() + 1 {
            error = error.note(format!("{} more passes are in loops with these", size - path.len() - 1));
        }
        error
    }
}
