//! Follows links to the ports at their ends.

use super::Linker;
use crate::codes;
use crate::description::{At, Body, Group, InputDecl, Link, Off};
use crate::interface::Interface;
use data_file::{Diagnostic, Name, Place};
use smallvec::SmallVec;

/// Most borders and switched-off passes that one link may cross.
const MAX_HOPS: usize = 4096;

/// The port at the end of a link.
#[derive(Clone, Copy, Debug)]
pub(super) struct End {
    pub(super) node: u32,
    pub(super) port: u32,
    /// Index into the members of the port's interface, where the link takes one of several.
    pub(super) member: Option<u32>,
    /// Whether a link on the way reads the frame before.
    pub(super) past: bool,
}

/// Where a link leads.
#[derive(Clone, Copy, Debug)]
pub(super) enum Found {
    End(End),
    /// To a node that is off and has nothing in its place.
    Nothing(u32),
    /// Nowhere: an error, already reported.
    Reported,
}

/// Returns the sub-graph whose inputs a target names: `""` for the file itself.
fn border(pass: &str) -> Option<&str> {
    if pass == "in" { Some("") } else { pass.strip_suffix("/in") }
}

/// Returns whether an input sees one resource without the name of its member.
pub(super) fn is_bare(wanted: &str, end: &End) -> bool {
    end.member.is_some() || matches!(wanted, "Texture" | "Buffer")
}

pub(super) fn with_article(interface: &str) -> String {
    let vowel = interface.starts_with(['A', 'E', 'I', 'O', 'U']);
    format!("{} `{interface}`", if vowel { "an" } else { "a" })
}

