//! From the tree of a file to a description: the grammar.

use super::Description;
use super::form::{At, InputDecl, Link, OutDecl, OutputDecl, ParameterDecl, SaidFact, SetValue, is_name};
use crate::codes;
use crate::diagnostic::{Diagnostics, Place, Source};
use crate::port::OutputOverride;
use crate::reader::{Form, Node, Number, Reader, read_as};
use crate::value::{Value, ValueType};
use data_file::Name;
use std::collections::BTreeMap;
use std::ops::{Deref, DerefMut};
use std::sync::Arc;

/// Reads a file whose places carry the index `file`.
pub(crate) fn parse_file(source: Arc<Source>, file: u32) -> Result<Description, Diagnostics> {
    read_as(&source, file, |reader, tree| Grammar(reader).pipeline(tree))
}

/// The grammar of pipelines over a reader.
pub(super) struct Grammar<'r, 'a>(&'r mut Reader<'a>);

impl<'a> Deref for Grammar<'_, 'a> {
    type Target = Reader<'a>;

    fn deref(&self) -> &Reader<'a> {
        self.0
    }
}

impl DerefMut for Grammar<'_, '_> {
    fn deref_mut(&mut self) -> &mut Self::Target {
        self.0
    }
}

const PARAMETER: &[&str] = &["default", "min", "max", "one_of", "unit", "doc"];

impl Grammar<'_, '_> {
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
        let passes = fields.get("passes").map(|n| self.passes(n)).unwrap_or_default();
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
        let forms = ["U32", "F32", "Bool", "Text"].map(|form| (form, PARAMETER));
        let fields = self.fields(node, "`U32(…)`, `F32(…)`, `Bool(…)` or `Text(…)`", &forms)?;
        let ty = match fields.form {
            "U32" => ValueType::U32,
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
            let Some(interface) = self.text(node, "the name of an interface") else { continue };
            let interface = At { value: Name::from(interface), place: self.place(node) };
            out.push(InputDecl { name, interface });
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

/// What a pass type is told of `out:`; sizes, counts and facts whose parameters are not put in are left out.
pub(crate) fn out_overrides(outs: &[OutDecl]) -> Arc<BTreeMap<String, OutputOverride>> {
    let fact = |said: &SaidFact| {
        let value = match &said.value {
            Some(value) => Some(value.get()?.clone()),
            None => None,
        };
        Some((said.name.value.to_string(), value))
    };
    let entry = |out: &OutDecl| OutputOverride {
        interface: out.interface.as_ref().map(|at| at.value.to_string()),
        format: out.format,
        size: out.size.as_ref().and_then(|at| at.value.extent()),
        count: out.count.as_ref().and_then(|at| at.value.number()),
        facts: out.facts.iter().filter_map(fact).collect(),
    };
    Arc::new(outs.iter().map(|out| (out.port.value.to_string(), entry(out))).collect())
}
