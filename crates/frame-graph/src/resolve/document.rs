//! One document from a chain of files that extend each other: merging and patching.

use super::flatten::{Assignment, Resolver};
use crate::codes;
use crate::description::{
    At, Body, Description, Entry, InputDecl, Link, OutputDecl, ParameterDecl, PassDecl, Patch, Target,
};
use data_file::{Diagnostic, Name, Place, Severity, Source, nearest};
use rustc_hash::FxHashMap;
use std::sync::Arc;

/// Longest chain of `extends`.
const MAX_CHAIN: usize = 16;

/// A file with all that it inherits.
#[derive(Clone, Debug, Default)]
pub(super) struct Document {
    pub(super) about: Option<String>,
    pub(super) paper: Option<String>,
    pub(super) parameters: Vec<ParameterDecl>,
    pub(super) inputs: Vec<InputDecl>,
    pub(super) passes: Vec<Entry>,
    pub(super) outputs: Vec<OutputDecl>,
    /// What `Set` gives, in order.
    pub(super) assignments: Vec<Assignment>,
    /// What the file itself says, and none that it extends.
    pub(super) own: Own,
}

/// The part of a document that is not inherited.
#[derive(Clone, Debug, Default)]
pub(super) struct Own {
    /// Index of the file.
    pub(super) file: Option<u32>,
    /// The parameters that it adds to those that it inherits.
    pub(super) parameters: Vec<At<Name>>,
}

impl Document {
    /// Takes out the values that patches have given to a pass, or to what is inside it.
    fn take_assignments_to(&mut self, pass: &str) -> Vec<Assignment> {
        let is_of_pass = |assignment: &mut Assignment| {
            let rest = assignment.path.strip_prefix(pass);
            rest.is_some_and(|rest| rest.starts_with(['.', '/']))
        };
        self.assignments.extract_if(.., is_of_pass).collect()
    }

    /// Makes what reads a pass read what is fed to it instead.
    fn relink(&mut self, pass: &str, fed: &Target) {
        let of_passes = self.passes.iter_mut().filter(|entry| {
            let decl = &entry.decl;
            decl.links.iter().chain(&decl.feed).any(|link| link.target.pass == pass)
        });
        let of_passes = of_passes.flat_map(|entry| {
            let decl = Arc::make_mut(&mut entry.decl);
            decl.links.iter_mut().chain(&mut decl.feed)
        });
        let links = of_passes.chain(self.outputs.iter_mut().map(|output| &mut output.link));
        for link in links.filter(|link| link.target.pass == pass) {
            link.target = Target { member: link.target.member.clone(), ..fed.clone() };
        }
    }
}

/// Merges entries into those of the same name, and adds the others behind. A file may have thousands of them.
fn overlay<T: Clone>(old: &mut Vec<T>, new: &[T], name: fn(&T) -> &Name, mut merge: impl FnMut(&mut T, &T)) {
    let mut places: FxHashMap<Name, usize> =
        old.iter().enumerate().map(|(place, entry)| (name(entry).clone(), place)).collect();
    for entry in new {
        let place = *places.entry(name(entry).clone()).or_insert(old.len());
        match old.get_mut(place) {
            Some(old) => merge(old, entry),
            None => old.push(entry.clone()),
        }
    }
}

