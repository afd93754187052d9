//! Warns about values that have no effect.

use super::flatten::{Assignment, Resolver, Scope};
use crate::codes;
use crate::description::At;
use data_file::{Diagnostic, Name, Severity, nearest};
use rustc_hash::FxHashMap;

/// The most parameters of a file that are warned about.
const MOST_WARNINGS: usize = 16;

impl Resolver<'_> {
    /// Warns where a file, or the command line, gives a value twice.
    pub(super) fn note_set_again(&mut self, assignments: &[Assignment]) {
        let mut last: FxHashMap<(&str, &str), &Assignment> = FxHashMap::default();
        let mut warnings = Vec::new();
        for assignment in assignments.iter().filter(|assignment| assignment.depth == 0) {
            let (path, file) =
                (&*assignment.path, &*self.sources.0[assignment.path_place.file as usize].name);
            if let Some(before) = last.insert((file, path), assignment) {
                let message = format!("`{path}` is set twice: the first value has no effect");
                let warning = Diagnostic::warning(&codes::NO_EFFECT, Severity::Warning, message)
                    .label(self.sources.span(before.path_place), "no effect")
                    .label(self.sources.span(assignment.path_place), "set again here");
                warnings.push(warning);
            }
        }
        self.notes.extend(warnings);
    }

    /// Warns about those of these parameters of a scope that nothing uses.
    pub(super) fn note_unused<'n>(&mut self, names: impl Iterator<Item = &'n At<Name>>, scope: &Scope) {
        let parameters: FxHashMap<&str, bool> = scope
            .iter()
            .map(|parameter| (&*parameter.setting.name, self.used.contains(&parameter.declared)))
            .collect();
        let unused = names.filter(|name| parameters.get(name.value.as_str()) == Some(&false));
        for At { value: name, place } in unused.take(MOST_WARNINGS) {
            let message = format!("nothing uses the parameter `{name}`: its value has no effect");
            let mut warning = Diagnostic::warning(&codes::NO_EFFECT, Severity::Warning, message)
                .label(self.sources.span(*place), "");
            let others = scope.iter().map(|parameter| &*parameter.setting.name);
            let used = others.filter(|other| parameters[other]);
            if let Some(near) = nearest(name, used) {
                warning = warning.note(format!("did you mean `{near}`?"));
            }
            // A sub-graph may be used several times.
            if !self.notes.contains(&warning) {
                self.notes.push(warning);
            }
        }
    }
}
