//! The files that the names in a study mean.

use super::check::Checker;
use crate::description::At;
use crate::laboratory::Registry;
use data_file::Code;
use data_file::paths::{OUTSIDE, beside, is_from_own_folder, may_name};
use frame_graph::Diagnostic;
use std::path::Path;

impl Checker<'_> {
    /// Returns whether the study may name the file at a path, and reports an error otherwise. What the command line gives has its own
    /// source, whose name is the option.
    pub(super) fn may_name(&mut self, code: &'static Code, path: &At<String>) -> bool {
        let by = &path.span.source.name;
        let meant = located(self.registry, path);
        let inside =
            by.starts_with("--") || may_name(Path::new(by), Path::new(&meant), &self.registry.roots());
        if !inside {
            let message = format!("the file `{}` {OUTSIDE}", path.value);
            self.errors.push(Diagnostic::new(code, message).label(path.span.clone(), "outside"));
        }
        inside
    }

    /// Notes where a name means a file in the folder of the study, and there is another of that name in a root.
    pub(super) fn note_shadowed(&mut self, folder: &str, name: &At<String>) {
        let by = &name.span.source.name;
        let own = self.registry.beside(by, &name.value);
        let Some(own) = own.filter(|_| !by.starts_with("--") && !is_from_own_folder(&name.value)) else {
            return;
        };
        if let Some(other) = self.registry.shadowed(folder, &name.value, &own) {
            self.notes.push(Diagnostic::shadowed(&name.value, &own, &other, name.span.clone()));
        }
    }
}

/// The scene, pipeline or picture that a name means: one in the folder of the file that names it, or else what the name
/// says. What the command line gives has its own source, whose name is the option.
pub(super) fn located(registry: &dyn Registry, name: &At<String>) -> String {
    let by = &name.span.source.name;
    if by.starts_with("--") {
        return name.value.clone();
    }
    let own = registry.beside(by, &name.value);
    let explicit = || beside(by, &name.value).filter(|_| is_from_own_folder(&name.value));
    own.or_else(explicit).unwrap_or_else(|| name.value.clone())
}
