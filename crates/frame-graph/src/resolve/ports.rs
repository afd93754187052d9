//! The ports of passes and the interfaces that links join, as far as they are known without linking: for editors.

use super::{Node, Resolved};
use crate::description::{Body, Target};
use crate::plan::values::complete;
use crate::port::{PassTypes, Ports};
use data_file::Name;
use std::sync::Arc;

/// The interfaces that take more than one.
const ANY: [&str; 3] = ["Any", "Texture", "Buffer"];

impl Resolved {
    /// Returns the ports of a pass; `None` for a sub-graph, and where its pass type cannot say them.
    pub fn ports(&self, kinds: &dyn PassTypes, pass: &str) -> Option<Arc<Ports>> {
        self.ports_of(kinds, self.node(pass)?)
    }

    fn node(&self, pass: &str) -> Option<&Node> {
        self.index.get(pass).map(|node| &self.nodes[*node as usize])
    }

    fn ports_of(&self, kinds: &dyn PassTypes, node: &Node) -> Option<Arc<Ports>> {
        let use_ = node.decl.use_of(&node.decl.link_names)?;
        let settings = complete(&node.decl, &kinds.settings(use_).ok()?)?;
        kinds.ports(use_, &settings).ok()
    }

    /// Returns the outputs of a pass or a sub-graph, each with its interface.
    pub fn outputs_of(&self, kinds: &dyn PassTypes, pass: &str) -> Vec<(Name, String)> {
        let Some(node) = self.node(pass) else { return Vec::new() };
        let Body::Group(group) = &node.decl.body else {
            let ports = self.ports_of(kinds, node);
            let outputs = ports.iter().flat_map(|ports| &ports.outputs);
            return outputs.map(|port| (Name::from(&*port.name), port.interface.clone())).collect();
        };
        let interface = |target: &Target| self.interface_of(kinds, target).unwrap_or_default();
        let outputs = group.outputs.iter();
        outputs.map(|output| (output.name.value.clone(), interface(&output.link.target))).collect()
    }

    /// Returns the interface of what a link reads, where the link says it or there is only one.
    fn interface_of(&self, kinds: &dyn PassTypes, target: &Target) -> Option<String> {
        let target = self.source(target)?;
        let outputs = self.outputs_of(kinds, &target.pass);
        match (&target.port, outputs.as_slice()) {
            (Some(port), outputs) => {
                outputs.iter().find(|(name, _)| name == port).map(|(_, interface)| interface.clone())
            }
            (None, [(_, interface)]) => Some(interface.clone()),
            (None, _) => None,
        }
    }

    /// Returns the interface of what a link's text names, `pass` or `pass.port`.
    pub fn interface_of_link(&self, kinds: &dyn PassTypes, link: &str) -> Option<String> {
        self.interface_of(kinds, &Target::parse(link)?)
    }

    /// Returns the interface of an output of the pipeline.
    pub fn interface_of_output(&self, kinds: &dyn PassTypes, name: &str) -> Option<String> {
        let output = self.outputs.iter().find(|output| output.name.value == name)?;
        self.interface_of(kinds, &output.link.target)
    }

    /// Follows a link out of the sub-graphs whose inputs it reads.
    fn source(&self, target: &Target) -> Option<Target> {
        let mut target = target.clone();
        for _ in 0..self.nodes.len() {
            let Some(part) = target.pass.strip_suffix("/in") else { return Some(target) };
            let link = self.node(part)?.decl.link(target.port.as_ref()?)?;
            target = Target { member: target.member.or(link.target.member.clone()), ..link.target.clone() };
        }
        None
    }

    /// Returns the interfaces that the readers of a pass or a sub-graph take from it, each once.
    pub fn interfaces_read(&self, kinds: &dyn PassTypes, pass: &str) -> Vec<String> {
        let outputs = self.outputs_of(kinds, pass);
        let mut found: Vec<String> = Vec::new();
        for node in &self.nodes {
            let mut ports = None;
            for link in &node.decl.links {
                let Some(target) = self.source(&link.target).filter(|target| target.pass == pass) else {
                    continue;
                };
                let of_output = target.port.and_then(|port| outputs.iter().find(|(name, _)| *name == port));
                let interface = of_output.map(|(_, interface)| interface.clone()).or_else(|| {
                    let ports = ports.get_or_insert_with(|| self.ports_of(kinds, node)).as_ref()?;
                    let input = ports.inputs.iter().find(|input| link.port.value == *input.name)?;
                    Some(input.interface.clone())
                });
                found.extend(interface.filter(|interface| {
                    !interface.is_empty() && !ANY.contains(&interface.as_str()) && !found.contains(interface)
                }));
            }
        }
        found
    }
}
