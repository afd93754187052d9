//! The figures that the passes of a pipeline report.

use super::Resolved;
use crate::plan::values::complete;
use crate::port::PassTypes;

impl Resolved {
    /// Returns the names of all figures: `pass.port.figure`, for each output of a pass whose interface has figures. Passes
    /// that are switched off are among them; those with an error are left out.
    pub fn figures(&self, kinds: &dyn PassTypes) -> Vec<String> {
        let mut found = Vec::new();
        for node in &self.nodes {
            let Some(use_) = node.decl.use_of(&node.decl.link_names) else { continue };
            let Ok(schema) = kinds.settings(use_) else { continue };
            let Some(settings) = complete(&node.decl, &schema) else { continue };
            let Ok(ports) = kinds.ports(use_, &settings) else { continue };
            for port in &ports.outputs {
                let interface =
                    kinds.interfaces().iter().find(|interface| interface.name == port.interface.as_str());
                let figures = interface.into_iter().flat_map(|interface| interface.figures);
                found.extend(figures.map(|figure| format!("{}.{}.{}", node.name, port.name, figure.name)));
            }
        }
        found
    }
}
