//! Checks what links bring, once all resources are described.

use super::sizes::sort;
use super::wires::{End, with_article};
use super::{Described, Linker};
use crate::codes;
use crate::description::OutputDecl;
use data_file::{Diagnostic, Place};

impl Linker<'_> {
    /// `Texture` inputs must get textures, `Buffer` inputs buffers, and members that were left out are missed.
    pub(super) fn check_sorts(&mut self, ports: &[Described]) {
        let mut errors = Vec::new();
        for (output, end) in &self.outputs {
            errors.extend(self.left_out(end, output.link.place, ports));
        }
        for i in 0..self.nodes.len() {
            let Some(used) = &self.uses[i] else { continue };
            if self.on[i] == Some(false) {
                continue;
            }
            for wire in self.wires_now(i) {
                let (input, wanted) = &used.names.inputs[wire.input as usize];
                let loose = matches!(&**wanted, "Texture" | "Buffer");
                if !loose && wire.end.member.is_none() {
                    continue;
                }
                let Some(producer) = &ports[wire.end.node as usize] else { continue };
                let port = &producer[wire.end.port as usize];
                let chosen = self.member(&port.interface, wire.end.member);
                let resource =
                    port.members.iter().find(|(name, _, _)| chosen.is_none_or(|chosen| *name == chosen));
                let from = &self.nodes[wire.end.node as usize];
                let place = self.link_of(i, wire).place;
                match resource {
                    None => errors.extend(self.left_out(&wire.end, place, ports)),
                    Some((_, desc, _)) if loose && sort(desc) != &**wanted => {
                        let (wanted, found) = (wanted.to_lowercase(), sort(desc).to_lowercase());
                        let message = format!(
                            "`{}.{input}` takes a {wanted}, and this is a {found}",
                            self.nodes[i].name
                        );
                        let error = Diagnostic::new(&codes::INTERFACE, message)
                            .label(self.span(place), format!("a {wanted} is expected here"))
                            .label(self.span(from.place), format!("this offers a {found}"));
                        errors.push(error);
                    }
                    Some(_) => {}
                }
            }
        }
        self.errors.extend(errors);
    }

    /// An output whose name says what it holds must hold that, or a texture of which no interface is known.
    pub(super) fn check_output(&mut self, output: &OutputDecl, end: &End) {
        let name = &output.name.value;
        let known = self.interfaces.iter().find(|known| known.outputs.contains(&&**name));
        let Some(known) = known.map(|known| known.name) else { return };
        let found = self.interface_of(end);
        if end.member.is_none() && (found == known || found == "Texture") {
            return;
        }
        let message = format!("the output `{name}` is {}", with_article(known));
        let error = Diagnostic::new(&codes::INTERFACE, message)
            .label(self.span(output.link.place), format!("this is {}", self.offer_text(end)))
            .label(self.span(self.nodes[end.node as usize].place), "from this pass")
            .note("an output of another name may hold it");
        self.errors.push(error);
    }

    /// Reports where a link takes a member that the producer, with its settings, does not make.
    fn left_out(&self, end: &End, place: Place, ports: &[Described]) -> Option<Diagnostic> {
        let port = ports[end.node as usize].as_ref()?.get(end.port as usize)?;
        let member = self.member(&port.interface, end.member)?;
        if port.members.iter().any(|(name, _, _)| *name == member) {
            return None;
        }
        let from = &self.nodes[end.node as usize];
        let names: Vec<&str> = port.members.iter().map(|(n, _, _)| &**n).collect();
        let message = format!("`{}.{}` leaves the member `{member}` out", from.name, port.port);
        let error = Diagnostic::new(&codes::UNKNOWN_PORT, message)
            .label(self.span(place), "read here")
            .label(self.span(from.place), "this pass, with these settings, does not make it")
            .note(format!("it has: {}", names.join(", ")));
        Some(error)
    }
}