impl Resolver<'_> {
    /// Merges a description with the files that it extends.
    pub(super) fn document(&mut self, path: &str, description: &Description) -> Document {
        let mut document = Document::default();
        let mut chain = vec![path.to_owned()];
        let mut bases = Vec::new();
        let mut extends = description.extends.clone();
        while let Some(At { value: path_of_base, place }) = extends {
            let base = self.located(&path_of_base, place);
            if chain.contains(&base) {
                chain.push(base);
                let error = Diagnostic::new(&codes::EXTENDS_LOOP, format!("`{path}` extends itself"))
                    .label(self.sources.span(place), "this closes the loop")
                    .note(format!("the loop is {}", chain.join(" → ")));
                self.errors.push(error);
                return document;
            }
            if chain.len() > MAX_CHAIN {
                let error = Diagnostic::new(
                    &codes::TOO_LARGE,
                    format!("more than {MAX_CHAIN} files extend each other"),
                )
                .label(self.sources.span(place), "");
                self.errors.push(error);
                return document;
            }
            // Without its base, all that a variant says would be wrong.
            let Some(loaded) = self.load(&path_of_base, place) else { return document };
            extends = loaded.extends.clone();
            chain.push(base);
            bases.push(loaded);
        }
        for base in bases.iter().rev() {
            self.merge(&mut document, base);
        }
        let is_new = |name: &Name| document.parameters.iter().all(|known| known.name.value != *name);
        let new = description.parameters.iter().map(|decl| &decl.name).filter(|name| is_new(&name.value));
        let parameters = new.filter(|_| description.extends.is_some()).cloned().collect();
        self.merge(&mut document, description);
        let is_own = |source: &Arc<Source>| Arc::ptr_eq(source, &description.source);
        document.own =
            Own { file: self.sources.0.iter().position(is_own).map(|index| index as u32), parameters };
        document
    }

    fn merge(&mut self, document: &mut Document, file: &Description) {
        if let Some(about) = &file.about {
            document.about = Some(about.value.clone());
        }
        // What renders otherwise than a paper says is not that paper's.
        document.paper = file.paper.as_ref().map(|paper| paper.value.clone());
        overlay(
            &mut document.parameters,
            &file.parameters,
            |decl| &decl.name.value,
            |old, new| self.merge_parameter(old, new),
        );
        overlay(&mut document.inputs, &file.inputs, |input| &input.name.value, Clone::clone_from);
        if document.passes.is_empty() {
            document.passes.clone_from(&file.passes);
        } else {
            for entry in &file.passes {
                if self.is_free(document, &entry.name, "Replace") {
                    document.passes.push(entry.clone());
                }
            }
        }
        overlay(&mut document.outputs, &file.outputs, |output| &output.name.value, Clone::clone_from);
        for patch in &file.patch {
            self.patch(document, patch);
        }
    }

    fn merge_parameter(&mut self, old: &mut ParameterDecl, new: &ParameterDecl) {
        if old.ty != new.ty {
            let (was, is) = (old.ty.with_article(), new.ty.with_article());
            let message = format!("`{}` is {was} in the file that is extended, not {is}", new.name.value);
            let error = Diagnostic::new(&codes::PARAMETER, message)
                .label(self.sources.span(new.place), "of another type here")
                .label(self.sources.span(old.place), "declared here");
            self.errors.push(error);
            return;
        }
        old.default = new.default.clone().or(old.default.take());
        old.min = new.min.or(old.min);
        old.max = new.max.or(old.max);
        old.one_of = new.one_of.clone().or(old.one_of.take());
        old.unit = new.unit.clone().or(old.unit.take());
        old.doc = new.doc.clone().or(old.doc.take());
    }

    /// Reports where a name is taken.
    fn is_free(&mut self, document: &Document, name: &At<Name>, advice: &str) -> bool {
        let Some(taken) = document.passes.iter().find(|entry| entry.name.value == name.value) else {
            return true;
        };
        let mut error =
            Diagnostic::new(&codes::DEFINED_TWICE, format!("there is a pass `{}` already", name.value))
                .label(self.sources.span(name.place), "taken")
                .label(self.sources.span(taken.name.place), "defined here");
        if advice == "Replace" {
            error =
                error.note(format!("to put another pass in its place: Replace(\"{}\", Pass(…))", name.value));
        }
        self.errors.push(error);
        false
    }

    fn find(&mut self, document: &Document, name: &str, place: Place) -> Option<usize> {
        let found = document.passes.iter().position(|entry| entry.name.value == name);
        if found.is_none() {
            let mut error =
                Diagnostic::new(&codes::PATCH_TARGET, format!("there is no pass `{name}` to patch"))
                    .label(self.sources.span(place), "")
                    .suggest("passes", name, document.passes.iter().map(|entry| &*entry.name.value));
            let part = document.passes.iter().filter(|entry| Self::is_sub(entry)).find(|entry| {
                name.strip_prefix(&*entry.name.value).is_some_and(|rest| rest.starts_with('/'))
            });
            if let Some(Entry { name: part, .. }) = part {
                let part = &part.value;
                error = error.note(format!(
                    "`{part}` is a sub-graph: of it, patches set values and no more; to change its passes, write a \
                     file that extends it, and Replace(\"{part}\", Sub(…))"
                ));
            }
            self.errors.push(error);
        }
        found
    }

    /// Drops the values that patches have given to a pass that is replaced or removed here.
    fn forget_assignments(&mut self, document: &mut Document, name: &At<Name>) {
        for Assignment { path, path_place, .. } in document.take_assignments_to(&name.value) {
            // A variant may well replace what its base sets.
            if path_place.file == name.place.file {
                let message =
                    format!("the value of `{path}` has no effect: `{}` is patched after it", name.value);
                let note = "write the value in `set:` of the new pass, or `Set` after the other patch";
                let warning = Diagnostic::warning(&codes::NO_EFFECT, Severity::Warning, message)
                    .label(self.sources.span(path_place), "")
                    .label(self.sources.span(name.place), "patched here");
                self.notes.push(warning.note(note));
            }
        }
    }

    fn patch(&mut self, document: &mut Document, patch: &Patch) {
        match patch {
            Patch::Replace { name, decl } => {
                let Some(i) = self.find(document, &name.value, name.place) else { return };
                self.forget_assignments(document, name);
                let entry = &mut document.passes[i];
                let mut decl = PassDecl::clone(decl);
                for link in &entry.decl.links {
                    if decl.link(&link.port.value).is_none() {
                        decl.push_link(Link { inherited: true, ..link.clone() });
                    }
                }
                decl.when = decl.when.or_else(|| entry.decl.when.clone());
                decl.off = decl.off.or_else(|| entry.decl.off.clone());
                decl.history = decl.history.or_else(|| entry.decl.history.clone());
                decl.feed = decl.feed.or_else(|| entry.decl.feed.clone());
                *entry = Entry { name: name.clone(), decl: Arc::new(decl) };
            }
            Patch::Remove { name } => {
                let Some(i) = self.find(document, &name.value, name.place) else { return };
                self.forget_assignments(document, name);
                let decl = &mut document.passes[i].decl;
                if decl.off.is_some() {
                    Arc::make_mut(decl).removed = Some(name.place);
                    return;
                }
                let feed = decl.feed.clone();
                *decl = Arc::new(PassDecl { removed: Some(name.place), ..PassDecl::new(Body::Removed) });
                if let Some(feed) = feed {
                    document.relink(&name.value, &feed.target);
                }
            }
            Patch::Set { path, value, place } => {
                document.assignments.push(Assignment {
                    path: path.value.to_string(),
                    path_place: path.place,
                    value: value.clone(),
                    place: *place,
                    depth: 0,
                });
            }
            Patch::Insert { name, decl, from, to } => self.insert(document, name, decl, from, to),
        }
    }

    fn insert(
        &mut self,
        document: &mut Document,
        name: &At<Name>,
        decl: &PassDecl,
        from: &At<Target>,
        to: &At<Target>,
    ) {
        if !self.is_free(document, name, "") {
            return;
        }
        if self.find(document, &from.value.pass, from.place).is_none() {
            return;
        }
        let fits = |link: &Link| {
            let port = from.value.port.is_none()
                || link.target.port.is_none()
                || from.value.port == link.target.port;
            link.target.pass == from.value.pass && port
        };
        let mut position = document.passes.len();
        let reads_output = to.value.pass == "out";
        let link = if reads_output {
            document
                .outputs
                .iter_mut()
                .find(|o| Some(&o.name.value) == to.value.port.as_ref())
                .map(|o| &mut o.link)
        } else {
            let Some(i) = self.find(document, &to.value.pass, to.place) else { return };
            position = i;
            let links = &mut Arc::make_mut(&mut document.passes[i].decl).links;
            match &to.value.port {
                Some(port) => links.iter_mut().find(|link| link.port.value == *port),
                None => links.iter_mut().find(|link| fits(link)),
            }
        };
        match link {
            Some(link) if fits(link) => {
                let mut decl = decl.clone();
                // The past, where the link reads it, is now that of the inserted pass.
                let target = if from.value.port.is_some() { from.value.clone() } else { link.target.clone() };
                let port = At { value: Name::default(), place: link.place };
                // What is wrong with a port that the patch names is wrong there.
                let (place, content_end) = match &from.value.port {
                    Some(_) => (from.place, None),
                    None => (link.place, link.content_end),
                };
                decl.feed = Some(Link { port, target, place, content_end, past: false, ..link.clone() });
                link.target = Target { pass: name.value.clone(), port: None, member: None };
                link.place = name.place;
                link.content_end = None;
                let entry = Entry { name: name.clone(), decl: Arc::new(decl) };
                document.passes.insert(position, entry);
            }
            other => {
                let message = format!("no link joins `{}` to `{}`", from.value, to.value);
                let mut error = Diagnostic::new(&codes::PATCH_LINK, message);
                let to_place = self.sources.span(to.place);
                match other {
                    // It begins at the pass that is named, and at another port of it.
                    Some(link) if link.target.pass == from.value.pass => {
                        let reads = format!("`{}` is linked to `{}`", to.value, link.target);
                        error = error
                            .label(self.sources.span(from.place), reads)
                            .note(format!("did you mean `{}`?", link.target));
                    }
                    Some(link) => {
                        error = error
                            .label(to_place, format!("this is linked to `{}`", link.target))
                            .note(format!("`{}` is linked at {}", to.value, self.sources.span(link.place)));
                    }
                    None => error = error.label(to_place, "nothing is linked here"),
                }
                if reads_output {
                    let names = document.outputs.iter().map(|output| format!("out.{}", output.name.value));
                    let names: Vec<String> = names.collect();
                    if !names.contains(&to.value.to_string()) {
                        error =
                            error.suggest("outputs", &to.value.to_string(), names.iter().map(String::as_str));
                    }
                    error = error.note("`out.NAME` stands for an output of the pipeline");
                } else if let Some(entry) = document.passes.get(position) {
                    let linked = &entry.decl.links;
                    let ports = linked.iter().map(|link| link.port.value.as_str());
                    let near = to.value.port.as_ref().and_then(|port| nearest(port, ports));
                    if let Some(near) =
                        near.filter(|near| to.value.port.as_ref().is_some_and(|port| port != near))
                    {
                        error = error.note(format!("did you mean `{}.{near}`?", to.value.pass));
                    }
                    let links: Vec<String> =
                        linked.iter().map(|l| format!("{} from {}", l.port.value, l.target)).collect();
                    if !links.is_empty() {
                        error = error.note(format!("links of `{}`: {}", to.value.pass, links.join(", ")));
                    }
                }
                self.errors.push(error);
            }
        }
    }

    /// Returns whether a pass of a document is a sub-graph.
    pub(super) fn is_sub(entry: &Entry) -> bool {
        matches!(entry.decl.body, Body::Sub(_))
    }
}
