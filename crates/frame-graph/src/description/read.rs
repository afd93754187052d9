//! From the tree of a file to a description: the grammar.

use super::Description;
use super::form::{At, Dim, Entry, InputDecl, Link, OutDecl, OutputDecl, ParameterDecl, SetValue, is_name};
use super::passes::PASS_FORMS;
use crate::codes::{self, Code};
use crate::diagnostic::{Diagnostic, Diagnostics, Place, Source, Span};
use crate::name::Name;
use crate::port::OutputOverride;
use crate::reader::{self, Form, Node, Number};
use crate::value::{Value, ValueType};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Reads a file whose places carry the index `file`.
pub(crate) fn parse_file(source: Arc<Source>, file: u32) -> Result<Description, Diagnostics> {
    let mut reader = Reader { source: &source, file, errors: Vec::new() };
    if source.text.len() >= u32::MAX as usize {
        reader.error(&codes::SYNTAX, Place { file, start: 0, end: 0 }, "the file is larger than 4 GiB");
        return Err(Diagnostics::sorted(reader.errors));
    }
    let (tree, complaints) = reader::read(&source.text);
    let broken = !complaints.syntax.is_empty() || complaints.depth.is_some();
    for (i, (start, end, message)) in complaints.syntax.into_iter().enumerate() {
        let opened = complaints.opened.iter().find(|(number, _)| *number == i + 1);
        let opened = opened.map(|(_, at)| reader.span(Place { file, start: *at, end: at + 1 }));
        let error = reader.error(&codes::SYNTAX, Place { file, start, end }, message);
        if let Some(opened) = opened {
            *error = error.clone().label(opened, "opened here");
        }
    }
    if let Some((start, end)) = complaints.depth {
        reader.error(&codes::NESTING, Place { file, start, end }, "values are nested too deeply here");
    }
    let description = reader.pipeline(&tree);
    if broken {
        // What is missing may stand in what could not be read.
        let line = |e: &Diagnostic| e.labels[0].span.line_column().0;
        let lines: Vec<usize> =
            reader.errors.iter().filter(|e| e.code == codes::SYNTAX.code).map(line).collect();
        reader.errors.retain(|e| {
            let shape = e.code == codes::WRONG_TYPE.code && lines.contains(&line(e));
            e.code != codes::MISSING_FIELD.code && !shape
        });
    }
    if complaints.depth.is_some() {
        reader.errors.retain(|e| e.code == codes::NESTING.code || e.code == codes::SYNTAX.code);
    }
    match description {
        Some(description) if reader.errors.is_empty() => Ok(description),
        _ => Err(Diagnostics::sorted(reader.errors)),
    }
}

pub(super) struct Reader<'a> {
    pub(super) source: &'a Arc<Source>,
    pub(super) file: u32,
    pub(super) errors: Vec<Diagnostic>,
}

/// The named fields of a form, known to be among those that it has.
pub(super) struct Fields<'a> {
    pub(super) form: &'static str,
    pub(super) place: Place,
    fields: Vec<(&'a str, &'a Node)>,
}

impl<'a> Fields<'a> {
    pub(super) fn get(&self, name: &str) -> Option<&'a Node> {
        self.fields.iter().find(|(n, _)| *n == name).map(|(_, node)| *node)
    }
}

const PARAMETER: &[&str] = &["default", "min", "max", "one_of", "unit", "doc"];

