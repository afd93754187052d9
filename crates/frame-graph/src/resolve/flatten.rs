//! Puts parameters in and moves the passes of sub-graphs up into the pipeline.

use super::document::Document;
use super::localise::prefixed;
use super::locate::Located;
use super::{Files, Node, Parameter, Resolved};
use crate::codes;
use crate::description::{
    At, Body, Description, Entry, Group, InputDecl, Link, OutputDecl, PassDecl, Set, SetValue, Sub,
};
use data_file::{Diagnostic, Diagnostics, Misfit, Name, Place, Setting, Source, Sources, Value, nearest};
use rustc_hash::{FxHashMap, FxHashSet};
use std::rc::Rc;
use std::sync::Arc;

/// Deepest nesting of sub-graphs.
const MAX_PARTS: usize = 16;
/// Most passes of a flattened pipeline.
const MAX_PASSES: usize = 65_536;

/// A value for a parameter or a setting, from a patch, from `set:` of a sub-graph, or from outside.
#[derive(Clone, Debug)]
pub(super) struct Assignment {
    /// `parameter`, `pass.setting`, `sub-graph.parameter` or `sub-graph/pass.setting`, seen from the file it is for.
    pub(super) path: String,
    pub(super) path_place: Place,
    pub(super) value: SetValue,
    pub(super) place: Place,
    /// How many borders of sub-graphs lie between the file that says it and the one that it is for.
    pub(super) depth: u32,
}

impl Assignment {
    /// One from outside, written as `path=value` in the file of this index.
    pub(super) fn given(path: &str, value: Value, file: u32) -> Assignment {
        let len = path.len() as u32;
        let written = value.to_string().len() as u32;
        Assignment {
            path: path.to_owned(),
            path_place: Place { file, start: 0, end: len },
            value: SetValue::Value(value),
            place: Place { file, start: len + 1, end: len + 1 + written },
            depth: 0,
        }
    }
}

pub(super) struct Resolver<'a> {
    pub(super) files: &'a dyn Files,
    pub(super) sources: Sources,
    /// The files that were read, by the names of their sources.
    pub(super) loaded: FxHashMap<String, Option<Rc<Description>>>,
    /// What names mean, by the file that holds them.
    pub(super) located: FxHashMap<(u32, String), Located>,
    /// Where the parameters are declared that something uses.
    pub(super) used: FxHashSet<Place>,
    /// What is no error.
    pub(super) notes: Vec<Diagnostic>,
    pub(super) errors: Vec<Diagnostic>,
    pub(super) nodes: Vec<Node>,
    pub(super) part_parameters: Vec<(Name, Vec<Parameter>)>,
    /// The sub-graphs that are being flattened, outermost first.
    pub(super) parts: Vec<String>,
}

/// The parameters that a file's values may name.
pub(super) type Scope = Vec<Parameter>;

