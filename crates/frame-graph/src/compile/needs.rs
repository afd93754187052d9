//! Determines what a plan must write: what is requested, what that needs, and what is kept besides.

use super::{CompileOptions, NONE, Work};
use crate::codes;
use crate::link::GraphPort;
use data_file::{Diagnostic, Diagnostics, Source, Span};
use petgraph::graph::NodeIndex;
use petgraph::visit::{Dfs, EdgeFiltered, EdgeRef as _, Reversed};
use std::ops::Range;

impl<'a> Work<'a> {
    /// Takes the requested outputs and resources.
    pub(super) fn want(&mut self, options: &CompileOptions) -> Result<(), Diagnostics> {
        let mut errors = Vec::new();
        if options.outputs.is_empty() {
            self.wanted = (0..self.graph.outputs.len() as u32).collect();
        }
        for name in &options.outputs {
            match self.graph.outputs.iter().position(|output| output.name == *name) {
                Some(i) => self.wanted.push(i as u32),
                None => {
                    let names = self.graph.outputs.iter().map(|output| &*output.name);
                    errors.push(
                        asked("output", name, "the pipeline has no output").suggest("outputs", name, names),
                    );
                }
            }
        }
        self.wanted.sort_unstable();
        self.wanted.dedup();
        for i in self.wanted.clone() {
            let output = &self.graph.outputs[i as usize];
            self.needed[output.from.pass.index()] = true;
            self.keep(self.numbers.in_port(&output.from));
        }
        for name in &options.keep {
            match self.find(name) {
                Ok((pass, resources)) => {
                    self.needed[pass.index()] = true;
                    self.keep(resources);
                }
                Err(error) => errors.push(error),
            }
        }
        if errors.is_empty() { Ok(()) } else { Err(Diagnostics(errors)) }
    }

    /// Keeps resources that are read after the frame.
    fn keep(&mut self, resources: Range<usize>) {
        for r in resources {
            self.resources[r].read = true;
            let made = &mut self.resources[self.numbers.made[r] as usize];
            made.persistent = true;
            made.read = true;
        }
    }

    /// Returns the pass and the resources of `pass`, `pass.port`, `pass.member` or `pass.port.member`.
    fn find(&self, name: &str) -> Result<(NodeIndex, Range<usize>), Diagnostic> {
        let mut parts = name.split('.');
        let pass = parts.next().unwrap_or("");
        let passes = &self.graph.passes;
        let Some(i) = passes.node_indices().find(|i| passes[*i].name == *pass) else {
            if self.graph.left_out.iter().any(|left_out| *left_out == *pass) {
                let what = "the pass does not fit this pipeline, and was left out:";
                return Err(asked("keep", name, what));
            }
            let passes = passes.node_weights().map(|p| &*p.name);
            return Err(asked("keep", name, "there is no pass for").suggest("passes", pass, passes));
        };
        let found = &passes[i];
        if let Some(off) = &found.off {
            return Err(asked("keep", name, "the pass is off:").note(format!("its switch: {}", off.why)));
        }
        let port = parts.next();
        let member = parts.next();
        let ports = || {
            let members = |p: &'a GraphPort| {
                let port = p.port.as_str();
                p.members
                    .iter()
                    .map(move |(m, _, _)| if m.is_empty() { port.to_owned() } else { format!("{port}.{m}") })
            };
            found.outputs.iter().flat_map(members).collect::<Vec<_>>()
        };
        let unknown = || {
            let known = ports();
            let tail = &name[(pass.len() + 1).min(name.len())..];
            asked("keep", name, "the pass has no resource for").suggest(
                "resources",
                tail,
                known.iter().map(String::as_str),
            )
        };
        let of_port = |at: usize| self.numbers.of_port(i, at as u32);
        let of_member = |at: usize, member: &str| {
            let m = found.outputs[at].members.iter().position(|(m, _, _)| m == member)?;
            let first = of_port(at).start + m;
            Some(first..first + 1)
        };
        // Scratch resources come after all ports, and can be kept by name only.
        let seen = found.outputs.iter().filter(|p| !p.interface.is_empty()).count();
        let of_name = |port: &str| found.outputs.iter().position(|p| p.port == *port);
        let resources = match (port, member, parts.next()) {
            (None, ..) if seen > 0 => Some(of_port(0).start..of_port(seen - 1).end),
            // A port, or a member of the first port that has one with this name.
            (Some(port), None, _) => match of_name(port) {
                Some(at) => Some(of_port(at)),
                None => (0..seen).find_map(|at| of_member(at, port)),
            },
            (Some(port), Some(member), None) => of_name(port).and_then(|at| of_member(at, member)),
            _ => None,
        };
        resources.map(|resources| (i, resources)).ok_or_else(unknown)
    }

    /// Marks what is needed, through links of this frame and of the frame before.
    pub(super) fn cull(&mut self) {
        let graph = self.graph;
        let needed = graph.passes.node_indices().filter(|pass| self.needed[pass.index()]);
        // A pass that is off reads nothing.
        let links = EdgeFiltered::from_fn(&graph.passes, |link| graph.passes[link.target()].off.is_none());
        let links = Reversed(&links);
        let mut search = Dfs::empty(links);
        search.stack = needed.collect();
        while let Some(pass) = search.next(links) {
            self.needed[pass.index()] = true;
        }
        for link in graph.passes.edge_references() {
            if !self.runs(link.target()) {
                continue;
            }
            let link = link.weight();
            for r in self.numbers.in_port(&link.from) {
                self.resources[r].read = true;
                let resource = &mut self.resources[self.numbers.made[r] as usize];
                resource.read = true;
                if link.past {
                    resource.persistent = true;
                    resource.history = 0;
                    resource.past_readers += 1;
                } else {
                    resource.readers += 1;
                }
            }
        }
        let mut histories = 0;
        for resource in &mut self.resources {
            if resource.history != NONE {
                resource.history = histories;
                histories += 1;
            }
        }
    }

    /// Keeps the resources of ports with these interfaces, in passes that run.
    pub(super) fn keep_made(&mut self, interfaces: &[String]) {
        if interfaces.is_empty() {
            return;
        }
        let graph = self.graph;
        let kept = |port: &GraphPort| interfaces.iter().any(|name| port.interface == *name);
        for pass in graph.passes.node_indices() {
            if !self.runs(pass) {
                continue;
            }
            let ports = graph.passes[pass].outputs.iter().enumerate();
            for (at, _) in ports.filter(|(_, port)| kept(port)) {
                self.keep(self.numbers.of_port(pass, at as u32));
            }
        }
    }
}

/// Returns an error about something that an option requested.
fn asked(option: &str, name: &str, what: &str) -> Diagnostic {
    let source = Source::new(format!("--{option}"), name);
    let span = Span { source, start: 0, end: name.len() as u32 };
    Diagnostic::new(&codes::UNKNOWN_OUTPUT, format!("{what} `{name}`")).label(span, "")
}
