//! Takes what is off out of the wires, and checks that what is on has all that it needs.

use super::wires::{End, Found, with_article};
use super::{Linker, Wire, Wires};
use crate::codes;
use crate::description::{At, Link, Off};
use data_file::{Diagnostic, nearest};
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
    }

    fn live_end(&mut self, node: usize, wire: &Wire) -> Option<End> {
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
            Found::Nothing(_) | Found::Reported => None,
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
        error.note(format!(
            "give `{}` an `off:` that names its replacement, such as `off: Input(\"…\")`",
            node.name
        ))
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
        let is_fed = |wire: &Wire| {
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
        let missing: Vec<_> = missing.into_iter().map(|(input, link)| (input.clone(), link)).collect();
        for (input, link) in missing {
            let name = &self.nodes[node].name;
            let error = match link {
                Some(link) => match self.silently(|linker| linker.follow(link, None, false)) {
                    Found::Nothing(off) => {
                        self.off_read(format!("`{name}`, for its input `{}`,", input.name), link, off)
                    }
                    Found::End(_) | Found::Reported => continue,
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
        self.errors.extend(errors);
    }
}