impl<'a> Resolver<'a> {
    pub(super) fn new(files: &'a dyn Files, root: Arc<Source>) -> Resolver<'a> {
        Resolver {
            files,
            sources: Sources(vec![root]),
            loaded: FxHashMap::default(),
            located: FxHashMap::default(),
            used: FxHashSet::default(),
            notes: Vec::new(),
            errors: Vec::new(),
            nodes: Vec::new(),
            part_parameters: Vec::new(),
            parts: Vec::new(),
        }
    }

    /// Returns the whole pipeline.
    pub(super) fn pipeline(
        mut self,
        path: &str,
        document: Document,
        given: Vec<Assignment>,
    ) -> Result<Resolved, Diagnostics> {
        self.parts.push(path.to_owned());
        self.nodes.reserve(document.passes.len());
        let (about, paper, inputs) =
            (document.about.clone(), document.paper.clone(), document.inputs.clone());
        let (parameters, outputs) = self.flatten(document, Scope::new(), "", None, given);
        let mut index = FxHashMap::default();
        index.reserve(self.nodes.len());
        for (i, node) in self.nodes.iter().enumerate() {
            if let Some(first) = index.insert(node.name.clone(), i as u32) {
                let first: &Node = &self.nodes[first as usize];
                let error =
                    Diagnostic::new(&codes::DEFINED_TWICE, format!("two passes are named `{}`", node.name))
                        .label(self.sources.span(node.place), "again here")
                        .label(self.sources.span(first.place), "first here");
                self.errors.push(error);
            }
        }
        if !self.errors.is_empty() {
            return Err(Diagnostics::sorted(self.errors));
        }
        let Resolver { sources, nodes, part_parameters, notes, .. } = self;
        Ok(Resolved {
            sources,
            notes,
            about,
            paper,
            parameters,
            part_parameters,
            inputs,
            nodes,
            outputs,
            index,
        })
    }

    /// Flattens a document, whose values may name the parameters in `scope` beside its own, into `self.nodes`; returns
    /// its parameters and its outputs.
    fn flatten(
        &mut self,
        document: Document,
        mut scope: Scope,
        prefix: &str,
        parent: Option<u32>,
        given: Vec<Assignment>,
    ) -> (Scope, Vec<OutputDecl>) {
        let Document { parameters: decls, passes, mut outputs, mut assignments, own, .. } = document;
        assignments.extend(given);
        self.note_set_again(&assignments);
        let set = assignments.iter().filter(|a| own.file == Some(a.path_place.file));
        let set: Vec<At<Name>> =
            set.map(|a| At { value: Name::from(&*a.path), place: a.path_place }).collect();
        for decl in decls {
            let declared = decl.place;
            let place = decl.default.as_ref().map_or(decl.place, |default| default.place);
            let default = decl.default.map(|default| default.value);
            let setting = Setting {
                name: decl.name.value.to_string(),
                ty: decl.ty,
                default: default.clone().unwrap_or_else(|| decl.ty.zero()),
                min: decl.min,
                max: decl.max,
                one_of: decl.one_of.unwrap_or_default(),
                unit: decl.unit.unwrap_or_default(),
                doc: decl.doc.unwrap_or_default(),
                declared: String::new(),
            };
            let value = default.map(|default| self.checked(&setting, default, place, None));
            scope.push(Parameter { setting, value, place, declared, outer: None });
        }
        let mut routed: FxHashMap<usize, Vec<Assignment>> = FxHashMap::default();
        // Parameters first: what a patch gives a pass by `"$name"` is their last value, also where that comes from outside.
        let (of_parameters, of_passes): (Vec<_>, Vec<_>) =
            assignments.into_iter().partition(|assignment| !assignment.path.contains('.'));
        for assignment in of_parameters.into_iter().chain(of_passes) {
            if assignment.depth == 1
                && let SetValue::Parameter(outer, _) = &assignment.value
                && let Some(parameter) = scope.iter_mut().find(|p| p.setting.name == assignment.path)
            {
                parameter.outer = Some(outer.clone());
            }
            self.route(assignment, &mut scope, &passes, &mut routed);
        }
        let scope = scope;
        for (i, Entry { name, decl }) in passes.into_iter().enumerate() {
            if self.nodes.len() >= MAX_PASSES {
                self.too_large(name.place);
                return (scope, Vec::new());
            }
            let assigned = routed.remove(&i).unwrap_or_default();
            let full =
                if prefix.is_empty() { name.value } else { Name::from(format!("{prefix}/{}", name.value)) };
            let decl = self.localise(decl, prefix, &scope);
            if matches!(decl.body, Body::Sub(_)) {
                self.part(full, name.place, decl, &scope, parent, assigned);
                continue;
            }
            let mut decl = decl;
            for Assignment { path, path_place, value, place, depth } in assigned {
                let decl = Arc::make_mut(&mut decl);
                let mut set = Set {
                    name: At { value: Name::from(path), place: path_place },
                    value,
                    place,
                    patched: true,
                    foreign: depth > 0,
                    instead_of: None,
                };
                match decl.set.iter_mut().find(|s| s.name.value == set.name.value) {
                    Some(old) => {
                        set.instead_of = match &old.value {
                            SetValue::Parameter(name, _) if !old.foreign => Some(name.clone()),
                            _ => old.instead_of.take(),
                        };
                        *old = set;
                    }
                    None => decl.set.push(set),
                }
            }
            self.locate_shader(&mut decl);
            self.nodes.push(Node { name: full, place: name.place, parent, decl });
        }
        if !prefix.is_empty() {
            for output in &mut outputs {
                output.link.target = prefixed(&output.link.target, prefix);
            }
        }
        self.note_unused(own.parameters.iter().chain(&set), &scope);
        (scope, outputs)
    }

    fn too_large(&mut self, place: Place) {
        if self.errors.iter().any(|e| e.code == codes::TOO_LARGE.code) {
            return;
        }
        let message = format!("the flattened pipeline has more than {MAX_PASSES} passes");
        let error = Diagnostic::new(&codes::TOO_LARGE, message).label(self.sources.span(place), "");
        self.errors.push(error);
    }

    /// Takes in a sub-graph: its border as a group, then its passes.
    fn part(
        &mut self,
        name: Name,
        place: Place,
        decl: Arc<PassDecl>,
        scope: &Scope,
        parent: Option<u32>,
        assigned: Vec<Assignment>,
    ) {
        let mut decl = Arc::unwrap_or_clone(decl);
        let Body::Sub(sub) = std::mem::replace(&mut decl.body, Body::Removed) else { return };
        let (path, file_place) = match sub {
            Sub::File(At { value: path, place }) => (path, place),
            Sub::Inline { inputs, passes, outputs } => {
                let document = Document { inputs, passes, outputs, ..Document::default() };
                let path = name.to_string();
                self.inside(name, place, decl, document, scope.clone(), (&path, place), parent, assigned);
                return;
            }
        };
        let named = self.located(&path, file_place);
        if self.parts.contains(&named) || self.parts.len() > MAX_PARTS {
            let chain = self.parts.join(" → ");
            let error = if self.parts.contains(&named) {
                Diagnostic::new(&codes::SUB_LOOP, format!("`{path}` contains itself"))
                    .label(self.sources.span(file_place), "this closes the loop")
                    .note(format!("the loop is {chain} → {path}"))
            } else {
                Diagnostic::new(
                    &codes::TOO_LARGE,
                    format!("sub-graphs are nested more than {MAX_PARTS} deep"),
                )
                .label(self.sources.span(file_place), "")
            };
            self.errors.push(error);
            return;
        }
        let Some(description) = self.load(&path, file_place) else { return };
        let document = self.document(&named, &description);
        self.parts.push(named);
        let part = name.clone();
        let parameters =
            self.inside(name, place, decl, document, Scope::new(), (&path, file_place), parent, assigned);
        self.part_parameters.push((part, parameters));
        self.parts.pop();
    }

    /// Takes in the document of a sub-graph, whose path has a place; returns its parameters.
    #[expect(clippy::too_many_arguments, reason = "all that a sub-graph has")]
    fn inside(
        &mut self,
        name: Name,
        place: Place,
        mut decl: PassDecl,
        document: Document,
        scope: Scope,
        (path, file_place): (&str, Place),
        parent: Option<u32>,
        assigned: Vec<Assignment>,
    ) -> Scope {
        self.check_border(&mut decl, &name, path, file_place, &document.inputs);
        let mut given: Vec<Assignment> = std::mem::take(&mut decl.set)
            .into_iter()
            .map(|set| Assignment {
                path: set.name.value.to_string(),
                path_place: set.name.place,
                value: set.value,
                place: set.place,
                depth: 0,
            })
            .collect();
        given.extend(assigned);
        given.iter_mut().for_each(|given| given.depth += 1);
        let group = self.nodes.len() as u32;
        let inputs = document.inputs.clone();
        self.nodes.push(Node { name: name.clone(), place, parent, decl: Arc::new(decl.clone()) });
        let (scope, outputs) = self.flatten(document, scope, &name, Some(group), given);
        decl.body = Body::Group(Group { inputs, outputs });
        self.nodes[group as usize].decl = Arc::new(decl);
        scope
    }

    /// Every link of a sub-graph must have an input there, and every input that is needed a link.
    fn check_border(
        &mut self,
        decl: &mut PassDecl,
        name: &Name,
        path: &str,
        file: Place,
        inputs: &[InputDecl],
    ) {
        if let Some(feed) = decl.feed.take() {
            self.feed(decl, name, feed, inputs);
        }
        let known = |link: &Link| inputs.iter().any(|i| i.name.value == link.port.value);
        decl.links.retain(|link| known(link) || !link.inherited);
        decl.links.iter_mut().for_each(|link| link.inherited = false);
        decl.link_names.retain(|name| decl.links.iter().any(|link| link.port.value == *name));
        for link in decl.links.iter().filter(|link| !known(link)) {
            let error = Diagnostic::new(
                &codes::UNKNOWN_INPUT,
                format!("`{path}` has no input `{}`", link.port.value),
            )
            .label(self.sources.span(link.port.place), "")
            .suggest("inputs", &link.port.value, inputs.iter().map(|i| &*i.name.value));
            self.errors.push(error);
        }
        for input in inputs.iter().filter(|i| decl.link(&i.name.value).is_none()) {
            let name_of = [&*input.name.value];
            if decl.links.iter().any(|link| !known(link) && nearest(&link.port.value, name_of).is_some()) {
                continue;
            }
            let message = format!("`{name}` needs its input `{}` linked", input.name.value);
            let error = Diagnostic::new(&codes::UNLINKED, message)
                .label(self.sources.span(file), format!("add in: {{ \"{}\": … }}", input.name.value))
                .label(
                    self.sources.span(input.name.place),
                    format!("`{}` is expected here", input.interface.value),
                );
            self.errors.push(error);
        }
    }

    /// Joins the link that `Insert` broke to the only input of a sub-graph that must be linked and is not. What inputs take
    /// is compared with what they get where links are followed.
    fn feed(&mut self, decl: &mut PassDecl, name: &Name, feed: Link, inputs: &[InputDecl]) {
        let free = inputs.iter().filter(|i| decl.link(&i.name.value).is_none());
        match *free.collect::<Vec<_>>() {
            [input] => {
                let port = At { value: input.name.value.clone(), place: feed.place };
                decl.push_link(Link { port, ..feed });
            }
            ref free => {
                let how = if free.is_empty() { "no input" } else { "more than one input" };
                let message = format!("{how} of `{name}` is left to take what is fed to it");
                let free: Vec<&str> = free.iter().map(|input| &*input.name.value).collect();
                let mut error = Diagnostic::new(&codes::AMBIGUOUS, message)
                    .label(self.sources.span(feed.place), "this is fed to it");
                if !free.is_empty() {
                    error = error
                        .note(format!("not linked yet: {}; link all but one with `in:`", free.join(", ")));
                }
                self.errors.push(error);
            }
        }
    }

    /// Returns the value as the setting's type; reports where it does not fit, and then returns the default.
    fn checked(&mut self, setting: &Setting, value: Value, place: Place, source: Option<String>) -> Value {
        match setting.check(value) {
            Ok(value) => value,
            Err(Misfit::Type(message) | Misfit::Range(message)) => {
                let error = Diagnostic::new(&codes::PARAMETER, message)
                    .label(self.sources.span(place), source.unwrap_or_default());
                self.errors.push(error);
                setting.default.clone()
            }
        }
    }

    /// Takes an assignment to the parameter, pass or sub-graph that it is for.
    fn route(
        &mut self,
        mut assignment: Assignment,
        scope: &mut Scope,
        passes: &[Entry],
        routed: &mut FxHashMap<usize, Vec<Assignment>>,
    ) {
        // What a file around the sub-graph says was worked out there.
        if assignment.depth == 0 {
            self.put(&mut assignment.value, assignment.place, scope);
        }
        let value = assignment.value.get().cloned();
        let Some((pass, setting)) = assignment.path.rsplit_once('.') else {
            match scope.iter().position(|p| p.setting.name == assignment.path) {
                Some(i) => {
                    // Without a value, it is that of a parameter that has no default itself.
                    if let Some(value) = value {
                        let (setting, source) = (scope[i].setting.clone(), assignment.value.explained());
                        scope[i].value = Some(self.checked(&setting, value, assignment.place, source));
                        scope[i].place = assignment.place;
                    }
                }
                None => {
                    let path = &assignment.path;
                    let error = Diagnostic::new(&codes::PATH, format!("there is no parameter `{path}`"))
                        .label(self.sources.span(assignment.path_place), "")
                        .suggest("parameters", path, scope.iter().map(|p| p.setting.name.as_str()))
                        .note("a setting of a pass is named `pass.setting`");
                    self.errors.push(error);
                }
            }
            return;
        };
        let entry = |name: &str| passes.iter().position(|e| e.name.value == name);
        let inside = || {
            let parts = pass.match_indices('/').map(|(at, _)| at);
            parts.rev().find_map(|at| {
                Some((entry(&pass[..at]).filter(|i| Self::is_sub(&passes[*i]))?, &pass[at + 1..]))
            })
        };
        let (i, path) = if let Some(i) = entry(pass) {
            (i, setting.to_owned())
        } else if let Some((i, rest)) = inside() {
            (i, format!("{rest}.{setting}"))
        } else {
            let error =
                Diagnostic::new(&codes::PATH, format!("there is no pass `{pass}` to set `{setting}` of"))
                    .label(self.sources.span(assignment.path_place), "")
                    .suggest("passes", pass, passes.iter().map(|e| &*e.name.value));
            self.errors.push(error);
            return;
        };
        if matches!(passes[i].decl.body, Body::Removed) {
            let error = Diagnostic::new(&codes::PATH, format!("`{pass}` has no settings"))
                .label(self.sources.span(assignment.path_place), "")
                .label(self.sources.span(passes[i].name.place), "it is no pass any more");
            self.errors.push(error);
            return;
        }
        routed.entry(i).or_default().push(Assignment { path, ..assignment });
    }
}
