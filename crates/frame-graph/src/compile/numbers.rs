//! Numbers the resources of a graph, and finds the producers of those that passes hand on.

use crate::link::{Graph, GraphLink, LinkSource, Made};
use petgraph::graph::NodeIndex;
use std::ops::Range;

/// The numbering of resources: by pass, port and member.
pub(super) struct Numbers {
    /// First entry in `ports` of each pass, and the end.
    pub(super) first_port: Vec<u32>,
    /// First resource of each port, and the end.
    pub(super) ports: Vec<u32>,
    /// For each resource, itself, or the resource of another pass that it hands on.
    pub(super) made: Vec<u32>,
}

impl Numbers {
    /// Returns the numbers of all ports of a pass, including resources that it hands on.
    pub(super) fn of_pass(&self, pass: NodeIndex) -> Range<usize> {
        let ports = |i: usize| self.ports[self.first_port[i] as usize] as usize;
        ports(pass.index())..ports(pass.index() + 1)
    }

    /// Returns the resources that a pass writes.
    pub(super) fn made_by(&self, pass: NodeIndex) -> impl Iterator<Item = usize> + Clone + '_ {
        self.of_pass(pass).filter(|r| self.made[*r] as usize == *r)
    }

    /// Returns the number of a port.
    pub(super) fn port(&self, pass: NodeIndex, port: u32) -> usize {
        (self.first_port[pass.index()] + port) as usize
    }

    pub(super) fn of_port(&self, pass: NodeIndex, port: u32) -> Range<usize> {
        let at = self.port(pass, port);
        self.ports[at] as usize..self.ports[at + 1] as usize
    }

    /// Returns the numbers of the resources in a port that a link takes.
    pub(super) fn in_port(&self, source: &LinkSource) -> Range<usize> {
        let whole = self.of_port(source.pass, source.port);
        match source.member {
            Some(member) => whole.start + member as usize..whole.start + member as usize + 1,
            None => whole,
        }
    }

    /// Returns the resources that a link takes, as numbered in their producers.
    pub(super) fn of_source(&self, source: &LinkSource) -> impl Iterator<Item = usize> + '_ {
        self.in_port(source).map(|r| self.made[r] as usize)
    }

    /// Returns the input with this name, and the number of the resource that it has under the name of a
    /// member.
    pub(super) fn member_of<'g>(
        &self,
        graph: &'g Graph,
        pass: NodeIndex,
        input: &str,
        member: &str,
    ) -> Option<(&'g GraphLink, usize)> {
        let input = graph.inputs(pass).find(|link| link.port == *input)?;
        let (source, range) = (&input.from, self.in_port(&input.from));
        let port = &graph.passes[source.pass].outputs[source.port as usize];
        let first = self.of_port(source.pass, source.port).start;
        let named = range.clone().find(|r| port.members[r - first].0 == *member);
        // A single resource needs no name.
        Some((input, named.unwrap_or(range.start)))
    }

    /// Finds the producer of each resource that a pass hands on. A pass that is off hands on nothing: what
    /// replaces it counts as its own.
    pub(super) fn trace_handed(&mut self, graph: &Graph) {
        for pass in graph.passes.node_indices().filter(|pass| graph.passes[*pass].off.is_none()) {
            let members = graph.passes[pass].outputs.iter().flat_map(|port| &port.members);
            for (r, (_, _, made)) in self.of_pass(pass).zip(members) {
                let Made::Handed { input, member } = made else { continue };
                if let Some((_, from)) = self.member_of(graph, pass, input, member) {
                    self.made[r] = from as u32;
                }
            }
        }
        for r in 0..self.made.len() {
            // Links within a frame have no cycle.
            while self.made[r] != self.made[self.made[r] as usize] {
                self.made[r] = self.made[self.made[r] as usize];
            }
        }
    }
}