impl<'a> Linker<'a> {
    pub(super) fn interface(&self, name: &str) -> Option<&'a Interface> {
        self.interfaces.iter().find(|interface| interface.name == name)
    }

    /// Returns the interface of the port at an end.
    pub(super) fn interface_of(&self, end: &End) -> Name {
        let used = self.uses[end.node as usize].as_ref();
        used.map_or_else(Name::default, |used| used.names.outputs[end.port as usize].1.clone())
    }

    /// Names of the resources that a port may hold.
    fn members(&self, interface: &str) -> impl Iterator<Item = &'static str> + use<'a> {
        self.interface(interface).into_iter().flat_map(|i| i.members.iter().map(|m| m.name))
    }

    /// `pass.port`, as shown in errors.
    pub(super) fn end_text(&self, end: &End) -> String {
        let node = &self.nodes[end.node as usize];
        let Some(used) = &self.uses[end.node as usize] else { return node.name.to_string() };
        let (port, interface) = &used.names.outputs[end.port as usize];
        match end.member.and_then(|m| self.interface(interface)?.members.get(m as usize)) {
            Some(member) if !member.name.is_empty() => format!("{}.{port}.{}", node.name, member.name),
            _ => format!("{}.{port}", node.name),
        }
    }

    /// What an end offers: `a `GBuffer``.
    pub(super) fn offer_text(&self, end: &End) -> String {
        let interface = self.interface_of(end);
        match end.member.and_then(|m| self.interface(&interface)?.members.get(m as usize)) {
            Some(member) => format!("only the member `{}` of {}", member.name, with_article(&interface)),
            None => with_article(&interface),
        }
    }

    /// Returns the link into an input of a pass or sub-graph.
    pub(super) fn link_into(&self, node: usize, input: &str) -> Option<&'a Link> {
        self.nodes[node].decl.links.iter().find(|link| link.port.value == input)
    }

    /// Follows a link to its end, for an input of the interface `wanted`. With `live`, what is off is replaced.
    pub(super) fn follow(&mut self, link: &'a Link, wanted: Option<&Name>, live: bool) -> Found {
        let nodes = self.nodes;
        let (mut link, mut wanted) = (link, wanted.cloned());
        let mut past = false;
        // A member chosen on the way, of whatever port is at the end.
        let mut member: Option<Name> = None;
        // The interface that must be at the end, and the `off:` that says so.
        let mut instead: Option<(Name, Place)> = None;
        // What is off and was crossed by its `off:`.
        let mut crossed: SmallVec<[u32; 4]> = SmallVec::new();
        for _ in 0..MAX_HOPS {
            if link.past && past {
                let error =
                    Diagnostic::new(&codes::PAST, "this reads the history buffer of a history buffer")
                        .label(self.span(link.place), "one `prev` too many")
                        .note("only the last frame is kept: let a pass hand on what it needs of older ones");
                self.errors.push(error);
                return Found::Reported;
            }
            past |= link.past;
            let target = &link.target;
            if let Some(part) = border(&target.pass) {
                match self.input_of(part, link) {
                    Ok((next, interface)) => {
                        member = target.member.clone().or(member);
                        (link, wanted) = (next, Some(interface));
                        continue;
                    }
                    Err(found) => return found,
                }
            }
            let Some(&node) = self.resolved.index.get(&target.pass) else {
                self.unknown_pass(link);
                return Found::Reported;
            };
            let decl = &*nodes[node as usize].decl;
            let off = live && !self.is_on(node as usize);
            let (port, chosen) = match &decl.body {
                Body::Removed | Body::Sub(_) => return Found::Nothing(node),
                Body::Group(group) => {
                    let Some((inner, chosen)) = self.output_of(node, group, link, wanted.as_ref()) else {
                        return Found::Reported;
                    };
                    member = chosen.or(member);
                    link = match &decl.off {
                        _ if !off => inner,
                        None => return Found::Nothing(node),
                        Some(At { value, place }) => {
                            let Some(next) = self.stand_in(node, value, &mut crossed) else {
                                return Found::Reported;
                            };
                            if let Some(interface) = self.offered(inner, wanted.as_ref()) {
                                instead = Some((interface.clone(), *place));
                                wanted = Some(interface);
                            }
                            next
                        }
                    };
                    continue;
                }
                Body::Pass { .. } => match self.select(node, link, member.as_ref(), wanted.as_ref()) {
                    Some(found) => found,
                    None => return Found::Reported,
                },
            };
            let end = End { node, port, member: chosen, past };
            if let Some((interface, place)) = &instead
                && !self.stands_for(interface, &end)
            {
                let message = format!("`off:` must put {} here", with_article(interface));
                let error = Diagnostic::new(&codes::OFF, message)
                    .label(self.span(*place), format!("this is {}", self.offer_text(&end)))
                    .label(self.span(nodes[node as usize].place), "from this pass");
                self.errors.push(error);
                return Found::Reported;
            }
            match &decl.off {
                _ if !off => return Found::End(end),
                None => return Found::Nothing(node),
                Some(At { value, place }) => {
                    let Some(next) = self.stand_in(node, value, &mut crossed) else { return Found::Reported };
                    let interface = self.interface_of(&end);
                    // By name: the port at the other end has the same interface.
                    let members = self.interface(&interface).map_or(&[][..], |i| i.members);
                    member = chosen.and_then(|m| members.get(m as usize)).map(|m| Name::new(m.name));
                    instead = Some((interface.clone(), *place));
                    wanted = Some(interface);
                    link = next;
                }
            }
        }
        let message =
            format!("this link leads back to itself, or across more than {MAX_HOPS} borders of sub-graphs");
        let error = Diagnostic::new(&codes::CYCLE, message).label(self.span(link.place), "");
        self.errors.push(error);
        Found::Reported
    }

    /// Returns the link that stands in place of the outputs of a node that is off; `None`, after reporting an error,
    /// where such links lead back to the node, or to none.
    fn stand_in(&mut self, node: u32, off: &'a Off, crossed: &mut SmallVec<[u32; 4]>) -> Option<&'a Link> {
        if let Some(at) = crossed.iter().position(|other| *other == node) {
            self.off_loop(&crossed[at..]);
            return None;
        }
        crossed.push(node);
        match off {
            // An inserted pass has no link of its own to the input that it is fed by.
            Off::Input(input) => {
                self.link_into(node as usize, input).or(self.nodes[node as usize].decl.feed.as_ref())
            }
            Off::Link(link) => Some(link),
        }
    }

    /// Reports that nodes that are off stand in place of each other.
    fn off_loop(&mut self, found: &[u32]) {
        // From whatever reader the loop was entered, it is reported alike, and so once.
        let start = (0..found.len()).min_by_key(|at| found[*at]).unwrap_or(0);
        let mut ring: Vec<u32> = found[start..].iter().chain(&found[..start]).copied().collect();
        let name = |node: &u32| &*self.nodes[*node as usize].name;
        let message = match &ring[..] {
            [only] => format!("`{}` is off and is replaced by itself", name(only)),
            ring => {
                let names: Vec<String> = ring.iter().map(|node| format!("`{}`", name(node))).collect();
                format!("{} are off and replace each other", names.join(", "))
            }
        };
        let mut error = Diagnostic::new(&codes::OFF_LOOP, message);
        for node in &ring {
            if let Some(off) = &self.nodes[*node as usize].decl.off {
                error = error.label(self.span(off.place), format!("in place of `{}`", name(node)));
            }
        }
        ring.push(ring[0]);
        let path: Vec<&str> = ring.iter().map(name).collect();
        self.errors.push(error.note(format!("the loop: {}", path.join(" → "))));
    }

    /// Returns the interface of what a link brings with everything on; `None` where it brings a member, or nothing.
    pub(super) fn offered(&mut self, link: &'a Link, wanted: Option<&Name>) -> Option<Name> {
        match self.silently(|linker| linker.follow(link, wanted, false)) {
            Found::End(end) if end.member.is_none() => Some(self.interface_of(&end)),
            _ => None,
        }
    }

    /// Returns whether what is at an end can stand in place of an output of this interface.
    pub(super) fn stands_for(&self, interface: &Name, end: &End) -> bool {
        let single = matches!(interface.as_str(), "Texture" | "Buffer");
        self.interface_of(end) == *interface || (single && end.member.is_some())
    }

    /// Returns the link outside a sub-graph into the input that a link inside it names.
    fn input_of(&mut self, part: &str, link: &'a Link) -> Result<(&'a Link, Name), Found> {
        let nodes = self.nodes;
        let node = self.resolved.index.get(part).map(|i| *i as usize);
        let group =
            node.and_then(|i| if let Body::Group(group) = &nodes[i].decl.body { Some(group) } else { None });
        let inputs: &[InputDecl] = match group {
            Some(group) => &group.inputs,
            None if part.is_empty() => &self.resolved.inputs,
            None => {
                self.unknown_pass(link);
                return Err(Found::Reported);
            }
        };
        let port = link.target.port.as_ref();
        let Some(input) = inputs.iter().find(|i| Some(&i.name.value) == port) else {
            let port = port.map_or("", |port| port.as_str());
            let message = match port {
                "" => "`in` must name an input: \"in.NAME\"".to_owned(),
                _ => format!("this file has no input `{port}`"),
            };
            let error = Diagnostic::new(&codes::UNKNOWN_PASS, message)
                .label(self.span(link.port_place()), "")
                .suggest("inputs", port, inputs.iter().map(|i| &*i.name.value));
            self.errors.push(error);
            return Err(Found::Reported);
        };
        let outer = node.and_then(|node| self.link_into(node, &input.name.value));
        let Some(outer) = outer else { return Err(Found::Reported) };
        if self.bad_borders.contains(&outer.place) {
            return Err(Found::Reported);
        }
        let interface = self.interface(&input.interface.value).map(|i| Name::new(i.name));
        Ok((outer, interface.unwrap_or_else(|| input.interface.value.clone())))
    }

    /// Returns the link inside a sub-graph to the output that a link outside names, and the member that it names.
    fn output_of(
        &mut self,
        node: u32,
        group: &'a Group,
        link: &'a Link,
        wanted: Option<&Name>,
    ) -> Option<(&'a Link, Option<Name>)> {
        let target = &link.target;
        let named = |port: &Name| group.outputs.iter().find(|o| o.name.value == *port);
        if let Some(output) = target.port.as_ref().and_then(named) {
            return Some((&output.link, target.member.clone()));
        }
        match (&target.port, &group.outputs[..]) {
            // Not a port of that name: a member of the only one.
            (Some(port), [only]) if target.member.is_none() => return Some((&only.link, Some(port.clone()))),
            (None, [only]) => return Some((&only.link, None)),
            (None, outputs) => {
                // What is wrong inside is reported when the sub-graph itself is checked.
                let fits = |linker: &mut Self, link: &'a Link| match linker.follow(link, None, false) {
                    Found::End(end) => wanted == Some(&linker.interface_of(&end)),
                    _ => false,
                };
                let found = self.silently(|linker| {
                    let mut fitting = outputs.iter().filter(|output| fits(linker, &output.link));
                    (fitting.next(), fitting.next())
                });
                if let (Some(output), None) = found {
                    return Some((&output.link, None));
                }
            }
            _ => {}
        }
        let names = group.outputs.iter().map(|o| &*o.name.value);
        let part = &self.nodes[node as usize];
        let error = match &target.port {
            Some(port) => Diagnostic::new(
                &codes::UNKNOWN_PORT,
                format!("the sub-graph `{}` has no output `{port}`", part.name),
            )
            .label(self.span(link.port_place()), "")
            .label(self.span(part.place), "of this sub-graph")
            .suggest("outputs", port, names),
            None => {
                let names: Vec<&str> = names.collect();
                let message = format!("`{}` could mean several of its outputs", part.name);
                Diagnostic::new(&codes::AMBIGUOUS, message)
                    .label(self.span(link.place), "name one of them")
                    .note(format!("outputs of `{}`: {}", part.name, names.join(", ")))
            }
        };
        self.errors.push(error);
        None
    }

    fn unknown_pass(&mut self, link: &Link) {
        let pass = &*link.target.pass;
        // Names as the file that holds the link knows them.
        let scope = pass.rsplit_once('/').map_or("", |(scope, _)| scope);
        let known = self.nodes.iter().filter_map(|node| {
            let local = if scope.is_empty() {
                &*node.name
            } else {
                node.name.strip_prefix(scope)?.strip_prefix('/')?
            };
            (!local.contains('/') || scope.is_empty()).then_some(local)
        });
        let local = pass.rsplit('/').next().unwrap_or(pass);
        let local = if self.resolved.index.contains_key(scope) { local } else { pass };
        let error = Diagnostic::new(&codes::UNKNOWN_PASS, format!("there is no pass `{local}`"))
            .label(self.span(link.place), "")
            .suggest("passes", local, known);
        self.errors.push(error);
    }

    /// Returns the output port of a pass that a link means, and the member of it.
    fn select(
        &mut self,
        node: u32,
        link: &'a Link,
        chosen: Option<&Name>,
        wanted: Option<&Name>,
    ) -> Option<(u32, Option<u32>)> {
        let used = self.uses[node as usize].as_ref()?;
        let outputs = &used.names.outputs;
        let target = &link.target;
        let member = target.member.as_ref().or(chosen);
        let member_of = |port: usize, member: &str| {
            let interface = self.interface(&outputs[port].1)?;
            interface.members.iter().position(|m| m.name == member).map(|m| m as u32)
        };
        let port = match &target.port {
            Some(name) => {
                if let Some(port) = outputs.iter().position(|(port, _)| port == name) {
                    Ok(port)
                } else {
                    // Not a port of that name: a member of the only port that has one.
                    let mut having =
                        (0..outputs.len()).filter_map(|port| Some((port, member_of(port, name)?)));
                    match (having.next(), having.next()) {
                        (Some((port, m)), None) if member.is_none() => return Some((port as u32, Some(m))),
                        (Some(_), Some(_)) => {
                            Err(format!("several ports of `{}` have a member `{name}`", target.pass))
                        }
                        _ => return self.unknown_port(node, link, name),
                    }
                }
            }
            None => {
                let exact = |i: &usize| wanted.is_some_and(|wanted| outputs[*i].1 == *wanted);
                let single = |i: &usize| {
                    matches!(&*outputs[*i].1, "Texture" | "Buffer")
                        || self
                            .interface(&outputs[*i].1)
                            .is_some_and(|interface| interface.members.len() == 1)
                };
                let loose = wanted.is_some_and(|wanted| matches!(&**wanted, "Texture" | "Buffer"));
                let only = |fits: &dyn Fn(&usize) -> bool| {
                    let mut fitting = (0..outputs.len()).filter(fits);
                    fitting.next().filter(|_| fitting.next().is_none())
                };
                let any = |_: &usize| true;
                let found = only(&exact).or_else(|| only(&any)).or_else(|| only(&single).filter(|_| loose));
                found.ok_or_else(|| format!("`{}` could mean several of its outputs", target.pass))
            }
        };
        match port {
            Ok(port) => match member {
                None => Some((port as u32, None)),
                Some(member) => match member_of(port, member) {
                    Some(m) => Some((port as u32, Some(m))),
                    None => self.unknown_member(node, port, link, member),
                },
            },
            Err(_) if outputs.is_empty() => {
                let message = format!("`{}` has no outputs to link to", target.pass);
                let place = self.nodes[node as usize].place;
                let error = Diagnostic::new(&codes::UNKNOWN_PORT, message)
                    .label(self.span(link.place), "")
                    .label(self.span(place), "this pass");
                self.errors.push(error);
                None
            }
            Err(message) => {
                let offers: Vec<String> = outputs.iter().map(|(port, i)| format!("{port}: {i}")).collect();
                let mut error = Diagnostic::new(&codes::AMBIGUOUS, message)
                    .label(self.span(link.place), "name one of them")
                    .label(self.span(self.nodes[node as usize].place), "of this pass")
                    .note(format!("outputs of `{}`: {}", target.pass, offers.join(", ")));
                if let Some(wanted) = wanted {
                    error = error.note(format!("expected here: {}", with_article(wanted)));
                }
                self.errors.push(error);
                None
            }
        }
    }

    fn unknown_port(&mut self, node: u32, link: &Link, name: &str) -> Option<(u32, Option<u32>)> {
        let used = self.uses[node as usize].as_ref()?;
        let pass = &self.nodes[node as usize];
        let mut known: Vec<&str> = used.names.outputs.iter().map(|(port, _)| &**port).collect();
        let members: Vec<&str> = used.names.outputs.iter().flat_map(|(_, i)| self.members(i)).collect();
        known.extend(members.into_iter().filter(|m| !m.is_empty()));
        let error = Diagnostic::new(
            &codes::UNKNOWN_PORT,
            format!("`{}` has no output or member `{name}`", pass.name),
        )
        .label(self.span(link.port_place()), "")
        .label(self.span(pass.place), "of this pass")
        .suggest("outputs and members", name, known);
        self.errors.push(error);
        None
    }

    fn unknown_member(
        &mut self,
        node: u32,
        port: usize,
        link: &Link,
        member: &str,
    ) -> Option<(u32, Option<u32>)> {
        let used = self.uses[node as usize].as_ref()?;
        let pass = &self.nodes[node as usize];
        let (port, interface) = &used.names.outputs[port];
        let message =
            format!("`{}.{port}`, {}, has no member `{member}`", pass.name, with_article(interface));
        let known: Vec<&str> = self.members(interface).filter(|m| !m.is_empty()).collect();
        let error = Diagnostic::new(&codes::UNKNOWN_PORT, message)
            .label(self.span(link.port_place()), "")
            .label(self.span(pass.place), "of this pass")
            .suggest("members", member, known);
        self.errors.push(error);
        None
    }
}
