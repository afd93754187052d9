//! Follows links to the ports at their ends, and checks that the two ends fit.

use super::{Linker, Wire};
use crate::codes;
use crate::description::{At, Body, Group, InputDecl, Link, Off, Past};
use crate::diagnostic::{Diagnostic, Place, nearest};
use crate::name::Name;
use crate::port::Interface;
use crate::resource::Clear;
use rustc_hash::FxHashMap;
use std::sync::Arc;

/// Most borders and switched-off passes that one link may cross.
const MAX_HOPS: usize = 4096;

/// The port at the end of a link.
#[derive(Clone, Copy, Debug)]
pub(super) struct End<'a> {
    pub(super) node: u32,
    pub(super) port: u32,
    /// Index into the members of the port's interface, where the link takes one of several.
    pub(super) member: Option<u32>,
    /// What the link on the way says that reads the past.
    pub(super) past: Option<&'a Arc<Past>>,
    /// What is put in place of the pass, if it is off.
    pub(super) constant: Option<Clear>,
}

/// Where a link leads.
#[derive(Clone, Copy, Debug)]
pub(super) enum Found<'a> {
    End(End<'a>),
    /// To a node that is off and has nothing in its place.
    Nothing(u32),
    /// To an input of a part that may be left unlinked, and is.
    Unlinked,
    /// Nowhere: an error, told already.
    Told,
}

/// The part whose inputs a target names: `""` for the file itself.
fn border(pass: &str) -> Option<&str> {
    if pass == "in" { Some("") } else { pass.strip_suffix("/in") }
}

/// Whether an input sees one resource without the name of its member.
pub(super) fn is_bare(wanted: &str, end: &End<'_>) -> bool {
    end.member.is_some() || matches!(wanted, "Texture" | "Buffer")
}

fn with_article(interface: &str) -> String {
    let vowel = interface.starts_with(['A', 'E', 'I', 'O', 'U']);
    format!("{} `{interface}`", if vowel { "an" } else { "a" })
}

