//! Passes, their links, and patches.

use super::form::{
    At, Body, Entry, Formula, HistoryPolicy, Link, Off, OutDecl, PassDecl, Patch, SaidFact, Set, Sub,
};
use super::read::Grammar;
use super::read::out_overrides;
use super::values::positive;
use crate::codes;
use crate::diagnostic::{Diagnostic, Place};
use crate::expression;
use crate::frame::ResetCause;
use crate::reader::{Field, Form, Node};
use crate::resource::Format;
use data_file::Name;
use std::sync::Arc;

const PASS: &[&str] = &["kind", "shader", "in", "set", "out", "history", "when", "off"];
const SUB: &[&str] = &["file", "inputs", "in", "set", "passes", "outputs", "when", "off"];

/// How a link that reads the frame before begins.
const PREV: &str = "prev ";

const INSERT: &str = "`Insert(name: \"pass\", pass: Pass(…), between: (\"a.port\", \"b.port\"))`";
const BETWEEN: &str = "two ports: (\"a.port\", \"b.port\")";

/// A form's name and its fields.
type Shape = (&'static str, &'static [&'static str]);

/// What may stand in `passes`.
const PASS_FORMS: [Shape; 2] = [("Pass", PASS), ("Sub", SUB)];

impl Grammar<'_, '_> {
    pub(super) fn link(&mut self, port: At<Name>, node: &Node) -> Option<Link> {
        match &node.form {
            Form::Struct(Some(name), fields) if name.text == "Prev" => {
                self.old_prev(node, fields);
                None
            }
            Form::Text(text, _) if text.starts_with(PREV) => {
                let target = self.target_of(node, &text[PREV.len()..])?;
                Some(Link { past: true, ..Link::new(port, target, Self::content_end(node)) })
            }
            _ => Some(Link::new(port, self.target(node)?, Self::content_end(node))),
        }
    }

    /// Reports `Prev(…)`, as it was once written, with what to write instead.
    fn old_prev(&mut self, node: &Node, fields: &[Field]) {
        let text = |name: &str| {
            let field = fields.iter().find(|field| field.name.text == name)?;
            Some(&self.source.text[field.value.start as usize..field.value.end as usize])
        };
        let port = text("port").map_or("pass.port", |port| port.trim_matches('"'));
        let policy: Vec<String> =
            ["reset", "rest"].iter().filter_map(|name| Some(format!("{name}: {}", text(name)?))).collect();
        let link = format!("write \"prev {port}\"");
        let help = match &policy[..] {
            [] => link,
            _ => format!("{link}, and at the pass that makes it `history: ({})`", policy.join(", ")),
        };
        let place = self.head(node);
        self.error(&codes::UNKNOWN_FORM, place, "`Prev(…)` is no link any more").notes.push(help);
    }

    /// Reads `history:`.
    fn history(&mut self, node: &Node) -> Option<At<Arc<HistoryPolicy>>> {
        let known = ["reset", "rest"].as_slice();
        let fields = self.fields(node, "`(reset: […], rest: 64)`", &[("history", known)])?;
        let reset = match fields.get("reset") {
            None => ResetCause::DEFAULT.to_vec(),
            Some(Node { form: Form::Word(word), .. }) if word == "All" => ResetCause::NAMED.to_vec(),
            Some(node) => {
                let names = ResetCause::NAMED.map(|cause| format!("`{cause}`")).join(", ");
                let mut causes = Vec::new();
                for item in self.list(node, &format!("`All` or a list of {names}")) {
                    let cause = ResetCause::NAMED
                        .into_iter()
                        .find(|cause| item.form == Form::Word(cause.to_string()));
                    match cause {
                        Some(cause) if !causes.contains(&cause) => causes.push(cause),
                        Some(_) => {}
                        None => self.wrong(item, &format!("one of {names}")),
                    }
                }
                causes.sort_unstable();
                causes
            }
        };
        let rest = match fields.get("rest").map(|node| (node, positive(node))) {
            None => None,
            Some((_, Some(frames))) => Some(frames),
            Some((node, None)) => {
                self.wrong(node, "a number of frames, at least 1");
                return None;
            }
        };
        Some(At { value: Arc::new(HistoryPolicy { reset, rest }), place: self.place(node) })
    }

    /// The entries of `passes`.
    pub(super) fn passes(&mut self, node: &Node) -> Vec<Entry> {
        let entries = self.map(node, "a pass", true).into_iter();
        entries.filter_map(|(name, node)| Some(Entry { name, decl: Arc::new(self.pass(node)?) })).collect()
    }

    fn pass(&mut self, node: &Node) -> Option<PassDecl> {
        let fields = self.fields(node, "`Pass(…)` or `Sub(…)`", &PASS_FORMS)?;
        let body = match fields.form {
            "Pass" => {
                let kind =
                    self.need(&fields, "kind").and_then(|n| self.text_at(n, "the name of a pass type"));
                let shader = fields.get("shader").and_then(|n| self.text_at(n, "the path of a WGSL file"));
                let name = |at: At<String>| At { value: Name::from(at.value), place: at.place };
                kind.map(|kind| Body::Pass { kind: name(kind), shader: shader.map(name) })
            }
            _ => match (fields.get("file"), fields.get("passes")) {
                (None, Some(passes)) => {
                    let inputs = fields.get("inputs").map(|n| self.inputs(n)).unwrap_or_default();
                    let passes = self.passes(passes);
                    let outputs = fields.get("outputs").map(|n| self.outputs(n)).unwrap_or_default();
                    Some(Body::Sub(Sub::Inline { inputs, passes, outputs }))
                }
                _ => {
                    for name in ["inputs", "passes", "outputs"] {
                        if let Some(node) = fields.get(name).filter(|_| fields.get("file").is_some()) {
                            let place = self.head(node);
                            let message = format!("`{name}` is that of the file that `file` names");
                            self.error(&codes::UNKNOWN_FIELD, place, message);
                        }
                    }
                    let file = self.need(&fields, "file");
                    file.and_then(|n| self.text_at(n, "the path of a pipeline file"))
                        .map(|file| Body::Sub(Sub::File(file)))
                }
            },
        };
        let mut links = Vec::new();
        for (port, node) in fields.get("in").map(|n| self.map(n, "an input", false)).unwrap_or_default() {
            links.extend(self.link(port, node));
        }
        let mut set = Vec::new();
        for (name, node) in fields.get("set").map(|n| self.map(n, "a setting", false)).unwrap_or_default() {
            if let Some(value) = self.value(node) {
                set.push(Set {
                    name,
                    value,
                    place: self.place(node),
                    patched: false,
                    foreign: false,
                    instead_of: None,
                });
            }
        }
        let mut outs = Vec::new();
        for (port, node) in fields.get("out").map(|n| self.map(n, "an output", false)).unwrap_or_default() {
            outs.extend(self.out(port, node));
        }
        let when = fields.get("when").and_then(|n| self.when(n));
        let off = fields.get("off").and_then(|n| self.off(n));
        let history = fields.get("history").and_then(|n| self.history(n));
        let link_names = links.iter().map(|link| link.port.value.to_string()).collect();
        let overrides = out_overrides(&outs);
        Some(PassDecl {
            body: body?,
            links,
            link_names,
            set,
            outs,
            overrides,
            when,
            off,
            history,
            feed: None,
            removed: None,
        })
    }

    pub(super) fn when(&mut self, node: &Node) -> Option<Formula> {
        let Form::Text(text, content) = &node.form else {
            self.wrong(node, "a switch as text, such as \"scene.glossy && $bounces > 1\"");
            return None;
        };
        let parsed = expression::parse(text);
        self.expression(node, *content, parsed)
    }

    pub(super) fn off(&mut self, node: &Node) -> Option<At<Off>> {
        let place = self.head(node);
        if let Form::Tuple(Some(name), items) = &node.form
            && name.text == "Input"
        {
            let [item] = &items[..] else {
                self.wrong(node, "`Input(\"port\")`");
                return None;
            };
            let port = self.name(item, "an input", false)?;
            return Some(At { value: Off::Input(port.value), place: port.place });
        }
        match &node.form {
            Form::Text(..) => {
                let target = self.target(node)?;
                let port = At { value: Name::default(), place: target.place };
                let link = Link::new(port, target, Self::content_end(node));
                Some(At { value: Off::Link(link), place })
            }
            _ => {
                self.wrong(node, "`Input(\"port\")` or a link such as \"pass.port\"");
                None
            }
        }
    }

    pub(super) fn out(&mut self, port: At<Name>, node: &Node) -> Option<OutDecl> {
        let known = ["interface", "format", "size", "count", "facts"].as_slice();
        let fields = self.fields(node, "`Out(…)`", &[("Out", known)])?;
        let interface = fields.get("interface").and_then(|n| self.text_at(n, "the name of an interface"));
        let interface = interface.map(|at| At { value: Name::from(at.value), place: at.place });
        let format = fields.get("format").and_then(|n| {
            let name = self.text(n, "a format such as \"rgba16float\"")?;
            let format = Format::from_name(name);
            if format.is_none() {
                let error = Diagnostic::new(&codes::WRONG_TYPE, format!("there is no format {name:?}"))
                    .label(self.span(self.place(n)), "")
                    .suggest("formats", name, Format::ALL.iter().map(|f| f.name()));
                self.errors.push(error);
            }
            format
        });
        let size = fields.get("size").and_then(|n| self.size(n));
        let count = fields.get("count").and_then(|n| {
            let value =
                self.dim(n, "a count: a whole number above zero, or an expression such as \"$lights * 16\"")?;
            Some(At { value, place: self.place(n) })
        });
        let mut facts = Vec::new();
        for (name, node) in fields.get("facts").map(|n| self.map(n, "a fact", false)).unwrap_or_default() {
            let none = matches!(&node.form, Form::Word(word) if word == "None");
            let value = if none { None } else { self.value(node) };
            if none || value.is_some() {
                facts.push(SaidFact { name, value, place: self.place(node) });
            }
        }
        Some(OutDecl { port, interface, format, size, count, facts })
    }

    pub(super) fn patch(&mut self, node: &Node) -> Option<Patch> {
        const EXPECTED: &str = "`Replace(…)`, `Insert(…)`, `Set(…)` or `Remove(…)`";
        match &node.form {
            Form::Tuple(Some(name), items) => match (name.text.as_str(), &items[..]) {
                ("Replace", [name, pass]) => {
                    let name = self.name(name, "a pass", true);
                    let decl = self.pass(pass).map(Arc::new);
                    Some(Patch::Replace { name: name?, decl: decl? })
                }
                ("Set", [path, value]) => {
                    let expected = "\"parameter\", \"pass.setting\" or \"sub-graph/pass.setting\"";
                    let text = self.text(path, expected)?;
                    let place = self.place(path);
                    let path = At { value: Name::from(text), place };
                    Some(Patch::Set { path, value: self.value(value)?, place: self.place(value) })
                }
                ("Remove", [name]) => Some(Patch::Remove { name: self.name(name, "a pass", true)? }),
                ("Replace", _) => self.shape(node, "`Replace(\"pass\", Pass(…))`"),
                ("Set", _) => self.shape(node, "`Set(\"pass.setting\", value)`"),
                ("Remove", _) => self.shape(node, "`Remove(\"pass\")`"),
                ("Insert", _) => self.shape(node, INSERT),
                _ => {
                    let place = Place { file: self.file, start: name.start, end: name.end };
                    let error =
                        Diagnostic::new(&codes::UNKNOWN_FORM, format!("there is no patch `{}`", name.text))
                            .label(self.span(place), "")
                            .suggest("patches", &name.text, ["Replace", "Insert", "Set", "Remove"]);
                    self.errors.push(error);
                    None
                }
            },
            Form::Struct(Some(name), _) if matches!(name.text.as_str(), "Replace" | "Set" | "Remove") => {
                let form = match name.text.as_str() {
                    "Replace" => "`Replace(\"pass\", Pass(…))`",
                    "Set" => "`Set(\"pass.setting\", value)`",
                    _ => "`Remove(\"pass\")`",
                };
                self.shape(node, form)
            }
            Form::Struct(..) => {
                let known = ["name", "pass", "between"].as_slice();
                let fields = self.fields(node, EXPECTED, &[("Insert", known)])?;
                let name = self.need(&fields, "name").and_then(|n| self.name(n, "a pass", true));
                let decl = self.need(&fields, "pass").and_then(|n| self.pass(n)).map(Arc::new);
                let between = self.need(&fields, "between")?;
                let Form::Tuple(None, items) = &between.form else { return self.shape(between, BETWEEN) };
                let [from, to] = &items[..] else { return self.shape(between, BETWEEN) };
                let (from, to) = (self.target(from), self.target(to));
                Some(Patch::Insert { name: name?, decl: decl?, from: from?, to: to? })
            }
            _ => self.shape(node, EXPECTED),
        }
    }

    pub(super) fn shape(&mut self, node: &Node, expected: &str) -> Option<Patch> {
        self.wrong(node, expected);
        None
    }
}
