//! Sub-graphs that are repeated: copies of a sub-graph, each of which may take what the one before it makes.

use super::Node;
use super::document::Document;
use super::flatten::{Assignment, MAX_PASSES, Resolver, Scope};
use crate::codes;
use crate::description::{At, Body, Group, InputDecl, Link, OutputDecl, PassDecl, Repeat, SetValue, Target};
use crate::diagnostic::{Diagnostic, Place};
use crate::value::Value;
use data_file::Name;
use rustc_hash::FxHashSet;
use std::sync::Arc;

/// A sub-graph that is repeated.
pub(super) struct Repeated<'a> {
    pub(super) name: &'a Name,
    pub(super) place: Place,
    /// Index of the node that is the border of all copies.
    pub(super) group: u32,
    /// The links into all copies.
    pub(super) links: &'a [Link],
    pub(super) repeat: &'a Repeat,
}

impl Repeated<'_> {
    /// The name of a copy.
    fn copy(&self, i: u32) -> Name {
        Name::from(format!("{}/{i}", self.name))
    }

    /// What a copy reads: the inputs of the whole, or what is carried from the copy before it.
    fn links(&self, i: u32) -> Vec<Link> {
        let carried = |port: &Name| i > 0 && self.repeat.carry.iter().any(|l| l.port.value == *port);
        let through = self.links.iter().filter(|link| !carried(&link.port.value)).map(|link| {
            let target = At { value: self.input(&link.port.value), place: link.place };
            Link::new(link.port.clone(), target, None)
        });
        let carry = self.repeat.carry.iter().filter(|_| i > 0).map(|link| {
            let pass = self.copy(i - 1);
            Link { target: Target { pass, ..link.target.clone() }, ..link.clone() }
        });
        through.chain(carry).collect()
    }

    /// An input of the whole, as a link names it.
    fn input(&self, port: &Name) -> Target {
        Target { pass: Name::from(format!("{}/in", self.name)), port: Some(port.clone()), member: None }
    }
}

/// The number of the copy that a path begins with, and the rest of it.
fn copy_of(path: &str) -> Option<(u32, &str)> {
    let (number, rest) = path.split_once(['/', '.'])?;
    number.bytes().all(|c| c.is_ascii_digit()).then(|| Some((number.parse().ok()?, rest)))?
}

