//! Takes what is off out of the wires, and checks that what is on has all that it needs.

use super::wires::{End, Found, with_article};
use super::{Linker, Wire, Wires};
use crate::codes;
use crate::description::{At, Body, Group, Link, Off};
use crate::diagnostic::{Diagnostic, Place, nearest};
use crate::resource::Clear;
use data_file::Name;
use rustc_hash::FxHashMap;
use std::rc::Rc;
use std::sync::Arc;

impl<'a> Linker<'a> {
    /// Takes what is off out of the wires, and checks that nothing that is on lacks an input that it needs.
    pub(super) fn find_live_wires(&mut self) {
        let all_on = self.on.iter().all(|on| *on == Some(true));
        for i in 0..self.nodes.len() {
            let mut live = Wires::new();
            if self.uses[i].is_some() && !all_on {
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
                        let message = format!("there are two replacements of `{}`", self.end_text(&wire.end));
                        let error = Diagnostic::new(&codes::OFF, message)
                            .label(self.span(place), "one for this link")
                            .label(self.span(first.1), "another for this one")
                            .note("the pass and the sub-graph around it have different `off:`");
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
                    let message = format!(
                        "two `Prev` links of `{}` differ in `init`, `reset` or `rest`",
                        self.end_text(&wire.end)
                    );
                    let error = Diagnostic::new(&codes::PAST, message)
                        .label(self.span(place), "with these values here")
                        .label(self.span(*other), "and others here")
                        .note(
                            "a resource has one history buffer: give both links the same `init`, `reset` and `rest`",
                        );
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
        let (ports, names) = (Arc::clone(&used.ports), Rc::clone(&used.names));
        let (port, wanted) = &names.inputs[wire.input as usize];
        match self.follow(link, Some(wanted), true) {
            Found::End(end) => match self.fits(wanted, &end) {
                Ok(()) => Some(end),
                Err(help) => {
                    self.mismatch(node, port, wanted, link, &end, help);
                    None
                }
            },
            Found::Nothing(off)
                if self.on[node] == Some(true) && !ports.inputs[wire.input as usize].optional =>
            {
                let reader = format!("`{}`, for its input `{port}`,", self.nodes[node].name);
                let error = self.off_read(reader, link, off);
                self.errors.push(error);
                None
            }
            Found::Unlinked if self.on[node] == Some(true) && !ports.inputs[wire.input as usize].optional => {
                let message = format!(
                    "`{}` needs `{port}`, and the replacement of `{}` is an input that is not linked",
                    self.nodes[node].name, self.nodes[wire.end.node as usize].name
                );
                let error = Diagnostic::new(&codes::UNLINKED, message)
                    .label(self.span(link.place), "read here")
                    .label(self.span(self.nodes[wire.end.node as usize].place), "off");
                self.errors.push(error);
                None
            }
            Found::Nothing(_) | Found::Unlinked | Found::Told => None,
        }
    }

    /// Something reads a pass that is off and has nothing in its place.
    pub(super) fn off_read(&self, reader: String, link: &Link, off: u32) -> Diagnostic {
        // The switch may be that of a sub-graph around it.
        let mut at = off as usize;
        while let Some(parent) = self.nodes[at].parent
            && self.on[parent as usize] == Some(false)
        {
            at = parent as usize;
        }
        let (node, switched) = (&self.nodes[off as usize], &self.nodes[at]);
        if let Some((part, place)) = self.without_copy(off) {
            let message =
                format!("{reader} reads an output of `{part}` that is not carried, and there is no copy");
            return Diagnostic::new(&codes::REPEAT, message)
                .label(self.span(link.place), "read here")
                .label(self.span(place), "repeated 0 times")
                .note("`carry` hands an input through where there is no copy");
        }
        let (verb, end) = match (switched.decl.removed, &switched.decl.when) {
            (Some(place), _) => ("was removed", place),
            (None, Some(when)) => ("is switched off", when.text.place),
            (None, None) => ("is off", switched.place),
        };
        let message = format!("{reader} reads `{}`, which {verb}", node.name);
        let mut error = Diagnostic::new(&codes::OFF_READ, message)
            .label(self.span(link.place), "read here")
            .label(self.span(end), verb.strip_prefix("was ").or(verb.strip_prefix("is ")).unwrap_or(verb));
        // What is read may be another pass, whose `off:` leads here.
        let read = self.resolved.index.get(&link.target.pass).map(|i| &self.nodes[*i as usize]);
        if let Some(read) = read
            && read.name != node.name
            && let Some(At { value: Off::Link(_), place }) = &read.decl.off
        {
            error = error.label(self.span(*place), format!("in place of `{}`, which is off", read.name));
        }
        error.note(format!("give `{}` an `off:` that names its replacement, such as `off: Black`", node.name))
    }

    /// The sub-graph that has no copy, and where that is said, if a node stands for what a copy would make.
    pub(super) fn without_copy(&self, node: u32) -> Option<(&'a Name, Place)> {
        let node = &self.nodes[node as usize];
        let part = node.parent.filter(|_| matches!(node.decl.body, Body::Removed))?;
        let part = &self.nodes[part as usize];
        match &part.decl.body {
            Body::Group(Group { copies: Some((0, place)), .. }) => Some((&part.name, *place)),
            _ => None,
        }
    }

    /// Follows a link again, without reporting the same errors twice.
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
        // A link that an insertion broke leads to one input, which `in:` does not name; or that was reported.
        let is_fed = |wire: &Wire<'_>| {
            let input = &used.ports.inputs[wire.input as usize];
            decl.links.iter().all(|link| *link.port.value != *input.name)
        };
        let unfed = decl.feed.is_some() && !self.wires[node].iter().any(is_fed);
        let mut missing = Vec::new();
        for input in needed {
            let wired =
                self.wires[node].iter().any(|wire| used.ports.inputs[wire.input as usize].name == input.name);
            if wired {
                continue;
            }
            match decl.links.iter().find(|link| link.port.value == *input.name) {
                // A link whose input is misspelt was reported.
                None if unfed || decl.links.iter().any(|link| misspelt(link, &input.name)) => {}
                None => missing.push((input, None)),
                // A link that leads nowhere was reported, unless it leads to a pass that is gone.
                Some(link) => missing.push((input, Some(link))),
            }
        }
        let mut errors = Vec::new();
        // Of a sub-graph without a copy, an optional input may not read what only a copy makes either.
        let needed = |port: &Name| missing.iter().any(|(input, _)| *port == *input.name);
        let optional = decl.links.iter().filter(|link| self.copyless && !needed(&link.port.value));
        let optional: Vec<&Link> = optional.collect();
        let missing: Vec<_> = missing.into_iter().map(|(input, link)| (input.clone(), link)).collect();
        for (input, link) in missing {
            let name = &self.nodes[node].name;
            let error = match link {
                Some(link) => match self.retrace(link) {
                    Found::Nothing(off) => {
                        self.off_read(format!("`{name}`, for its input `{}`,", input.name), link, off)
                    }
                    Found::Unlinked => Diagnostic::new(
                        &codes::UNLINKED,
                        format!("`{name}` needs `{}`, which this sub-graph may be used without", input.name),
                    )
                    .label(self.span(link.place), "may be unlinked")
                    .note("switch the pass off where it is: when: \"connected(…)\""),
                    Found::End(_) | Found::Told => continue,
                },
                None => {
                    let message = format!("`{name}` needs its input `{}` linked", input.name);
                    let mut error = Diagnostic::new(&codes::UNLINKED, message)
                        .label(
                            self.span(self.nodes[node].place),
                            format!("add in: {{ \"{}\": … }}", input.name),
                        )
                        .note(format!("it takes {}: {}", with_article(&input.interface), input.doc));
                    if let Some(makers) = self.makers(&input.interface, node) {
                        error = error.note(makers);
                    }
                    error
                }
            };
            errors.push(error);
        }
        for link in optional {
            if let Found::Nothing(off) = self.retrace(link)
                && self.without_copy(off).is_some()
            {
                let reader = format!("`{}`, for its input `{}`,", self.nodes[node].name, link.port.value);
                errors.push(self.off_read(reader, link, off));
            }
        }
        self.errors.extend(errors);
    }
}