impl<'a> Linker<'a> {
    fn interface(&self, name: &str) -> Option<&'a Interface> {
        self.interfaces.iter().find(|interface| interface.name == name)
    }

    /// The interface of the port at an end.
    pub(super) fn interface_of(&self, end: &End<'_>) -> Name {
        let used = self.uses[end.node as usize].as_ref();
        used.map_or(Name::EMPTY, |used| used.names.outputs[end.port as usize].1.clone())
    }

    /// Names of the resources that a port may hold.
    fn members(&self, interface: &str) -> impl Iterator<Item = &'static str> + use<'a> {
        self.interface(interface).into_iter().flat_map(|i| i.members.iter().map(|m| m.name))
    }

    /// `pass.port`, as shown in errors.
    fn end_text(&self, end: &End<'_>) -> String {
        let node = &self.nodes[end.node as usize];
        let Some(used) = &self.uses[end.node as usize] else { return node.name.to_string() };
        let (port, interface) = &used.names.outputs[end.port as usize];
        match end.member.and_then(|m| self.interface(interface)?.members.get(m as usize)) {
            Some(member) if !member.name.is_empty() => format!("{}.{port}.{}", node.name, member.name),
            _ => format!("{}.{port}", node.name),
        }
    }

    /// What an end offers: `a `GBuffer``.
    fn offer_text(&self, end: &End<'_>) -> String {
        let interface = self.interface_of(end);
        match end.member.and_then(|m| self.interface(&interface)?.members.get(m as usize)) {
            Some(member) => format!("only the member `{}` of {}", member.name, with_article(&interface)),
            None => with_article(&interface),
        }
    }

    /// The link into an input of a pass or part.
    pub(super) fn link_into(&self, node: usize, input: &str) -> Option<&'a Link> {
        self.nodes[node].decl.links.iter().find(|link| link.port.value == input)
    }

    /// Follows a link to its end, for an input of the interface `wanted`. With `live`, what is off is replaced.
    pub(super) fn follow(&mut self, link: &'a Link, wanted: Option<&Name>, mut live: bool) -> Found<'a> {
        let nodes = self.nodes;
        let (mut link, mut wanted) = (link, wanted.cloned());
        let mut past = None;
        let mut constant = None;
        // A member chosen on the way, of whatever port is at the end.
        let mut member: Option<Name> = None;
        // The interface that must be at the end, and the `off:` that says so.
        let mut instead: Option<(Name, Place)> = None;
        for _ in 0..MAX_HOPS {
            if link.past.is_some() && past.is_some() {
                let error = Diagnostic::new(&codes::PAST, "this reads the past of a past")
                    .label(self.span(link.place), "one `Prev` too many")
                    .note("only the last frame is kept: let a pass hand on what it needs of older ones");
                self.errors.push(error);
                return Found::Told;
            }
            past = past.or(link.past.as_ref());
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
                return Found::Told;
            };
            let decl = &*nodes[node as usize].decl;
            let off = live && !self.is_on(node as usize);
            let (port, chosen) = match &decl.body {
                Body::Removed | Body::Sub { .. } => return Found::Nothing(node),
                Body::Group(group) => {
                    match &decl.off {
                        Some(At { value: Off::Constant(clear), .. }) if off => {
                            // The constant takes the shape of what would be there.
                            constant = Some(*clear);
                            live = false;
                        }
                        Some(At { value: Off::Input(input), .. }) if off => {
                            let Some(next) = self.link_into(node as usize, input) else { return Found::Told };
                            link = next;
                            continue;
                        }
                        _ if off => return Found::Nothing(node),
                        _ => {}
                    }
                    let Some((next, chosen)) = self.output_of(node, group, link, wanted.as_ref()) else {
                        return Found::Told;
                    };
                    member = chosen.or(member);
                    link = next;
                    continue;
                }
                Body::Pass { .. } => match self.select(node, link, member.as_ref(), wanted.as_ref()) {
                    Some(found) => found,
                    None => return Found::Told,
                },
            };
            let mut end = End { node, port, member: chosen, past, constant };
            if let Some((interface, place)) = &instead
                && self.interface_of(&end) != *interface
            {
                let message = format!("`off:` must put {} here", with_article(interface));
                let error = Diagnostic::new(&codes::OFF, message)
                    .label(self.span(*place), format!("this input brings {}", self.offer_text(&end)))
                    .label(self.span(nodes[node as usize].place), "from this pass");
                self.errors.push(error);
                return Found::Told;
            }
            match &decl.off {
                _ if !off => return Found::End(end),
                None => return Found::Nothing(node),
                Some(At { value: Off::Constant(clear), .. }) => {
                    end.constant = Some(*clear);
                    return Found::End(end);
                }
                Some(At { value: Off::Input(input), place }) => {
                    let Some(next) = self.link_into(node as usize, input) else { return Found::Told };
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
        let error = Diagnostic::new(&codes::CYCLE, "this link leads back to itself through parts")
            .label(self.span(link.place), "");
        self.errors.push(error);
        Found::Told
    }

    /// The link outside a part into the input that a link inside it names.
    fn input_of(&mut self, part: &str, link: &'a Link) -> Result<(&'a Link, Name), Found<'a>> {
        let nodes = self.nodes;
        let node = self.resolved.index.get(part).map(|i| *i as usize);
        let group = node.and_then(|i| if let Body::Group(group) = &nodes[i].decl.body { Some(group) } else { None });
        let inputs: &[InputDecl] = match group {
            Some(group) => &group.inputs,
            None if part.is_empty() => &self.resolved.inputs,
            None => {
                self.unknown_pass(link);
                return Err(Found::Told);
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
            return Err(Found::Told);
        };
        let Some(node) = node else { return Err(if input.optional { Found::Unlinked } else { Found::Told }) };
        let Some(outer) = self.link_into(node, &input.name.value) else {
            return Err(if input.optional { Found::Unlinked } else { Found::Told });
        };
        if self.bad_borders.contains(&outer.place) {
            return Err(Found::Told);
        }
        let interface = self.interface(&input.interface.value).map(|i| Name::new(i.name));
        Ok((outer, interface.unwrap_or_else(|| input.interface.value.clone())))
    }

    /// The link inside a part to the output that a link outside names, and the member that it names.
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
                let told = self.errors.len();
                let fits = |linker: &mut Self, link: &'a Link| match linker.follow(link, None, false) {
                    Found::End(end) => wanted == Some(&linker.interface_of(&end)),
                    _ => false,
                };
                let mut fitting = outputs.iter().filter(|output| fits(self, &output.link));
                let found = (fitting.next(), fitting.next());
                // What is wrong inside is told when the part itself is checked.
                self.errors.truncate(told);
                if let (Some(output), None) = found {
                    return Some((&output.link, None));
                }
            }
            _ => {}
        }
        let names = group.outputs.iter().map(|o| &*o.name.value);
        let part = &self.nodes[node as usize];
        let error = match &target.port {
            Some(port) => {
                Diagnostic::new(&codes::UNKNOWN_PORT, format!("the part `{}` has no output `{port}`", part.name))
                    .label(self.span(link.port_place()), "")
                    .label(self.span(part.place), "of this part")
                    .suggest("outputs", port, names)
            }
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
            let local = if scope.is_empty() { &*node.name } else { node.name.strip_prefix(scope)?.strip_prefix('/')? };
            (!local.contains('/') || scope.is_empty()).then_some(local)
        });
        let local = pass.rsplit('/').next().unwrap_or(pass);
        let local = if self.resolved.index.contains_key(scope) { local } else { pass };
        let error = Diagnostic::new(&codes::UNKNOWN_PASS, format!("there is no pass `{local}`"))
            .label(self.span(link.place), "")
            .suggest("passes", local, known);
        self.errors.push(error);
    }

    /// The output port of a pass that a link means, and the member of it.
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
                    let mut having = (0..outputs.len()).filter_map(|port| Some((port, member_of(port, name)?)));
                    match (having.next(), having.next()) {
                        (Some((port, m)), None) if member.is_none() => return Some((port as u32, Some(m))),
                        (Some(_), Some(_)) => Err(format!("several ports of `{}` have a member `{name}`", target.pass)),
                        _ => return self.unknown_port(node, link, name),
                    }
                }
            }
            None => {
                let exact = |i: &usize| wanted.is_some_and(|wanted| outputs[*i].1 == *wanted);
                let single = |i: &usize| {
                    matches!(&*outputs[*i].1, "Texture" | "Buffer")
                        || self.interface(&outputs[*i].1).is_some_and(|interface| interface.members.len() == 1)
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
                    error = error.note(format!("wanted here: {}", with_article(wanted)));
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
        let error = Diagnostic::new(&codes::UNKNOWN_PORT, format!("`{}` has no output or member `{name}`", pass.name))
            .label(self.span(link.port_place()), "")
            .label(self.span(pass.place), "of this pass")
            .suggest("outputs and members", name, known);
        self.errors.push(error);
        None
    }

    fn unknown_member(&mut self, node: u32, port: usize, link: &Link, member: &str) -> Option<(u32, Option<u32>)> {
        let used = self.uses[node as usize].as_ref()?;
        let pass = &self.nodes[node as usize];
        let (port, interface) = &used.names.outputs[port];
        let message = format!("`{}.{port}`, {}, has no member `{member}`", pass.name, with_article(interface));
        let known: Vec<&str> = self.members(interface).filter(|m| !m.is_empty()).collect();
        let error = Diagnostic::new(&codes::UNKNOWN_PORT, message)
            .label(self.span(link.port_place()), "")
            .label(self.span(pass.place), "of this pass")
            .suggest("members", member, known);
        self.errors.push(error);
        None
    }

    /// Follows every link, as if everything were on, and checks both ends.
    pub(super) fn find_wires(&mut self) {
        self.check_borders();
        for i in 0..self.nodes.len() {
            let decl = &self.nodes[i].decl;
            let mut wires = Vec::with_capacity(decl.links.len());
            if self.uses[i].is_some() {
                for (at, link) in decl.links.iter().enumerate() {
                    wires.extend(self.wire(i, at, link));
                }
                if let Some(feed) = &decl.feed {
                    wires.extend(self.feed(i, feed));
                }
                self.check_off(i, &wires);
            }
            self.wires.push(wires);
        }
    }

    /// Checks the links of parts against the interfaces that the parts declare, and what parts offer.
    fn check_borders(&mut self) {
        for node in self.nodes {
            let Body::Group(group) = &node.decl.body else { continue };
            for input in &group.inputs {
                let known = matches!(&*input.interface.value, "Texture" | "Buffer" | "Any");
                if !known && self.interface(&input.interface.value).is_none() {
                    self.unknown_interface(&input.interface);
                }
            }
            for link in &node.decl.links {
                let Some(input) = group.inputs.iter().find(|i| i.name.value == link.port.value) else {
                    // Only in a flattened file that was edited by hand.
                    let error =
                        Diagnostic::new(&codes::UNKNOWN_INPUT, format!("`{}` has no input `{}`", node.name, link.port.value))
                            .label(self.span(link.port.place), "")
                            .suggest("inputs", &link.port.value, group.inputs.iter().map(|i| &*i.name.value));
                    self.errors.push(error);
                    continue;
                };
                let good = match self.follow(link, Some(&input.interface.value), false) {
                    Found::End(end) => self.fits(&input.interface.value, &end).is_ok() || {
                        let message = format!(
                            "the input `{}` of `{}` takes {}, not {}",
                            input.name.value,
                            node.name,
                            with_article(&input.interface.value),
                            self.offer_text(&end)
                        );
                        let error = Diagnostic::new(&codes::INTERFACE, message)
                            .label(self.span(link.place), format!("`{}`", self.end_text(&end)))
                            .label(self.span(input.interface.place), "declared here")
                            .label(self.span(self.nodes[end.node as usize].place), "offered by this pass");
                        self.errors.push(error);
                        false
                    },
                    Found::Nothing(_) | Found::Unlinked => true,
                    Found::Told => false,
                };
                if !good {
                    self.bad_borders.push(link.place);
                }
            }
            for output in &group.outputs {
                self.follow(&output.link, None, false);
            }
            if let Some(At { value: Off::Input(input), place }) = &node.decl.off
                && self.link_into_group(group, input).is_none()
            {
                self.unknown_off(input, *place, group.inputs.iter().map(|i| i.name.value.clone()).collect());
            }
        }
        for input in &self.resolved.inputs {
            let known = matches!(&*input.interface.value, "Texture" | "Buffer" | "Any");
            if !known && self.interface(&input.interface.value).is_none() {
                self.unknown_interface(&input.interface);
            }
        }
    }

    fn link_into_group<'g>(&self, group: &'g Group, input: &str) -> Option<&'g InputDecl> {
        group.inputs.iter().find(|i| i.name.value == *input)
    }

    fn unknown_interface(&mut self, interface: &At<Name>) {
        let error = Diagnostic::new(&codes::INTERFACE, format!("there is no interface `{}`", interface.value))
            .label(self.span(interface.place), "")
            .suggest("interfaces", &interface.value, self.interfaces.iter().map(|i| i.name));
        self.errors.push(error);
    }

    fn unknown_off(&mut self, input: &str, place: Place, known: Vec<Name>) {
        let error = Diagnostic::new(&codes::OFF, format!("`off:` names an input `{input}` that is not linked"))
            .label(self.span(place), "")
            .suggest("inputs", input, known.iter().map(|name| &**name));
        self.errors.push(error);
    }

    /// `off: Input(…)` must name a linked input that some output can be replaced by.
    fn check_off(&mut self, node: usize, wires: &[Wire<'a>]) {
        let Some(At { value: Off::Input(input), place }) = &self.nodes[node].decl.off else { return };
        let Some(used) = &self.uses[node] else { return };
        let wire = wires.iter().find(|wire| used.names.inputs[wire.input as usize].0 == *input);
        let Some(wire) = wire else {
            let linked = self.nodes[node].decl.links.iter().any(|link| link.port.value == *input);
            if !linked {
                let known = self.nodes[node].decl.links.iter().map(|link| link.port.value.clone()).collect();
                self.unknown_off(input, *place, known);
            }
            return;
        };
        let brought = self.interface_of(&wire.end);
        if wire.end.member.is_some() || used.names.outputs.iter().all(|(_, interface)| *interface != brought) {
            let offers: Vec<String> = used.names.outputs.iter().map(|(p, i)| format!("{p}: {i}")).collect();
            let error = Diagnostic::new(&codes::OFF, format!("no output can be replaced by the input `{input}`"))
                .label(self.span(*place), format!("this input brings {}", self.offer_text(&wire.end)))
                .label(self.span(self.nodes[wire.end.node as usize].place), "from this pass")
                .note(format!("outputs of `{}`: {}", self.nodes[node].name, offers.join(", ")));
            self.errors.push(error);
        }
    }

    fn wire(&mut self, node: usize, at: usize, link: &'a Link) -> Option<Wire<'a>> {
        let names = Arc::clone(&self.uses[node].as_ref()?.names);
        let Some(input) = names.inputs.iter().position(|(port, _)| *port == link.port.value) else {
            if !link.inherited {
                let Body::Pass { kind, .. } = &self.nodes[node].decl.body else { return None };
                let message = format!("the kind `{}` has no input `{}`", kind.value, link.port.value);
                let error = Diagnostic::new(&codes::UNKNOWN_INPUT, message)
                    .label(self.span(link.port.place), "")
                    .suggest("inputs", &link.port.value, names.inputs.iter().map(|(port, _)| &**port));
                self.errors.push(error);
            }
            return None;
        };
        let wanted = &names.inputs[input].1;
        let Found::End(end) = self.follow(link, Some(wanted), false) else { return None };
        if let Err(help) = self.fits(wanted, &end) {
            self.mismatch(node, &names.inputs[input].0, wanted, link, &end, help);
            return None;
        }
        Some(Wire { input: input as u32, end, link: at as u32 })
    }

    fn mismatch(&mut self, node: usize, port: &str, wanted: &Name, link: &Link, end: &End<'_>, help: Option<String>) {
        let producer = &self.nodes[end.node as usize];
        let message = format!(
            "`{}.{port}` takes {}, and `{}` is {}",
            self.nodes[node].name,
            with_article(wanted),
            self.end_text(end),
            self.offer_text(end)
        );
        let offers: Vec<String> = self.uses[end.node as usize].iter().flat_map(|u| &u.names.outputs).map(|(p, i)| format!("{p}: {i}")).collect();
        let mut error = Diagnostic::new(&codes::INTERFACE, message)
            .label(self.span(link.place), format!("{} is wanted here", with_article(wanted)))
            .label(self.span(producer.place), format!("this offers {}", offers.join(", ")));
        if let Some(help) = help {
            error = error.note(help);
        }
        if let Some(note) = self.makers(wanted, node) {
            error = error.note(note);
        }
        self.errors.push(error);
    }

    /// The passes that offer an interface.
    fn makers(&self, wanted: &str, except: usize) -> Option<String> {
        let has = |i: usize| self.uses[i].as_ref().is_some_and(|u| u.names.outputs.iter().any(|(_, o)| *o == *wanted));
        let makers: Vec<&str> =
            (0..self.nodes.len()).filter(|i| *i != except && has(*i)).map(|i| &*self.nodes[i].name).take(8).collect();
        (!makers.is_empty()).then(|| format!("passes that offer {}: {}", with_article(wanted), makers.join(", ")))
    }

    /// Whether an input of the interface `wanted` can take what is at an end; else, what to do.
    fn fits(&self, wanted: &str, end: &End<'_>) -> Result<(), Option<String>> {
        let offered = self.interface_of(end);
        let members = self.interface(&offered).map_or(&[][..], |interface| interface.members);
        match wanted {
            "Any" => Ok(()),
            "Texture" | "Buffer" => {
                let plain = matches!(&*offered, "Texture" | "Buffer");
                if plain && offered != *wanted {
                    return Err(None);
                }
                if plain || end.member.is_some() || members.len() == 1 {
                    // Whether the one resource is a texture or a buffer is seen when its description is.
                    return Ok(());
                }
                let first = members.first().map_or("", |m| m.name);
                let names: Vec<&str> = members.iter().map(|m| m.name).collect();
                let only = self.uses[end.node as usize].as_ref().is_some_and(|u| u.names.outputs.len() == 1);
                let end = if only { self.nodes[end.node as usize].name.to_string() } else { self.end_text(end) };
                Err(Some(format!("it holds {}: name one of them, as in \"{end}.{first}\"", names.join(", "))))
            }
            _ if *offered == *wanted && (end.member.is_none() || members.len() == 1) => Ok(()),
            _ => Err(None),
        }
    }

    /// Joins the link that `Insert` broke to the only required input that takes it.
    fn feed(&mut self, node: usize, feed: &'a Link) -> Option<Wire<'a>> {
        let used = self.uses[node].as_ref()?;
        let (ports, names) = (Arc::clone(&used.ports), Arc::clone(&used.names));
        let decl = &self.nodes[node].decl;
        let free: Vec<usize> = (0..ports.inputs.len())
            .filter(|i| !ports.inputs[*i].optional && decl.link(&ports.inputs[*i].name).is_none())
            .collect();
        let told = self.errors.len();
        let mut fitting = Vec::new();
        for input in &free {
            if let Found::End(end) = self.follow(feed, Some(&names.inputs[*input].1), false)
                && self.fits(&names.inputs[*input].1, &end).is_ok()
            {
                fitting.push((*input, end));
            }
        }
        self.errors.truncate(told);
        if let [(input, end)] = fitting[..] {
            return Some(Wire { input: input as u32, end, link: decl.links.len() as u32 });
        }
        if let Found::End(_) = self.follow(feed, None, false) {
            let inputs: Vec<String> = names.inputs.iter().map(|(port, i)| format!("{port}: {i}")).collect();
            let how = if fitting.is_empty() { "no required input" } else { "more than one required input" };
            let message = format!("{how} of `{}` takes what is fed to it", self.nodes[node].name);
            let error = Diagnostic::new(&codes::AMBIGUOUS, message)
                .label(self.span(self.nodes[node].place), "inserted here")
                .label(self.span(feed.place), "this is fed to it")
                .note(format!("its inputs: {}", inputs.join(", ")));
            self.errors.push(error);
        }
        None
    }

    /// Takes what is off out of the wires, and checks that nothing that is on lacks an input that it needs.
    pub(super) fn find_live_wires(&mut self) {
        let all_on = self.on.iter().all(|on| *on == Some(true));
        for i in 0..self.nodes.len() {
            let mut live = Vec::new();
            if self.uses[i].is_some() && !all_on {
                live.reserve(self.wires[i].len());
                for at in 0..self.wires[i].len() {
                    let wire = self.wires[i][at];
                    if let Some(end) = self.live_end(i, &wire) {
                        live.push(Wire { end, ..wire });
                    }
                }
            }
            if !all_on {
                self.live.push(live);
            }
            if self.on[i] == Some(true) {
                self.check_needs(i);
            }
        }
        self.check_pasts();
    }

    /// A resource has one past, and one thing that stands in its place: all links must say the same of it.
    fn check_pasts(&mut self) {
        let mut known: FxHashMap<(u32, u32), Vec<(Wire<'a>, Place)>> = FxHashMap::default();
        let mut constants: FxHashMap<(u32, u32), (Clear, Place)> = FxHashMap::default();
        let mut errors = Vec::new();
        for i in 0..self.nodes.len() {
            if self.on[i] == Some(false) {
                continue;
            }
            for wire in self.wires_now(i) {
                let place = self.link_of(i, wire).place;
                if let Some(clear) = wire.end.constant {
                    let first = constants.entry((wire.end.node, wire.end.port)).or_insert((clear, place));
                    if first.0 != clear {
                        let message = format!("two things stand in place of `{}`", self.end_text(&wire.end));
                        let error = Diagnostic::new(&codes::OFF, message)
                            .label(self.span(place), "one for this link")
                            .label(self.span(first.1), "another for this one")
                            .note("the pass and the part around it have different `off:`");
                        errors.push(error);
                    }
                }
                let (Some(past), None) = (wire.end.past, wire.end.constant) else { continue };
                let others = known.entry((wire.end.node, wire.end.port)).or_default();
                let meets = |other: &Wire<'_>| {
                    let (a, b) = (other.end.member, wire.end.member);
                    a.is_none() || b.is_none() || a == b
                };
                let differs = |other: &Wire<'_>| other.end.past.is_some_and(|other| other != past);
                if let Some((_, other)) = others.iter().find(|(other, _)| meets(other) && differs(other)) {
                    let message = format!("the past of `{}` is kept in two ways", self.end_text(&wire.end));
                    let error = Diagnostic::new(&codes::PAST, message)
                        .label(self.span(place), "with one `init` and `reset` here")
                        .label(self.span(*other), "and others here")
                        .note("a resource has one past: give both links the same `init` and `reset`");
                    errors.push(error);
                }
                others.push((*wire, place));
            }
        }
        self.errors.extend(errors);
    }

    fn live_end(&mut self, node: usize, wire: &Wire<'a>) -> Option<End<'a>> {
        let link = self.link_of(node, wire);
        let used = self.uses[node].as_ref()?;
        let (ports, names) = (Arc::clone(&used.ports), Arc::clone(&used.names));
        let (port, wanted) = &names.inputs[wire.input as usize];
        match self.follow(link, Some(wanted), true) {
            Found::End(end) => match self.fits(wanted, &end) {
                Ok(()) => Some(end),
                Err(help) => {
                    self.mismatch(node, port, wanted, link, &end, help);
                    None
                }
            },
            Found::Nothing(off) if self.on[node] == Some(true) && !ports.inputs[wire.input as usize].optional => {
                let reader = format!("`{}`, for its input `{port}`,", self.nodes[node].name);
                let error = self.off_read(reader, link.place, off);
                self.errors.push(error);
                None
            }
            Found::Nothing(_) | Found::Unlinked | Found::Told => None,
        }
    }

    /// Something reads a pass that is off and has nothing in its place.
    pub(super) fn off_read(&self, reader: String, place: Place, off: u32) -> Diagnostic {
        // The switch may be that of a part around it.
        let mut at = off as usize;
        while let Some(parent) = self.nodes[at].parent
            && self.on[parent as usize] == Some(false)
        {
            at = parent as usize;
        }
        let (node, switched) = (&self.nodes[off as usize], &self.nodes[at]);
        let (verb, end) = match (switched.decl.removed, &switched.decl.when) {
            (Some(place), _) => ("was removed", place),
            (None, Some(when)) => ("is switched off", when.place),
            (None, None) => ("is off", switched.place),
        };
        let message = format!("{reader} reads `{}`, which {verb}", node.name);
        Diagnostic::new(&codes::OFF_READ, message)
            .label(self.span(place), "read here")
            .label(self.span(end), verb.strip_prefix("was ").or(verb.strip_prefix("is ")).unwrap_or(verb))
            .note(format!("give `{}` an `off:` that says what stands in its place, such as `off: Black`", node.name))
    }

    /// Follows a link again, without telling what was told before.
    fn retrace(&mut self, link: &'a Link) -> Found<'a> {
        let told = self.errors.len();
        let found = self.follow(link, None, false);
        self.errors.truncate(told);
        found
    }

    /// Every input that a pass needs must be linked.
    fn check_needs(&mut self, node: usize) {
        let Some(used) = &self.uses[node] else { return };
        let needed = used.ports.inputs.iter().filter(|input| !input.optional);
        let misspelt = |link: &Link, input: &str| {
            let known = used.ports.inputs.iter().any(|i| *link.port.value == *i.name);
            !known && nearest(&link.port.value, [input]).is_some()
        };
        let decl = &self.nodes[node].decl;
        let mut missing = Vec::new();
        for input in needed {
            let wired = self.wires[node].iter().any(|wire| used.ports.inputs[wire.input as usize].name == input.name);
            if wired {
                continue;
            }
            match decl.links.iter().find(|link| link.port.value == *input.name) {
                // A link whose input is misspelt was told.
                None if decl.feed.is_some() || decl.links.iter().any(|link| misspelt(link, &input.name)) => {}
                None => missing.push((input, None)),
                // A link that leads nowhere was told, unless it leads to a pass that is gone.
                Some(link) => missing.push((input, Some(link))),
            }
        }
        let mut errors = Vec::new();
        let missing: Vec<_> = missing.into_iter().map(|(input, link)| (input.clone(), link)).collect();
        for (input, link) in missing {
            let name = &self.nodes[node].name;
            let error = match link {
                Some(link) => match self.retrace(link) {
                    Found::Nothing(off) => {
                        self.off_read(format!("`{name}`, for its input `{}`,", input.name), link.place, off)
                    }
                    Found::Unlinked => Diagnostic::new(
                        &codes::UNLINKED,
                        format!("`{name}` needs `{}`, which this part may be used without", input.name),
                    )
                    .label(self.span(link.place), "may be unlinked")
                    .note("switch the pass off where it is: when: \"connected(…)\""),
                    Found::End(_) | Found::Told => continue,
                },
                None => {
                    let message = format!("`{name}` needs its input `{}` linked", input.name);
                    let mut error = Diagnostic::new(&codes::UNLINKED, message)
                        .label(self.span(self.nodes[node].place), format!("add in: {{ \"{}\": … }}", input.name))
                        .note(format!("it takes {}: {}", with_article(&input.interface), input.doc));
                    if let Some(makers) = self.makers(&input.interface, node) {
                        error = error.note(makers);
                    }
                    error
                }
            };
            errors.push(error);
        }
        self.errors.extend(errors);
    }
}