impl Resolver<'_> {
    /// Flattens a document as often as it is repeated; returns the parameters of the copies, the outputs of the
    /// whole, and the number of copies.
    pub(super) fn copies(
        &mut self,
        whole: &Repeated<'_>,
        document: &Document,
        given: Vec<Assignment>,
    ) -> (Scope, Vec<OutputDecl>, u32) {
        self.check_carry(whole, document);
        let Some(count) = self.count(&whole.repeat.count) else { return (Scope::new(), Vec::new(), 0) };
        let given: Vec<Assignment> =
            given.into_iter().filter(|given| self.is_for(given, whole, count)).collect();
        let mut parameters = None;
        for i in 0..count {
            if self.nodes.len() >= MAX_PASSES {
                self.too_large(whole.repeat.count.place);
                break;
            }
            let of_copy = |given: &Assignment| match copy_of(&given.path) {
                Some((copy, rest)) => {
                    (copy == i).then(|| Assignment { path: rest.to_owned(), ..given.clone() })
                }
                None => Some(given.clone()),
            };
            let index = whole.repeat.index.iter().map(|index| Assignment {
                path: index.value.to_string(),
                path_place: index.place,
                value: SetValue::Value(Value::U32(i)),
                place: index.place,
                depth: 1,
            });
            let given = index.chain(given.iter().filter_map(of_copy)).collect();
            let (name, node) = (whole.copy(i), self.nodes.len());
            let border = |body| PassDecl { body, links: whole.links(i), ..PassDecl::tombstone(None) };
            let (place, parent) = (whole.place, Some(whole.group));
            let decl = Arc::new(border(Body::Removed));
            self.nodes.push(Node { name: name.clone(), place, parent, decl });
            let (scope, outputs) = self.flatten(document.clone(), &name, Some(node as u32), given);
            let group = Group { inputs: document.inputs.clone(), outputs, copies: None };
            self.nodes[node].decl = Arc::new(border(Body::Group(group)));
            parameters.get_or_insert(scope);
        }
        let Some(parameters) = parameters else {
            // What is wrong with the sub-graph is reported, whether there is a copy of it or not.
            let (nodes, parts) = (self.nodes.len(), self.part_parameters.len());
            let given = given.into_iter().filter(|given| copy_of(&given.path).is_none()).collect();
            let (scope, _) = self.flatten(document.clone(), &whole.copy(0), Some(whole.group), given);
            self.nodes.truncate(nodes);
            self.part_parameters.truncate(parts);
            return (scope, self.handed_through(whole, document), 0);
        };
        let last = whole.copy(count - 1);
        let output = |output: &OutputDecl| {
            let port = Some(output.name.value.clone());
            let value = Target { pass: last.clone(), port, member: None };
            let link = Link::new(output.name.clone(), At { value, place: output.link.place }, None);
            OutputDecl { name: output.name.clone(), link }
        };
        (parameters, document.outputs.iter().map(output).collect(), count)
    }

    /// The outputs where there is no copy: what is carried is handed through, and all else leads to a node that
    /// makes nothing.
    fn handed_through(&mut self, whole: &Repeated<'_>, document: &Document) -> Vec<OutputDecl> {
        let nothing = whole.copy(0);
        let mut missed = false;
        let output = |output: &OutputDecl| {
            let carry = &whole.repeat.carry;
            let carried = carry.iter().find(|l| l.target.port.as_ref() == Some(&output.name.value));
            let port = || Some(output.name.value.clone());
            missed |= carried.is_none();
            let value = match carried {
                Some(link) => whole.input(&link.port.value),
                None => Target { pass: nothing.clone(), port: port(), member: None },
            };
            let link = Link::new(output.name.clone(), At { value, place: output.link.place }, None);
            OutputDecl { name: output.name.clone(), link }
        };
        let outputs = document.outputs.iter().map(output).collect();
        if missed {
            let decl = Arc::new(PassDecl::tombstone(None));
            let parent = Some(whole.group);
            self.nodes.push(Node { name: nothing, place: whole.place, parent, decl });
        }
        outputs
    }

    /// How often a sub-graph is repeated; `None`, after reporting an error, where that is no number.
    fn count(&mut self, repeat: &At<SetValue>) -> Option<u32> {
        let value = repeat.value.get()?;
        let count = value.as_u32();
        if count.is_none() {
            let message = format!("a sub-graph is repeated a whole number of times, and {value} is none");
            let told = repeat.value.told().unwrap_or_default();
            let mut error =
                Diagnostic::new(&codes::REPEAT, message).label(self.sources.span(repeat.place), told);
            for (_, _, place) in repeat.value.origins() {
                error = error.label(self.sources.span(place), "given here");
            }
            self.errors.push(error);
        }
        count
    }

    /// Whether there is the copy that an assignment is for; tells where there is none.
    fn is_for(&mut self, given: &Assignment, whole: &Repeated<'_>, count: u32) -> bool {
        let Some((copy, _)) = copy_of(&given.path).filter(|(copy, _)| *copy >= count) else { return true };
        let name = whole.name;
        let copies = match count {
            0 => "there are none".to_owned(),
            1 => format!("there is `{name}/0` alone"),
            _ => format!("they are `{name}/0` to `{name}/{}`", count - 1),
        };
        let error = Diagnostic::new(&codes::PATH, format!("`{name}` has no copy {copy}"))
            .label(self.sources.span(given.path_place), "")
            .label(self.sources.span(whole.repeat.count.place), "repeated here")
            .note(format!("copies are counted from 0: {copies}"));
        self.errors.push(error);
        false
    }

    /// What is carried must be an output of the sub-graph, and go into an input of it.
    fn check_carry(&mut self, whole: &Repeated<'_>, document: &Document) {
        let path = self.parts.last().cloned().unwrap_or_default();
        for link in &whole.repeat.carry {
            let port = &link.port;
            let inputs = || document.inputs.iter().map(|i: &InputDecl| &*i.name.value);
            if !inputs().any(|input| port.value == *input) {
                let error =
                    Diagnostic::new(&codes::REPEAT, format!("`{path}` has no input `{}`", port.value))
                        .label(self.sources.span(port.place), "")
                        .suggest("inputs", &port.value, inputs());
                self.errors.push(error);
            }
            let outputs = || document.outputs.iter().map(|o| &*o.name.value);
            let output = link.target.port.as_ref().map_or("", Name::as_str);
            if !outputs().any(|known| known == output) {
                let error = Diagnostic::new(&codes::REPEAT, format!("`{path}` has no output `{output}`"))
                    .label(self.sources.span(link.place), "")
                    .suggest("outputs", output, outputs());
                self.errors.push(error);
            }
        }
    }
}

/// Drops errors that say of a further copy of a sub-graph what was told of one before it.
pub(crate) fn told_once(mut errors: Vec<Diagnostic>, nodes: &[Node]) -> Vec<Diagnostic> {
    let copied = |node: &&Node| matches!(&node.decl.body, Body::Group(group) if group.copies.is_some());
    let copied: Vec<String> = nodes.iter().filter(copied).map(|node| format!("{}/", node.name)).collect();
    if copied.is_empty() {
        return errors;
    }
    // Copies differ in their numbers, and in numbers that follow from these.
    let plain = |text: &str| text.replace(|c: char| c.is_ascii_digit(), "");
    let mut told = FxHashSet::default();
    errors.retain(|error| {
        let texts = [&error.message].into_iter().chain(error.labels.iter().map(|l| &l.message));
        let texts: Vec<&String> = texts.chain(&error.notes).collect();
        if !texts.iter().any(|text| copied.iter().any(|name| text.contains(name.as_str()))) {
            return true;
        }
        let texts: Vec<String> = texts.into_iter().map(|text| plain(text)).collect();
        let spans = error.labels.iter().map(|l| (l.span.source.name.clone(), l.span.start, l.span.end));
        told.insert((error.code, texts, spans.collect::<Vec<_>>()))
    });
    errors
}
