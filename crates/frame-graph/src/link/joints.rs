//! Joins both ends of every link, and checks that they fit.

use super::uses::UseOf;
use super::wires::{End, Found, with_article};
use super::{Linker, Wire, Wires};
use crate::codes;
use crate::description::{At, Body, Group, InputDecl, Link, Off};
use data_file::{Diagnostic, Name, Place};
use std::rc::Rc;
use std::sync::Arc;

impl<'a> Linker<'a> {
    /// Follows every link, as if everything were on, and checks both ends.
    pub(super) fn find_wires(&mut self) {
        self.check_borders();
        let uses = Rc::clone(&self.uses);
        for i in 0..self.nodes.len() {
            let decl = &self.nodes[i].decl;
            let mut wires = Wires::new();
            if let Some(used) = &uses[i] {
                for (at, link) in decl.links.iter().enumerate() {
                    wires.extend(self.wire(i, used, at, link));
                }
                if let Some(feed) = &decl.feed {
                    wires.extend(self.feed(i, feed));
                }
                self.check_off(i, &wires);
            }
            self.wires.push(wires);
        }
    }

    /// Checks the links of sub-graphs against the interfaces that the sub-graphs declare, and what sub-graphs offer.
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
                let input = group.inputs.iter().find(|i| i.name.value == link.port.value);
                // Another name was reported when the sub-graph was taken in.
                let Some(input) = input else { continue };
                let good = match self.follow(link, Some(&input.interface.value), false) {
                    Found::End(end) => {
                        self.fits(&input.interface.value, &end).is_ok() || {
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
                                .label(
                                    self.span(self.nodes[end.node as usize].place),
                                    "offered by this pass",
                                );
                            self.errors.push(error);
                            false
                        }
                    }
                    Found::Nothing(_) => true,
                    Found::Reported => false,
                };
                if !good {
                    self.bad_borders.push(link.place);
                }
            }
            for output in &group.outputs {
                self.follow(&output.link, None, false);
            }
            match &node.decl.off {
                Some(At { value: Off::Input(input), place })
                    if self.link_into_group(group, input).is_none() =>
                {
                    let known = group.inputs.iter().map(|i| i.name.value.clone()).collect();
                    self.unknown_off(input, *place, known);
                }
                Some(At { value: Off::Link(link), .. }) => {
                    let outputs = group.outputs.iter();
                    let offers: Option<Vec<(Name, Name)>> =
                        outputs.map(|o| Some((o.name.value.clone(), self.offered(&o.link, None)?))).collect();
                    // An output that is a member takes any texture or any buffer: its readers check it.
                    if let Some(offers) = offers {
                        self.check_off_link(&node.name, link, &offers);
                    }
                }
                _ => {}
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
        let error =
            Diagnostic::new(&codes::INTERFACE, format!("there is no interface `{}`", interface.value))
                .label(self.span(interface.place), "")
                .suggest("interfaces", &interface.value, self.interfaces.iter().map(|i| i.name));
        self.errors.push(error);
    }

    fn unknown_off(&mut self, input: &str, place: Place, known: Vec<Name>) {
        let error =
            Diagnostic::new(&codes::OFF, format!("`off:` names an input `{input}` that is not linked"))
                .label(self.span(place), "")
                .suggest("inputs", input, known.iter().map(|name| &**name));
        self.errors.push(error);
    }

    /// A link of `off:` must lead to what some output can be replaced by.
    fn check_off_link(&mut self, name: &Name, link: &'a Link, offers: &[(Name, Name)]) {
        let count = self.errors.len();
        let mut brought = None;
        for (_, interface) in offers {
            match self.follow(link, Some(interface), false) {
                Found::End(end) if !self.stands_for(interface, &end) => brought = Some(end),
                Found::Reported => {}
                // Where nothing is there, its readers get an error.
                Found::End(_) | Found::Nothing(_) => {
                    self.errors.truncate(count);
                    return;
                }
            }
        }
        let Some(end) = brought else {
            // Reported once, whatever was wanted.
            self.errors.truncate(count + 1);
            return;
        };
        self.errors.truncate(count);
        let offers: Vec<String> = offers.iter().map(|(p, i)| format!("{p}: {i}")).collect();
        let message = format!("no output of `{name}` can be replaced by `{}`", self.end_text(&end));
        let error = Diagnostic::new(&codes::OFF, message)
            .label(self.span(link.place), format!("this is {}", self.offer_text(&end)))
            .label(self.span(self.nodes[end.node as usize].place), "from this pass")
            .note(format!("outputs of `{name}`: {}", offers.join(", ")));
        self.errors.push(error);
    }

    /// What `off:` names must be there, and some output must be replaceable by it.
    fn check_off(&mut self, node: usize, wires: &[Wire]) {
        let Some(used) = &self.uses[node] else { return };
        let (input, place) = match &self.nodes[node].decl.off {
            Some(At { value: Off::Input(input), place }) => (input, place),
            Some(At { value: Off::Link(link), .. }) => {
                let names = Rc::clone(&used.names);
                return self.check_off_link(&self.nodes[node].name, link, &names.outputs);
            }
            _ => return,
        };
        let wire = wires.iter().find(|wire| used.names.inputs[wire.input as usize].0 == *input);
        let Some(wire) = wire else {
            let decl = &self.nodes[node].decl;
            let linked = decl.links.iter().any(|link| link.port.value == *input);
            // Of a pass that a patch removed, another patch may have removed what the input read.
            if !linked && decl.removed.is_none() {
                let known = decl.links.iter().map(|link| link.port.value.clone()).collect();
                self.unknown_off(input, *place, known);
            }
            return;
        };
        let brought = self.interface_of(&wire.end);
        if wire.end.member.is_some() || used.names.outputs.iter().all(|(_, interface)| *interface != brought)
        {
            let offers: Vec<String> = used.names.outputs.iter().map(|(p, i)| format!("{p}: {i}")).collect();
            let error =
                Diagnostic::new(&codes::OFF, format!("no output can be replaced by the input `{input}`"))
                    .label(self.span(*place), format!("this input is {}", self.offer_text(&wire.end)))
                    .label(self.span(self.nodes[wire.end.node as usize].place), "from this pass")
                    .note(format!("outputs of `{}`: {}", self.nodes[node].name, offers.join(", ")));
            self.errors.push(error);
        }
    }

    fn wire(&mut self, node: usize, used: &UseOf, at: usize, link: &'a Link) -> Option<Wire> {
        let names = &used.names;
        let Some(input) = used.linked[at] else {
            if !link.inherited {
                let Body::Pass { kind, .. } = &self.nodes[node].decl.body else { return None };
                let message = format!("the pass type `{}` has no input `{}`", kind.value, link.port.value);
                let error = Diagnostic::new(&codes::UNKNOWN_INPUT, message)
                    .label(self.span(link.port.place), "")
                    .suggest("inputs", &link.port.value, names.inputs.iter().map(|(port, _)| &**port));
                self.errors.push(error);
            }
            return None;
        };
        let (port, wanted) = &names.inputs[input as usize];
        let Found::End(end) = self.follow(link, Some(wanted), false) else { return None };
        if let Err(help) = self.fits(wanted, &end) {
            self.mismatch(node, port, wanted, link, &end, help);
            return None;
        }
        Some(Wire { input, end, link: at as u32 })
    }

    pub(super) fn mismatch(
        &mut self,
        node: usize,
        port: &str,
        wanted: &Name,
        link: &Link,
        end: &End,
        help: Option<String>,
    ) {
        let producer = &self.nodes[end.node as usize];
        let message = format!(
            "`{}.{port}` takes {}, and `{}` is {}",
            self.nodes[node].name,
            with_article(wanted),
            self.end_text(end),
            self.offer_text(end)
        );
        let offers: Vec<String> = self.uses[end.node as usize]
            .iter()
            .flat_map(|u| &u.names.outputs)
            .map(|(p, i)| format!("{p}: {i}"))
            .collect();
        let mut error = Diagnostic::new(&codes::INTERFACE, message)
            .label(self.span(link.place), format!("{} is expected here", with_article(wanted)))
            .label(self.span(producer.place), format!("this offers {}", offers.join(", ")));
        if let Some(help) = help {
            error = error.note(help);
        }
        if let Some(note) = self.makers(wanted, node) {
            error = error.note(note);
        }
        self.errors.push(error);
    }

    /// Returns the passes that offer an interface.
    pub(super) fn makers(&self, wanted: &str, except: usize) -> Option<String> {
        let has = |i: usize| {
            self.uses[i].as_ref().is_some_and(|u| u.names.outputs.iter().any(|(_, o)| *o == *wanted))
        };
        let makers: Vec<&str> = (0..self.nodes.len())
            .filter(|i| *i != except && has(*i))
            .map(|i| &*self.nodes[i].name)
            .take(8)
            .collect();
        (!makers.is_empty())
            .then(|| format!("passes that offer {}: {}", with_article(wanted), makers.join(", ")))
    }

    /// Returns whether an input of the interface `wanted` can take what is at an end; else, what to do.
    pub(super) fn fits(&self, wanted: &Name, end: &End) -> Result<(), Option<String>> {
        let offered = self.interface_of(end);
        if offered == *wanted && end.member.is_none() {
            return Ok(());
        }
        let members = self.interface(&offered).map_or(&[][..], |interface| interface.members);
        match wanted.as_str() {
            "Any" => Ok(()),
            "Texture" | "Buffer" => {
                if matches!(&*offered, "Texture" | "Buffer") {
                    // Of the other sort, or it would have been taken above.
                    return Err(None);
                }
                if end.member.is_some() || members.len() == 1 {
                    // Whether the one resource is a texture or a buffer is seen when its description is.
                    return Ok(());
                }
                let first = members.first().map_or("", |m| m.name);
                let names: Vec<&str> = members.iter().map(|m| m.name).collect();
                let only = self.uses[end.node as usize].as_ref().is_some_and(|u| u.names.outputs.len() == 1);
                let end =
                    if only { self.nodes[end.node as usize].name.to_string() } else { self.end_text(end) };
                Err(Some(format!("it holds {}: name one of them, as in \"{end}.{first}\"", names.join(", "))))
            }
            _ if offered == *wanted && members.len() == 1 => Ok(()),
            _ => Err(None),
        }
    }

    /// Joins the link that `Insert` broke to the only required input that takes it.
    fn feed(&mut self, node: usize, feed: &'a Link) -> Option<Wire> {
        let used = self.uses[node].as_ref()?;
        let (ports, names) = (Arc::clone(&used.ports), Rc::clone(&used.names));
        let decl = &self.nodes[node].decl;
        let free: Vec<usize> = (0..ports.inputs.len())
            .filter(|i| !ports.inputs[*i].optional && decl.link(&ports.inputs[*i].name).is_none())
            .collect();
        let fit = |linker: &mut Self, input: usize| {
            let wanted = &names.inputs[input].1;
            match linker.follow(feed, Some(wanted), false) {
                Found::End(end) if linker.fits(wanted, &end).is_ok() => Some((input, end)),
                _ => None,
            }
        };
        let fitting: Vec<(usize, End)> =
            self.silently(|linker| free.into_iter().filter_map(|input| fit(linker, input)).collect());
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
}
