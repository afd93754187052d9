//! Passes, their links, and patches.

use super::form::{
    At, Body, Formula, Group, Link, Off, OutDecl, PassDecl, Past, Patch, Repeat, SaidFact, Set, Target,
};
use super::read::Grammar;
use super::read::out_overrides;
use super::values::positive;
use crate::codes;
use crate::diagnostic::{Diagnostic, Place};
use crate::expression;
use crate::frame::ResetCause;
use crate::reader::{Fields, Form, Node};
use crate::resource::{Clear, Format};
use data_file::Name;
use std::sync::Arc;

const PASS: &[&str] = &["kind", "shader", "in", "keep", "feed", "set", "out", "when", "off"];
const SUB: &[&str] = &["file", "in", "set", "repeat", "carry", "index", "when", "off"];
const GROUP: &[&str] = &["inputs", "in", "outputs", "when", "off"];

const INSERT: &str = "`Insert(name: \"pass\", pass: Pass(…), between: (\"a.port\", \"b.port\"))`";
const BETWEEN: &str = "two ports: (\"a.port\", \"b.port\")";

/// A form's name and its fields.
type Shape = (&'static str, &'static [&'static str]);

/// What may stand in `passes`; in a patch, a `Group` may not.
pub(super) const PASS_FORMS: [Shape; 3] = [("Pass", PASS), ("Sub", SUB), ("Group", GROUP)];

impl Grammar<'_, '_> {
    pub(super) fn link(&mut self, port: At<Name>, node: &Node) -> Option<Link> {
        let prev = match &node.form {
            Form::Struct(Some(name), _) | Form::Tuple(Some(name), _) => Some(&name.text),
            _ => None,
        };
        if prev.is_none() {
            return Some(Link::new(port, self.target(node)?, Self::content_end(node)));
        }
        let known = ["port", "init", "reset", "rest"].as_slice();
        let expected = "a link or `Prev(port: \"pass.port\")`";
        let fields = self.fields(node, expected, &[("Prev", known)])?;
        let init = fields.get("init").map_or(Some(Clear::Zero), |n| self.clear(n, "Zero", &["Black"]));
        let reset = match fields.get("reset") {
            None => ResetCause::DEFAULT.to_vec(),
            Some(node) => {
                let mut causes = Vec::new();
                for item in
                    self.list(node, "a list of `Resize`, `Cut`, `Scene`, `Reload`, `Setting` and `Moved`")
                {
                    let cause = ResetCause::NAMED
                        .into_iter()
                        .find(|cause| item.form == Form::Word(cause.to_string()));
                    match cause {
                        Some(cause) if !causes.contains(&cause) => causes.push(cause),
                        Some(_) => {}
                        None => self.wrong(item, "`Resize`, `Cut`, `Scene`, `Reload`, `Setting` or `Moved`"),
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
        let node = self.need(&fields, "port")?;
        let link = Link::new(port, self.target(node)?, Self::content_end(node));
        Some(Link { past: Some(Arc::new(Past { init: init?, reset, rest })), ..link })
    }

    pub(super) fn pass(
        &mut self,
        node: &Node,
        forms: &[(&'static str, &[&'static str])],
    ) -> Option<PassDecl> {
        if matches!(&node.form, Form::Word(word) if word == "Removed" && forms.len() == 3) {
            return Some(PassDecl::tombstone(Some(self.place(node))));
        }
        let fields = self.fields(node, "`Pass(…)` or `Sub(…)`", forms)?;
        let body = match fields.form {
            "Pass" => {
                let kind =
                    self.need(&fields, "kind").and_then(|n| self.text_at(n, "the name of a pass type"));
                let shader = fields.get("shader").and_then(|n| self.text_at(n, "the path of a WGSL file"));
                let name = |at: At<String>| At { value: Name::from(at.value), place: at.place };
                kind.map(|kind| Body::Pass { kind: name(kind), shader: shader.map(name) })
            }
            "Sub" => {
                let file =
                    self.need(&fields, "file").and_then(|n| self.text_at(n, "the path of a pipeline file"));
                let repeat = self.repeat(&fields);
                file.map(|file| Body::Sub { file, repeat })
            }
            _ => {
                let inputs = fields.get("inputs").map(|n| self.inputs(n)).unwrap_or_default();
                let outputs = fields.get("outputs").map(|n| self.outputs(n)).unwrap_or_default();
                Some(Body::Group(Group { inputs, outputs, copies: None }))
            }
        };
        let mut links = Vec::new();
        for (port, node) in fields.get("in").map(|n| self.map(n, "an input", false)).unwrap_or_default() {
            links.extend(self.link(port, node));
        }
        for (port, node) in fields.get("keep").map(|n| self.map(n, "an input", false)).unwrap_or_default() {
            if let Some(first) = links.iter().find(|l: &&Link| l.port.value == port.value) {
                let first = first.port.place;
                self.duplicate(&format!("`{}`", port.value), port.place, first);
            } else if let Some(link) = self.link(port, node) {
                links.push(Link { inherited: true, ..link });
            }
        }
        let feed = fields.get("feed").and_then(|n| {
            let target = self.target(n)?;
            let port = At { value: Name::EMPTY, place: target.place };
            Some(Link::new(port, target, Self::content_end(n)))
        });
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
            feed,
            removed: None,
        })
    }

    /// `repeat:`, `carry:` and `index:`.
    fn repeat(&mut self, fields: &Fields<'_>) -> Option<Repeat> {
        let mut carry = Vec::new();
        let carried = fields.get("carry");
        for (input, node) in carried.map(|n| self.map(n, "an input", false)).unwrap_or_default() {
            let Some(output) = self.name(node, "an output", false) else { continue };
            let target = Target { pass: Name::EMPTY, port: Some(output.value), member: None };
            let target = At { value: target, place: output.place };
            carry.push(Link::new(input, target, Self::content_end(node)));
        }
        let index = fields.get("index").and_then(|n| self.name(n, "a parameter of the sub-graph", false));
        let Some(node) = fields.get("repeat") else {
            if let Some(node) = carried {
                let place = self.head(node);
                let error = self.error(&codes::MISSING_FIELD, place, "`carry` needs `repeat`");
                error.notes.push("it says what each copy takes from the one before it".into());
            }
            if let Some(index) = index {
                let error = self.error(&codes::MISSING_FIELD, index.place, "`index` needs `repeat`");
                error.notes.push("it names the parameter that is the number of the copy".into());
            }
            return None;
        };
        let count = At { value: self.value(node)?, place: self.place(node) };
        Some(Repeat { count, carry, index })
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
            Form::Word(word) if word == "Zero" || word == "Black" => {
                Some(At { value: Off::Constant(Clear::Zero), place })
            }
            Form::Tuple(Some(name), _) if name.text == "Color" => {
                let clear = self.clear(node, "Black", &[])?;
                Some(At { value: Off::Constant(clear), place: self.place(node) })
            }
            Form::Text(..) => {
                let target = self.target(node)?;
                let port = At { value: Name::EMPTY, place: target.place };
                let link = Link::new(port, target, Self::content_end(node));
                Some(At { value: Off::Link(link), place })
            }
            _ => {
                self.wrong(node, "`Black`, `Color(r, g, b, a)`, `Input(\"port\")` or \"pass.port\"");
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
        let forms = [("Pass", PASS), ("Sub", SUB)];
        match &node.form {
            Form::Tuple(Some(name), items) => match (name.text.as_str(), &items[..]) {
                ("Replace", [name, pass]) => {
                    let name = self.name(name, "a pass", true);
                    let decl = self.pass(pass, &forms).map(Arc::new);
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
                let decl = self.need(&fields, "pass").and_then(|n| self.pass(n, &forms)).map(Arc::new);
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
