//! Warns about outputs whose textures are not of the formats of their interfaces.

use super::Resolved;
use crate::codes;
use crate::interface::Interface;
use crate::plan::Plan;
use data_file::{Diagnostic, Severity};

impl Resolved {
    /// Returns a warning for each texture of a plan of this pipeline that a user's shader writes in another format than
    /// that of the interface of the output: readers take it, and it may hold less. Passes of the tree choose formats by
    /// settings that say so.
    pub fn other_formats(&self, plan: &Plan, interfaces: &[Interface]) -> Vec<Diagnostic> {
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
