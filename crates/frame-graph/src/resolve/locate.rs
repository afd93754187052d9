//! Which file a name in a file means.

use super::Files;
use super::flatten::Resolver;
use crate::codes;
use crate::description::{Body, Description, PassDecl, parse_file};
use data_file::paths::{OUTSIDE, beside, is_from_own_folder, may_name};
use data_file::{Diagnostic, Name, Place, Source, why_unreadable};
use std::path::Path;
use std::rc::Rc;
use std::sync::Arc;

/// Returns the file that the file `by` means by a path: one beside it, or else one of a root.
pub fn named(path: &str, by: &str, files: &dyn Files) -> Option<Arc<Source>> {
    let allowed = |meant: &str| may_name(Path::new(by), Path::new(meant), &files.roots());
    let Some(own) = beside(by, path) else { return files.read(path).filter(|_| allowed(path)) };
    let explicit = is_from_own_folder(path);
    match files.at(&own).filter(|source| explicit || source.name != by) {
        Some(source) => Some(source).filter(|source| allowed(&source.name)),
        None => files.read(path).filter(|_| !explicit),
    }
}

/// What a name in a file means.
#[derive(Clone, Debug)]
pub(super) enum Located {
    /// This file, in the folder of the one that names it.
    Beside(String),
    /// What a root has of that name, if anything.
    InRoots,
    /// A file that it may not name, which was reported.
    Outside,
}

impl Resolver<'_> {
    /// Finds what a name at `place` means: a file beside the one that holds the name, or else one of a root. Of a file
    /// beside, `in_roots` returns what else the name could mean.
    fn locate(
        &mut self,
        path: &str,
        place: Place,
        in_roots: impl Fn(&Self) -> Option<Arc<Source>>,
    ) -> Located {
        let key = (place.file, path.to_owned());
        if let Some(known) = self.located.get(&key) {
            return known.clone();
        }
        let span = self.sources.span(place);
        let by = &span.source.name;
        let own = beside(by, path);
        let explicit = own.is_none() || is_from_own_folder(path);
        let there = own.as_deref().and_then(|own| self.files.at(own)).map(|found| found.name.clone());
        let is_own = explicit || there.is_some();
        let meant = there.as_ref().or(own.as_ref()).map_or(path, String::as_str);
        let found = if is_own && !may_name(Path::new(by), Path::new(meant), &self.files.roots()) {
            let message = format!("the file `{path}` {OUTSIDE}");
            self.errors.push(Diagnostic::new(&codes::NO_FILE, message).label(span, "outside"));
            Located::Outside
        } else {
            // A file does not mean itself: a variant may have the name of the built-in pipeline that it extends.
            let own = match there {
                Some(name) if explicit || name != *by => Some(name),
                _ => own.filter(|_| explicit),
            };
            match own {
                Some(own) => {
                    if !explicit && let Some(other) = in_roots(self).filter(|other| other.name != own) {
                        self.notes.push(Diagnostic::shadowed(path, &own, &other.name, span));
                    }
                    Located::Beside(own)
                }
                None => Located::InRoots,
            }
        };
        self.located.insert(key, found.clone());
        found
    }

    /// Returns the name by which a pipeline file is known, that is named at `place`.
    pub(super) fn located(&mut self, path: &str, place: Place) -> String {
        match self.locate(path, place, |resolver| resolver.files.read(path)) {
            Located::Beside(own) => own,
            Located::InRoots => {
                self.files.read(path).map_or_else(|| path.to_owned(), |source| source.name.clone())
            }
            Located::Outside => path.to_owned(),
        }
    }

    /// Reads a pipeline file that is named at `place`, once.
    pub(super) fn load(&mut self, path: &str, place: Place) -> Option<Rc<Description>> {
        let source = match self.locate(path, place, |resolver| resolver.files.read(path)) {
            Located::Outside => return None,
            Located::Beside(own) => self.files.at(&own),
            Located::InRoots => self.files.read(path),
        };
        let Some(source) = source else {
            let span = self.sources.span(place);
            let own = beside(&span.source.name, path).and_then(|own| why_unreadable(Path::new(&own)));
            let error =
                match own {
                    Some(why) => Diagnostic::new(&codes::NO_FILE, format!("`{path}` cannot be read: {why}")),
                    None => {
                        let list = self.files.list();
                        Diagnostic::new(&codes::NO_FILE, format!("there is no pipeline file `{path}`"))
                            .suggest("files", path, list.iter().map(String::as_str))
                    }
                };
            self.errors.push(error.label(span, ""));
            return None;
        };
        if let Some(loaded) = self.loaded.get(&source.name) {
            return loaded.clone();
        }
        let file = self.sources.add(Arc::clone(&source));
        let found = match parse_file(Arc::clone(&source), file) {
            Ok(description) => Some(Rc::new(description)),
            Err(errors) => {
                self.errors.extend(errors.0);
                None
            }
        };
        self.loaded.insert(source.name.clone(), found.clone());
        found
    }

    /// Names the shader of a pass by the path at which it is read.
    pub(super) fn locate_shader(&mut self, decl: &mut Arc<PassDecl>) {
        let Body::Pass { shader: Some(shader), .. } = &decl.body else { return };
        let (path, place) = (shader.value.clone(), shader.place);
        if let Located::Beside(own) = self.locate(&path, place, |resolver| resolver.files.at(&path))
            && *own != *path
            && let Body::Pass { shader: Some(shader), .. } = &mut Arc::make_mut(decl).body
        {
            shader.value = Name::from(own);
        }
    }
}
