//! What patches that remove passes leave without a source.

use super::{Node, Resolved};
use crate::codes;
use crate::description::{At, Body, Link, Off};
use data_file::{Diagnostic, Diagnostics, Name, Severity};

/// Most sub-graphs and replacements that a link is followed through.
const MAX_HOPS: usize = 64;

impl Resolved {
    /// Returns what is no error, and perhaps not meant: names that could mean two files, and links and outputs that are
    /// lost with a pass that was removed.
    pub fn warnings(&self) -> Diagnostics {
        let removed = self.nodes.iter().filter(|node| matches!(node.decl.body, Body::Removed));
        let lost = removed.filter_map(|node| self.lost_with(node));
        Diagnostics(self.notes.iter().cloned().chain(lost).collect())
    }

    /// Returns a warning about what is lost with a pass; `None` where that is nothing, or no patch removed it.
    fn lost_with(&self, removed: &Node) -> Option<Diagnostic> {
        let place = removed.decl.removed?;
        let is_lost = |link: &Link| self.removed(link).is_some_and(|node| node.name == removed.name);
        let mut labels = Vec::new();
        for node in self.nodes.iter().filter(|node| matches!(node.decl.body, Body::Pass { .. })) {
            for link in node.decl.links.iter().filter(|link| is_lost(link)) {
                let message = format!("`{}` is left without its input `{}`", node.name, link.port.value);
                labels.push((link.place, message));
            }
        }
        let outputs = self.outputs.iter().filter(|output| is_lost(&output.link));
        let mut names = Vec::new();
        for output in outputs {
            names.push(format!("`{}`", output.name.value));
            labels.push((output.link.place, format!("the output `{}` is lost", output.name.value)));
        }
        if labels.is_empty() {
            return None;
        }
        let (severity, lost) = match &names[..] {
            [] => (Severity::Note, "what reads it is left without".to_owned()),
            [name] => (Severity::Warning, format!("the output {name} is lost with it")),
            _ => (Severity::Warning, format!("the outputs {} are lost with it", names.join(", "))),
        };
        let message = format!("`{}` was removed, and nothing stands in its place: {lost}", removed.name);
        let mut warning = Diagnostic::warning(&codes::REMOVED, severity, message)
            .label(self.sources.span(place), "removed");
        for (place, message) in labels {
            warning = warning.label(self.sources.span(place), message);
        }
        Some(warning.note(format!(
            "to keep them, Replace(\"{}\", …), give the pass an `off:`, or let `outputs:` and `in:` name another source",
            removed.name
        )))
    }

    /// Returns the pass at which a link ends where a patch removed it and nothing stands in its place.
    pub(super) fn removed(&self, link: &Link) -> Option<&Node> {
        let node = |name: &str| self.index.get(name).map(|index| &self.nodes[*index as usize]);
        let mut link = link;
        for _ in 0..MAX_HOPS {
            let target = &link.target;
            if let Some(part) = target.pass.strip_suffix("/in") {
                link = node(part)?.decl.link(target.port.as_ref()?)?;
                continue;
            }
            let found = node(&target.pass)?;
            let decl = &found.decl;
            link = match (&decl.body, &decl.off) {
                (Body::Removed, _) => return decl.removed.map(|_| found),
                (_, Some(At { value: off, .. })) if decl.removed.is_some() => match off {
                    // What is fed to an inserted pass has no port yet.
                    Off::Input(port) => decl.link(port).or(decl.feed.as_ref())?,
                    Off::Link(other) => other,
                },
                (Body::Group(group), _) => {
                    let named = |port: &Name| group.outputs.iter().find(|output| output.name.value == *port);
                    let only = || group.outputs.first().filter(|_| group.outputs.len() == 1);
                    &target.port.as_ref().map_or_else(only, named)?.link
                }
                (Body::Pass { .. } | Body::Sub(_), _) => return None,
            };
        }
        None
    }
}
