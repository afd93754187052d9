//! Warns about outputs of user's shaders that are less than their interfaces say: textures of another format, and members that
//! are left out.

use super::Resolved;
use crate::codes;
use crate::interface::Interface;
use crate::plan::{Plan, PlannedPass, PlannedPort};
use data_file::{Diagnostic, Severity};

impl Resolved {
    /// Returns a warning for each texture of a plan of this pipeline that a user's shader writes in another format than
    /// that of the interface of the output, and for each optional member that it leaves out of what it was given: readers
    /// take it, and it may hold less. Passes of the tree choose both by settings that say so.
    pub fn against_interfaces(&self, plan: &Plan, interfaces: &[Interface]) -> Vec<Diagnostic> {
        let mut warnings = Vec::new();
        for pass in plan.passes.iter().filter(|pass| pass.shader.is_some()) {
            let Some(node) = self.index.get(&pass.name).map(|index| &self.nodes[*index as usize]) else {
                continue;
            };
            for port in &pass.outputs {
                let Some(interface) = interfaces.iter().find(|known| *port.interface == *known.name) else {
                    continue;
                };
                let out = node.decl.outs.iter().find(|out| out.port.value == port.port);
                let place = out.map_or(node.place, |out| out.port.place);
                warnings.extend(lacks(pass, port, interface).map(|warning| {
                    let label = format!("an output of the interface `{}`", interface.name);
                    warning.label(self.sources.span(place), label)
                }));
                let said = out.and_then(|out| out.format.as_ref());
                for (name, id) in &port.members {
                    let resource = &plan.resources[id.0 as usize];
                    let expected = interface.member(name).and_then(|member| member.content.format());
                    let (Some(texture), Some(expected)) = (resource.desc.texture(), expected) else {
                        continue;
                    };
                    if texture.format == expected {
                        continue;
                    }
                    let (found, expected) = (texture.format.name(), expected.name());
                    let message = format!(
                        "`{}` is `{found}`, and the interface `{}` has `{expected}` there: its readers get what that format holds",
                        resource.name, interface.name
                    );
                    let place = said.map_or(node.place, |said| said.place);
                    let warning = Diagnostic::warning(&codes::OTHER_FORMAT, Severity::Warning, message)
                        .label(self.sources.span(place), format!("expected `{expected}`"));
                    warnings.push(match said {
                        Some(_) => warning.note("without `format:` the output has that of its interface"),
                        None => warning.note("its shader declares the format"),
                    });
                }
            }
        }
        warnings
    }
}

/// Returns a warning for each member of an input that an output of the same interface does not have.
fn lacks(pass: &PlannedPass, port: &PlannedPort, interface: &Interface) -> impl Iterator<Item = Diagnostic> {
    let has = |name: &str| port.members.iter().chain(&port.handed).any(|(known, _)| **known == *name);
    let given = |name: &str| {
        let of_interface = pass.inputs.iter().filter(|input| input.interface == port.interface);
        of_interface
            .filter(|input| input.members.iter().any(|(known, _)| **known == *name))
            .map(|input| &input.port)
            .next()
    };
    let optional =
        interface.members.iter().filter(move |member| port.connected && member.optional && !has(member.name));
    optional.filter_map(move |member| {
        let input = given(member.name)?;
        let message = format!(
            "`{}.{}` has no `{}`, which its input `{input}` has: readers of the output do without it",
            pass.name, port.port, member.name
        );
        let warning = Diagnostic::warning(&codes::LACKS_MEMBER, Severity::Warning, message);
        Some(warning.note(format!("a variable `{}_{}` of the shader is that member", port.port, member.name)))
    })
}