impl Reader<'_> {
    pub(super) fn place(&self, node: &Node) -> Place {
        Place { file: self.file, start: node.start, end: node.end }
    }

    /// The first line of a value, for pointing at long ones.
    pub(super) fn head(&self, node: &Node) -> Place {
        let place = self.place(node);
        let text = &self.source.text[place.start as usize..place.end as usize];
        let len = match &node.form {
            Form::Struct(Some(name), _) | Form::Tuple(Some(name), _) => (name.end - name.start) as usize,
            _ => text.find('\n').unwrap_or(text.len()),
        };
        place.part(0, len)
    }

    pub(super) fn span(&self, place: Place) -> Span {
        Span { source: Arc::clone(self.source), start: place.start, end: place.end }
    }

    pub(super) fn error(
        &mut self,
        code: &'static Code,
        place: Place,
        message: impl Into<String>,
    ) -> &mut Diagnostic {
        self.errors.push(Diagnostic::new(code, message).label(self.span(place), ""));
        self.errors.last_mut().expect("just pushed")
    }

    pub(super) fn wrong(&mut self, node: &Node, expected: &str) {
        if node.form == Form::Bad {
            return;
        }
        let found = match &node.form {
            Form::Bool(b) => format!("`{b}`"),
            Form::Number(Number::Integer(n)) => format!("the number {n}"),
            Form::Number(Number::Float(x)) => format!("the number {x:?}"),
            Form::Char(_) => "a character".to_owned(),
            Form::Text(text, _) => format!("the text {text:?}"),
            Form::Bytes(_) => "bytes".to_owned(),
            Form::Word(word) => format!("`{word}`"),
            Form::Struct(Some(name), _) | Form::Tuple(Some(name), _) => format!("`{}(…)`", name.text),
            Form::Struct(None, _) | Form::Tuple(None, _) => "`(…)`".to_owned(),
            Form::List(_) => "a list".to_owned(),
            Form::Map(_) => "a map".to_owned(),
            Form::Bad => return,
        };
        let place = self.head(node);
        self.error(&codes::WRONG_TYPE, place, format!("expected {expected}, found {found}"));
    }

    /// The fields of a form with one of the names in `forms`; a form without a name is taken too if there is
    /// only one.
    pub(super) fn fields<'n>(
        &mut self,
        node: &'n Node,
        expected: &str,
        forms: &[(&'static str, &[&'static str])],
    ) -> Option<Fields<'n>> {
        let (name, fields): (_, &[reader::Field]) = match &node.form {
            Form::Struct(name, fields) => (name.as_ref(), fields),
            Form::Tuple(name, items) if items.is_empty() => (name.as_ref(), &[]),
            _ => {
                self.wrong(node, expected);
                return None;
            }
        };
        let form = match name {
            None if forms.len() == 1 => forms[0],
            None => {
                self.wrong(node, expected);
                return None;
            }
            Some(name) => match forms.iter().find(|(form, _)| *form == name.text) {
                Some(form) => *form,
                None => {
                    let place = Place { file: self.file, start: name.start, end: name.end };
                    let message = format!("`{}` is not known here: expected {expected}", name.text);
                    let error = Diagnostic::new(&codes::UNKNOWN_FORM, message)
                        .label(self.span(place), "")
                        .suggest("forms", &name.text, forms.iter().map(|(form, _)| *form));
                    self.errors.push(error);
                    return None;
                }
            },
        };
        let mut found: Vec<(&str, &Node)> = Vec::with_capacity(fields.len());
        for field in fields {
            let place = Place { file: self.file, start: field.name.start, end: field.name.end };
            if !form.1.contains(&field.name.text.as_str()) {
                let error = Diagnostic::new(
                    &codes::UNKNOWN_FIELD,
                    format!("`{}` has no field `{}`", form.0, field.name.text),
                )
                .label(self.span(place), "")
                .suggest("fields", &field.name.text, form.1.iter().copied());
                self.errors.push(error);
            } else if let Some(first) =
                fields.iter().find(|f| f.name.text == field.name.text && f.name.start < place.start)
            {
                let first = Place { file: self.file, start: first.name.start, end: first.name.end };
                self.duplicate(&format!("field `{}`", field.name.text), place, first);
            } else {
                found.push((&field.name.text, &field.value));
            }
        }
        Some(Fields { form: form.0, place: self.head(node), fields: found })
    }

    pub(super) fn duplicate(&mut self, what: &str, place: Place, first: Place) {
        let first = self.span(first);
        let error = self.error(&codes::DUPLICATE, place, format!("{what} is given twice"));
        error.labels[0].message = "again here".into();
        *error = error.clone().label(first, "first here");
    }

    pub(super) fn need<'n>(&mut self, fields: &Fields<'n>, name: &str) -> Option<&'n Node> {
        let found = fields.get(name);
        if found.is_none() {
            let message = format!("`{}` needs a field `{name}`", fields.form);
            self.error(&codes::MISSING_FIELD, fields.place, message);
        }
        found
    }

    pub(super) fn text<'n>(&mut self, node: &'n Node, expected: &str) -> Option<&'n str> {
        if let Form::Text(text, _) = &node.form {
            return Some(text);
        }
        self.wrong(node, expected);
        None
    }

    pub(super) fn text_at(&mut self, node: &Node, expected: &str) -> Option<At<String>> {
        Some(At { value: self.text(node, expected)?.to_owned(), place: self.place(node) })
    }

    /// A name; with `path`, also one of several parts joined by `/`.
    pub(super) fn name(&mut self, node: &Node, what: &str, path: bool) -> Option<At<Name>> {
        let text = self.text(node, &format!("the name of {what}"))?;
        let place = self.place(node);
        let good = if path { text.split('/').all(is_name) } else { is_name(text) };
        if !good {
            let error = self.error(&codes::BAD_NAME, place, format!("{text:?} cannot be the name of {what}"));
            error.notes.push("names are made of letters, digits, `-` and `_`".into());
            return None;
        }
        if path && matches!(text.rsplit('/').next(), Some("in" | "out")) {
            self.error(
                &codes::BAD_NAME,
                place,
                format!("`{text}` is kept for the inputs and outputs of a file"),
            );
            return None;
        }
        Some(At { value: Name::from(text), place })
    }

    /// The entries of a map with names for keys, each name once.
    pub(super) fn map<'n>(&mut self, node: &'n Node, what: &str, path: bool) -> Vec<(At<Name>, &'n Node)> {
        let Form::Map(entries) = &node.form else {
            self.wrong(node, &format!("a map: {{ \"name\": … }}, with {what} for each name"));
            return Vec::new();
        };
        let mut seen: rustc_hash::FxHashMap<Name, Place> = rustc_hash::FxHashMap::default();
        let mut out = Vec::with_capacity(entries.len());
        for (key, value) in entries {
            let Some(name) = self.name(key, what, path) else { continue };
            if let Some(first) = seen.get(&name.value) {
                self.duplicate(&format!("`{}`", name.value), name.place, *first);
                continue;
            }
            seen.insert(name.value.clone(), name.place);
            out.push((name, value));
        }
        out
    }

    pub(super) fn list<'n>(&mut self, node: &'n Node, expected: &str) -> &'n [Node] {
        if let Form::List(items) = &node.form {
            return items;
        }
        self.wrong(node, expected);
        &[]
    }

    pub(super) fn pipeline(&mut self, node: &Node) -> Option<Description> {
        let known =
            ["about", "paper", "extends", "parameters", "inputs", "passes", "outputs", "patch"].as_slice();
        let fields = self.fields(node, "`Pipeline(…)`", &[("Pipeline", known)])?;
        let mut text = |name: &str| fields.get(name).and_then(|n| self.text_at(n, "text"));
        let (about, paper, extends) = (text("about"), text("paper"), text("extends"));
        let mut parameters = Vec::new();
        for (name, node) in
            fields.get("parameters").map(|n| self.map(n, "a parameter", false)).unwrap_or_default()
        {
            parameters.extend(self.parameter(name, node));
        }
        let inputs = fields.get("inputs").map(|n| self.inputs(n)).unwrap_or_default();
        let mut passes = Vec::new();
        for (name, node) in fields.get("passes").map(|n| self.map(n, "a pass", true)).unwrap_or_default() {
            if let Some(decl) = self.pass(node, &PASS_FORMS) {
                passes.push(Entry { name, decl: Arc::new(decl) });
            }
        }
        let outputs = fields.get("outputs").map(|n| self.outputs(n)).unwrap_or_default();
        let mut patch = Vec::new();
        if let Some(node) = fields.get("patch") {
            if extends.is_none() {
                let place = self.head(node);
                let error = self.error(&codes::MISSING_FIELD, place, "`patch` needs a file to patch");
                error.notes.push("add `extends: \"…\"`, or write the passes out".into());
            }
            for item in self.list(node, "a list of patches") {
                patch.extend(self.patch(item));
            }
        }
        if extends.is_none() && fields.get("passes").is_none() {
            self.need(&fields, "passes");
        }
        let source = Arc::clone(self.source);
        Some(Description { source, about, paper, extends, parameters, inputs, passes, outputs, patch })
    }

    pub(super) fn parameter(&mut self, name: At<Name>, node: &Node) -> Option<ParameterDecl> {
        let forms = ["U32", "I32", "F32", "Bool", "Text"].map(|form| (form, PARAMETER));
        let fields = self.fields(node, "`U32(…)`, `I32(…)`, `F32(…)`, `Bool(…)` or `Text(…)`", &forms)?;
        let ty = match fields.form {
            "U32" => ValueType::U32,
            "I32" => ValueType::I32,
            "F32" => ValueType::F32,
            "Bool" => ValueType::Bool,
            _ => ValueType::Text,
        };
        let value = |reader: &mut Self, node: &Node| -> Option<At<Value>> {
            let SetValue::Value(value) = reader.value(node)? else {
                reader.wrong(node, &format!("a value of type {ty}"));
                return None;
            };
            match value.clone().convert(ty) {
                Some(value) => Some(At { value, place: reader.place(node) }),
                None => {
                    let place = reader.place(node);
                    let message = format!("`{}` is {}, and {value} is not", name.value, ty.with_article());
                    reader.error(&codes::PARAMETER, place, message);
                    None
                }
            }
        };
        let default = fields.get("default").and_then(|n| value(self, n));
        let mut bound = |field: &str| {
            let node = fields.get(field)?;
            match &node.form {
                Form::Number(Number::Integer(n)) => Some(*n as f64),
                Form::Number(Number::Float(x)) if x.is_finite() => Some(*x),
                _ => {
                    self.wrong(node, "a number");
                    None
                }
            }
        };
        let (min, max) = (bound("min"), bound("max"));
        let one_of = fields.get("one_of").map(|n| {
            let items = self.list(n, "a list of values");
            items.iter().filter_map(|item| value(self, item)).map(|at| at.value).collect()
        });
        let mut text = |field: &str| fields.get(field).and_then(|n| self.text(n, "text")).map(str::to_owned);
        let (unit, doc) = (text("unit"), text("doc"));
        Some(ParameterDecl { name, ty, default, min, max, one_of, unit, doc, place: fields.place })
    }

    pub(super) fn inputs(&mut self, node: &Node) -> Vec<InputDecl> {
        let mut out = Vec::new();
        for (name, node) in self.map(node, "an input", false) {
            let (node, optional) = match &node.form {
                Form::Tuple(Some(word), items) if word.text == "Optional" && items.len() == 1 => {
                    (&items[0], true)
                }
                _ => (node, false),
            };
            let expected = "the name of an interface, or `Optional(\"…\")`";
            let Some(interface) = self.text(node, expected) else { continue };
            let interface = At { value: Name::from(interface), place: self.place(node) };
            out.push(InputDecl { name, interface, optional });
        }
        out
    }

    pub(super) fn outputs(&mut self, node: &Node) -> Vec<OutputDecl> {
        let mut out = Vec::new();
        for (name, node) in self.map(node, "an output", false) {
            let Some(target) = self.target(node) else { continue };
            let link = Link::new(name.clone(), target, Self::content_end(node));
            out.push(OutputDecl { name, link });
        }
        out
    }
}

/// What a kind is told of `out:`; entries whose parameters are not known are left out.
pub(crate) fn out_overrides(
    outs: &[OutDecl],
    value: &mut impl FnMut(&Dim) -> Option<u32>,
) -> Arc<BTreeMap<String, OutputOverride>> {
    let entry = |out: &OutDecl, value: &mut dyn FnMut(&Dim) -> Option<u32>| OutputOverride {
        interface: out.interface.as_ref().map(|at| at.value.to_string()),
        format: out.format,
        size: out.size.as_ref().and_then(|at| at.value.extent(&mut |dim| value(dim))),
        count: out.count.as_ref().and_then(|at| value(&at.value)),
    };
    Arc::new(outs.iter().map(|out| (out.port.value.to_string(), entry(out, value))).collect())
}

/// The place of bytes `start..end` of a text; the whole text where it holds escapes.
pub(crate) fn within(text: &At<Option<u32>>, start: u32, end: u32) -> Place {
    match text.value {
        Some(content) => Place { file: text.place.file, start: content + start, end: content + end },
        None => text.place,
    }
}
