//! Members of outputs that are resources of an input, handed on under the facts of another pass.

use super::sizes::Unknown;
use super::wires::End;
use super::{Described, GraphPorts, Linker, Made};
use crate::codes;
use crate::interface::Interface;
use crate::port::{HandedOn, InputDesc, PassTypeError, Usage};
use crate::resource::ResourceDesc;
use data_file::{Diagnostic, Name};
use smallvec::SmallVec;

/// A resource of the graph: node, port, and member of the port.
type At = (u32, u32, u32);

impl Linker<'_> {
    /// Adds the members of an output that its pass hands on.
    #[expect(clippy::too_many_arguments, reason = "all that describing a port has")]
    pub(super) fn hand_on(
        &self,
        node: usize,
        port: &Name,
        interface: Option<&Interface>,
        handed: &HandedOn,
        whole: bool,
        inputs: &[InputDesc],
        members: &mut SmallVec<[(Name, ResourceDesc, Made); 1]>,
    ) -> Result<(), Unknown> {
        let input = match handed {
            HandedOn::All { input } | HandedOn::Member { input, .. } => input,
        };
        let Some(found) = inputs.iter().find(|desc| desc.name == *input) else {
            return Err(match whole {
                true => self.defect(
                    node,
                    format!("hands `{input}` on as its output `{port}`, which is no input that is linked"),
                ),
                false => Unknown::Waits(PassTypeError::new(format!("`{port}` hands `{input}` on"))),
            });
        };
        // Of an interface with members, the static name; of a single texture or buffer, none.
        let own = |name: &str| match interface {
            Some(interface) => interface.members.iter().find(|m| m.name == name).map(|m| Name::new(m.name)),
            None => name.is_empty().then_some(Name::default()),
        };
        let mut add = |name: Name, from: &str, desc: &ResourceDesc| {
            if members.iter().any(|(other, _, _)| *other == name) {
                return Err(self.defect(node, format!("describes `{name}` of its output `{port}` twice")));
            }
            let made = Made::Handed { input: Name::from(input), member: Name::from(from) };
            members.push((name, desc.clone(), made));
            Ok(())
        };
        match handed {
            HandedOn::All { .. } => {
                for (from, desc) in &found.members {
                    if let Some(name) = own(from) {
                        add(name, from, desc)?;
                    }
                }
                Ok(())
            }
            HandedOn::Member { member, from, .. } => {
                let Some(name) = own(member) else {
                    return Err(self.defect(
                        node,
                        format!("hands on a member `{member}` that its output `{port}` cannot have"),
                    ));
                };
                match found.member(from) {
                    Some(desc) => add(name, from, desc),
                    None => Err(self.defect(
                        node,
                        format!(
                            "hands on `{from}` of its input `{input}`, which what is linked does not make"
                        ),
                    )),
                }
            }
        }
    }

    /// Returns whether a node is on, as far as that is decided.
    pub(super) fn is_on(&self, node: usize) -> bool {
        self.on[node] != Some(false)
    }

    /// Returns the end of the wire into an input, with what is off taken out.
    fn wire_of(&self, node: usize, input: &str) -> Option<&End> {
        let names = &self.uses[node].as_ref()?.names.inputs;
        let wire = self.wires_now(node).iter().find(|wire| names[wire.input as usize].0 == *input)?;
        Some(&wire.end)
    }

    /// What is handed on must be of this frame.
    pub(super) fn check_handed(&mut self, ports: &[Described]) {
        let hands = |ports: &GraphPorts| {
            let members = ports.iter().flat_map(|port| &port.members);
            members.into_iter().any(|(_, _, made)| matches!(made, Made::Handed { .. }))
        };
        if !ports.iter().flatten().any(hands) {
            return;
        }
        let mut errors = Vec::new();
        for (node, described) in ports.iter().enumerate() {
            let Some(described) = described.as_ref().filter(|_| self.is_on(node)) else { continue };
            for port in &**described {
                let input_of = |made: &Made| match made {
                    Made::Handed { input, .. } => Some(input.clone()),
                    Made::Here(_) => None,
                };
                let mut inputs: Vec<Name> = port.members.iter().filter_map(|(_, _, m)| input_of(m)).collect();
                inputs.dedup();
                for input in inputs {
                    let end = self.wire_of(node, &input);
                    if end.is_some_and(|end| end.past) {
                        errors.push(self.hands_on_past(node, &port.port, &input));
                    }
                }
            }
        }
        self.errors.extend(errors);
    }

    fn hands_on_past(&self, node: usize, port: &Name, input: &Name) -> Diagnostic {
        let name = &self.nodes[node].name;
        let message = format!("`{name}.{port}` hands on its input `{input}`, which is a `prev` link");
        let place = self.nodes[node].decl.link(input).map_or(self.nodes[node].place, |link| link.place);
        Diagnostic::new(&codes::PAST, message)
            .label(self.span(place), "this is the `prev` link")
            .label(self.span(self.nodes[node].place), "by a pass that hands it on")
            .note(
                "a reader would mistake the history buffer for this frame's version: let the reader itself link to it with `prev`",
            )
    }

    /// What an output begins as must be of its format and size.
    pub(super) fn check_continued(&mut self, ports: &[Described]) {
        let mut errors = Vec::new();
        for (node, described) in ports.iter().enumerate() {
            let Some(described) = described.as_ref().filter(|_| self.is_on(node)) else { continue };
            for port in &**described {
                for (name, desc, made) in &port.members {
                    let Made::Here(Usage::Continue { input, member }) = made else { continue };
                    let Some(end) = self.wire_of(node, input) else { continue };
                    let from = member_at(self, end, member, ports).and_then(|(node, port, member)| {
                        let ports = ports[node as usize].as_ref()?;
                        Some(&ports[port as usize].members[member as usize].1)
                    });
                    if from != Some(desc) {
                        let dot = if name.is_empty() { "" } else { "." };
                        let text = format!("{}.{}{dot}{name}", self.nodes[node].name, port.port);
                        let found = from.map_or("nothing".to_owned(), ToString::to_string);
                        let place = self.nodes[node].decl.link(input).map(|link| link.place);
                        let place = place.unwrap_or(self.nodes[node].place);
                        let message =
                            format!("`{text}`, {desc}, continues its input `{input}`, which is {found}");
                        let error = Diagnostic::new(&codes::INTERFACE, message)
                            .label(self.span(place), "not of the same format and size")
                            .label(self.span(self.nodes[node].place), "of this pass");
                        errors.push(error);
                    }
                }
            }
        }
        self.errors.extend(errors);
    }
}

/// Returns the resources at the end of a wire.
fn members_of(linker: &Linker<'_>, end: &End, ports: &[Described]) -> Vec<At> {
    let Some(ports) = &ports[end.node as usize] else { return Vec::new() };
    let port = &ports[end.port as usize];
    let chosen = linker.member(&port.interface, end.member);
    let members = port.members.iter().enumerate();
    let members = members.filter(|(_, (name, _, _))| chosen.is_none_or(|chosen| *name == chosen));
    members.map(|(m, _)| (end.node, end.port, m as u32)).collect()
}

/// Returns the resource that an input sees under the name of a member.
fn member_at(linker: &Linker<'_>, end: &End, member: &str, ports: &[Described]) -> Option<At> {
    let members = members_of(linker, end, ports);
    let port = &ports[end.node as usize].as_ref()?[end.port as usize];
    let named = members.iter().find(|(_, _, m)| port.members[*m as usize].0 == *member);
    // A single resource goes without its name.
    named.or(members.first().filter(|_| member.is_empty())).copied()
}
