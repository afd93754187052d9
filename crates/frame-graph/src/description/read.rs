//! From the tree of a file to a description: the grammar.

use super::form::*;
use super::Description;
use crate::codes::{self, Code};
use crate::diagnostic::{Diagnostic, Diagnostics, Place, Source, Span};
use crate::expression;
use crate::frame::ResetCause;
use crate::name::Name;
use crate::port::OutputOverride;
use crate::reader::{self, Form, Node, Number};
use crate::resource::{Clear, Format};
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
        reader.errors.retain(|e| e.code != codes::MISSING_FIELD.code);
    }
    if complaints.depth.is_some() {
        reader.errors.retain(|e| e.code == codes::NESTING.code || e.code == codes::SYNTAX.code);
    }
    match description {
        Some(description) if reader.errors.is_empty() => Ok(description),
        _ => Err(Diagnostics::sorted(reader.errors)),
    }
}

struct Reader<'a> {
    source: &'a Arc<Source>,
    file: u32,
    errors: Vec<Diagnostic>,
}

/// The named fields of a form, known to be among those that it has.
struct Fields<'a> {
    form: &'static str,
    place: Place,
    fields: Vec<(&'a str, &'a Node)>,
}

impl<'a> Fields<'a> {
    fn get(&self, name: &str) -> Option<&'a Node> {
        self.fields.iter().find(|(n, _)| *n == name).map(|(_, node)| *node)
    }
}

const PASS: &[&str] = &["kind", "shader", "in", "keep", "feed", "set", "out", "when", "off"];
const SUB: &[&str] = &["file", "in", "set", "when", "off"];
const GROUP: &[&str] = &["inputs", "in", "outputs", "when", "off"];
const PARAMETER: &[&str] = &["default", "min", "max", "one_of", "unit", "doc"];

impl Reader<'_> {
    fn place(&self, node: &Node) -> Place {
        Place { file: self.file, start: node.start, end: node.end }
    }

    /// The first line of a value, for pointing at long ones.
    fn head(&self, node: &Node) -> Place {
        let place = self.place(node);
        let text = &self.source.text[place.start as usize..place.end as usize];
        let len = match &node.form {
            Form::Struct(Some(name), _) | Form::Tuple(Some(name), _) => (name.end - name.start) as usize,
            _ => text.find('\n').unwrap_or(text.len()),
        };
        place.part(0, len)
    }

    fn span(&self, place: Place) -> Span {
        Span { source: Arc::clone(self.source), start: place.start, end: place.end }
    }

    fn error(&mut self, code: &'static Code, place: Place, message: impl Into<String>) -> &mut Diagnostic {
        self.errors.push(Diagnostic::new(code, message).label(self.span(place), ""));
        self.errors.last_mut().expect("just pushed")
    }

    fn wrong(&mut self, node: &Node, expected: &str) {
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
    fn fields<'n>(
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
            } else if let Some(first) = fields.iter().find(|f| f.name.text == field.name.text && f.name.start < place.start) {
                let first = Place { file: self.file, start: first.name.start, end: first.name.end };
                self.duplicate(&format!("field `{}`", field.name.text), place, first);
            } else {
                found.push((&field.name.text, &field.value));
            }
        }
        Some(Fields { form: form.0, place: self.head(node), fields: found })
    }

    fn duplicate(&mut self, what: &str, place: Place, first: Place) {
        let first = self.span(first);
        let error = self.error(&codes::DUPLICATE, place, format!("{what} is given twice"));
        error.labels[0].message = "again here".into();
        *error = error.clone().label(first, "first here");
    }

    fn need<'n>(&mut self, fields: &Fields<'n>, name: &str) -> Option<&'n Node> {
        let found = fields.get(name);
        if found.is_none() {
            let message = format!("`{}` needs a field `{name}`", fields.form);
            self.error(&codes::MISSING_FIELD, fields.place, message);
        }
        found
    }

    fn text<'n>(&mut self, node: &'n Node, expected: &str) -> Option<&'n str> {
        if let Form::Text(text, _) = &node.form {
            return Some(text);
        }
        self.wrong(node, expected);
        None
    }

    fn text_at(&mut self, node: &Node, expected: &str) -> Option<At<String>> {
        Some(At { value: self.text(node, expected)?.to_owned(), place: self.place(node) })
    }

    /// A name; with `path`, also one of several parts joined by `/`.
    fn name(&mut self, node: &Node, what: &str, path: bool) -> Option<At<Name>> {
        let text = self.text(node, &format!("the name of {what}"))?;
        let place = self.place(node);
        let good = if path { text.split('/').all(is_name) } else { is_name(text) };
        if !good {
            let error = self.error(&codes::BAD_NAME, place, format!("{text:?} cannot be the name of {what}"));
            error.notes.push("names are made of letters, digits, `-` and `_`".into());
            return None;
        }
        if path && matches!(text.rsplit('/').next(), Some("in" | "out")) {
            self.error(&codes::BAD_NAME, place, format!("`{text}` is kept for the inputs and outputs of a file"));
            return None;
        }
        Some(At { value: Name::from(text), place })
    }

    /// The entries of a map with names for keys, each name once.
    fn map<'n>(&mut self, node: &'n Node, what: &str, path: bool) -> Vec<(At<Name>, &'n Node)> {
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

    fn list<'n>(&mut self, node: &'n Node, expected: &str) -> &'n [Node] {
        if let Form::List(items) = &node.form {
            return items;
        }
        self.wrong(node, expected);
        &[]
    }

    fn pipeline(&mut self, node: &Node) -> Option<Description> {
        let known =
            ["about", "paper", "extends", "parameters", "inputs", "passes", "outputs", "patch"].as_slice();
        let fields = self.fields(node, "`Pipeline(…)`", &[("Pipeline", known)])?;
        let mut text = |name: &str| fields.get(name).and_then(|n| self.text_at(n, "text"));
        let (about, paper, extends) = (text("about"), text("paper"), text("extends"));
        let mut parameters = Vec::new();
        for (name, node) in fields.get("parameters").map(|n| self.map(n, "a parameter", false)).unwrap_or_default() {
            parameters.extend(self.parameter(name, node));
        }
        let inputs = fields.get("inputs").map(|n| self.inputs(n)).unwrap_or_default();
        let mut passes = Vec::new();
        for (name, node) in fields.get("passes").map(|n| self.map(n, "a pass", true)).unwrap_or_default() {
            let all = [("Pass", PASS), ("Sub", SUB), ("Group", GROUP)];
            if let Some(decl) = self.pass(node, &all) {
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

    fn parameter(&mut self, name: At<Name>, node: &Node) -> Option<ParameterDecl> {
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

    fn inputs(&mut self, node: &Node) -> Vec<InputDecl> {
        let mut out = Vec::new();
        for (name, node) in self.map(node, "an input", false) {
            let (node, optional) = match &node.form {
                Form::Tuple(Some(word), items) if word.text == "Optional" && items.len() == 1 => (&items[0], true),
                _ => (node, false),
            };
            let expected = "the name of an interface, or `Optional(\"…\")`";
            let Some(interface) = self.text(node, expected) else { continue };
            let interface = At { value: Name::from(interface), place: self.place(node) };
            out.push(InputDecl { name, interface, optional });
        }
        out
    }

    fn outputs(&mut self, node: &Node) -> Vec<OutputDecl> {
        let mut out = Vec::new();
        for (name, node) in self.map(node, "an output", false) {
            let Some(target) = self.target(node) else { continue };
            let link = Link::new(name.clone(), target, Self::content_end(node));
            out.push(OutputDecl { name, link });
        }
        out
    }

    /// Where the text of a link ends, if it can be pointed into.
    fn content_end(node: &Node) -> Option<u32> {
        match &node.form {
            Form::Text(text, Some(content)) => Some(content + text.len() as u32),
            _ => None,
        }
    }

    fn target(&mut self, node: &Node) -> Option<At<Target>> {
        let text = self.text(node, "a link: \"pass\", \"pass.port\" or \"pass.port.member\"")?;
        let place = self.place(node);
        let target = Target::parse(text);
        if target.is_none() {
            let error = self.error(&codes::BAD_NAME, place, format!("{text:?} cannot be read as a link"));
            error.notes.push("a link is \"pass\", \"pass.port\" or \"pass.port.member\"".into());
        }
        Some(At { value: target?, place })
    }

    fn link(&mut self, port: At<Name>, node: &Node) -> Option<Link> {
        let prev = match &node.form {
            Form::Struct(Some(name), _) | Form::Tuple(Some(name), _) => Some(&name.text),
            _ => None,
        };
        if prev.is_none() {
            return Some(Link::new(port, self.target(node)?, Self::content_end(node)));
        }
        let known = ["port", "init", "reset"].as_slice();
        let expected = "a link or `Prev(port: \"pass.port\")`";
        let fields = self.fields(node, expected, &[("Prev", known)])?;
        let init = fields.get("init").map_or(Some(Clear::Zero), |n| self.clear(n, "Zero", &["Black"]));
        let all = [ResetCause::Resize, ResetCause::Cut, ResetCause::Scene, ResetCause::Reload];
        let reset = match fields.get("reset") {
            None => all.to_vec(),
            Some(node) => {
                let mut causes = Vec::new();
                for item in self.list(node, "a list of `Resize`, `Cut`, `Scene` and `Reload`") {
                    let cause = all.into_iter().find(|cause| item.form == Form::Word(cause.to_string()));
                    match cause {
                        Some(cause) if !causes.contains(&cause) => causes.push(cause),
                        Some(_) => {}
                        None => self.wrong(item, "`Resize`, `Cut`, `Scene` or `Reload`"),
                    }
                }
                causes.sort_unstable();
                causes
            }
        };
        let node = self.need(&fields, "port")?;
        let link = Link::new(port, self.target(node)?, Self::content_end(node));
        Some(Link { past: Some(Arc::new(Past { init: init?, reset })), ..link })
    }

    fn clear(&mut self, node: &Node, main: &str, others: &[&str]) -> Option<Clear> {
        match &node.form {
            Form::Word(word) if word == main || others.contains(&word.as_str()) => return Some(Clear::Zero),
            Form::Tuple(Some(name), items) if name.text == "Color" => {
                if let Some(Value::Vector(v)) = self.vector(items)
                    && let [r, g, b, a] = v[..]
                {
                    return Some(Clear::Color([r, g, b, a]));
                }
                self.wrong(node, "`Color(r, g, b, a)`, four numbers");
                return None;
            }
            _ => {}
        }
        self.wrong(node, &format!("`{main}` or `Color(r, g, b, a)`"));
        None
    }

    fn vector(&self, items: &[Node]) -> Option<Value> {
        let number = |item: &Node| match item.form {
            Form::Number(Number::Integer(n)) => Some(n as f32),
            Form::Number(Number::Float(x)) => Some(x as f32).filter(|x| x.is_finite()),
            _ => None,
        };
        let numbers: Option<Vec<f32>> = items.iter().map(number).collect();
        numbers.filter(|v| (2..=4).contains(&v.len())).map(Value::Vector)
    }

    /// A value of a setting, or `"$parameter"`.
    fn value(&mut self, node: &Node) -> Option<SetValue> {
        let value = match &node.form {
            Form::Bool(b) => Value::Bool(*b),
            Form::Number(Number::Integer(n)) => {
                if let Ok(n) = u32::try_from(*n) {
                    Value::U32(n)
                } else if let Ok(n) = i32::try_from(*n) {
                    Value::I32(n)
                } else {
                    Value::F32(*n as f32)
                }
            }
            Form::Number(Number::Float(x)) if (*x as f32).is_finite() => Value::F32(*x as f32),
            Form::Number(_) => {
                self.wrong(node, "a finite number");
                return None;
            }
            Form::Text(text, _) => match text.strip_prefix('$') {
                Some(rest) if rest.starts_with('$') => Value::Text(rest.to_owned()),
                Some(name) if is_name(name) => return Some(SetValue::Parameter(Name::from(name), None)),
                Some(_) => {
                    self.wrong(node, "the name of a parameter after `$` (plain text that starts so is written `$$`)");
                    return None;
                }
                None => Value::Text(text.clone()),
            },
            Form::Tuple(None, items) | Form::List(items) if self.vector(items).is_some() => self.vector(items)?,
            _ => {
                self.wrong(node, "a value: true or false, a number, text, two to four numbers, or \"$parameter\"");
                return None;
            }
        };
        Some(SetValue::Value(value))
    }

    fn pass(&mut self, node: &Node, forms: &[(&'static str, &[&'static str])]) -> Option<PassDecl> {
        if matches!(&node.form, Form::Word(word) if word == "Removed" && forms.len() == 3) {
            return Some(PassDecl::tombstone(Some(self.place(node))));
        }
        let fields = self.fields(node, "`Pass(…)` or `Sub(…)`", forms)?;
        let body = match fields.form {
            "Pass" => {
                let kind = self.need(&fields, "kind").and_then(|n| self.text_at(n, "the name of a kind"));
                let shader = fields.get("shader").and_then(|n| self.text_at(n, "the path of a WGSL file"));
                let name = |at: At<String>| At { value: Name::from(at.value), place: at.place };
                kind.map(|kind| Body::Pass { kind: name(kind), shader: shader.map(name) })
            }
            "Sub" => {
                let file = self.need(&fields, "file").and_then(|n| self.text_at(n, "the path of a pipeline file"));
                file.map(|file| Body::Sub { file })
            }
            _ => {
                let inputs = fields.get("inputs").map(|n| self.inputs(n)).unwrap_or_default();
                let outputs = fields.get("outputs").map(|n| self.outputs(n)).unwrap_or_default();
                Some(Body::Group(Group { inputs, outputs }))
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
                set.push(Set { name, value, place: self.place(node), patched: false });
            }
        }
        let mut outs = Vec::new();
        for (port, node) in fields.get("out").map(|n| self.map(n, "an output", false)).unwrap_or_default() {
            outs.extend(self.out(port, node));
        }
        let when = fields.get("when").and_then(|n| self.when(n));
        let off = fields.get("off").and_then(|n| self.off(n));
        let link_names = links.iter().map(|link| link.port.value.to_string()).collect();
        let overrides = out_overrides(&outs, &mut |dim| match dim {
            Dim::Number(n) => Some(*n),
            Dim::Parameter(_) => None,
        });
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

    fn when(&mut self, node: &Node) -> Option<When> {
        let Form::Text(text, content) = &node.form else {
            self.wrong(node, "a switch as text, such as \"scene.glossy && $bounces > 1\"");
            return None;
        };
        let place = self.place(node);
        match expression::parse(text) {
            Ok(expr) => Some(When { expr, place, content: *content }),
            Err(error) => {
                let when = At { value: *content, place };
                let at = within(&when, error.start, error.end);
                self.error(error.code, at, error.message).notes = error.notes;
                None
            }
        }
    }

    fn off(&mut self, node: &Node) -> Option<At<Off>> {
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
            _ => {
                self.wrong(node, "`Black`, `Color(r, g, b, a)` or `Input(\"port\")`");
                None
            }
        }
    }

    fn out(&mut self, port: At<Name>, node: &Node) -> Option<OutDecl> {
        let known = ["interface", "format", "size", "count"].as_slice();
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
            let value = self.dim(n, "a count: a whole number or \"$parameter\"")?;
            Some(At { value, place: self.place(n) })
        });
        Some(OutDecl { port, interface, format, size, count })
    }

    fn dim(&mut self, node: &Node, expected: &str) -> Option<Dim> {
        let dim = match &node.form {
            Form::Number(Number::Integer(n)) => u32::try_from(*n).ok().filter(|n| *n > 0).map(Dim::Number),
            Form::Text(text, _) => {
                text.strip_prefix('$').filter(|name| is_name(name)).map(|name| Dim::Parameter(Name::from(name)))
            }
            _ => None,
        };
        if dim.is_none() {
            self.wrong(node, expected);
        }
        dim
    }

    fn size(&mut self, node: &Node) -> Option<At<Size>> {
        const EXPECTED: &str = "a size: \"frame\", \"frame / 4\", \"like(input) * 3 / 2\" or (width, height)";
        let place = self.place(node);
        let value = match &node.form {
            Form::Text(text, _) => {
                let size = relation(text);
                if size.is_none() {
                    self.wrong(node, EXPECTED);
                }
                size?
            }
            Form::Tuple(None, items) if items.len() == 2 => {
                let side = "a side in texels: a whole number above zero, or \"$parameter\"";
                let (w, h) = (self.dim(&items[0], side), self.dim(&items[1], side));
                Size::Fixed(w?, h?)
            }
            _ => {
                self.wrong(node, EXPECTED);
                return None;
            }
        };
        Some(At { value, place })
    }

    fn patch(&mut self, node: &Node) -> Option<Patch> {
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
                    let expected = "\"parameter\", \"pass.setting\" or \"part/pass.setting\"";
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
                    let error = Diagnostic::new(&codes::UNKNOWN_FORM, format!("there is no patch `{}`", name.text))
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

    fn shape(&mut self, node: &Node, expected: &str) -> Option<Patch> {
        self.wrong(node, expected);
        None
    }
}

const INSERT: &str = "`Insert(name: \"pass\", pass: Pass(…), between: (\"a.port\", \"b.port\"))`";
const BETWEEN: &str = "two ports: (\"a.port\", \"b.port\")";

/// `frame`, `frame / 4`, `like(input) * 3 / 2`; numbers may be `$parameter`.
fn relation(text: &str) -> Option<Size> {
    let dim = |text: &str| match text.strip_prefix('$') {
        Some(name) => is_name(name).then(|| Dim::Parameter(Name::from(name))),
        None => text.parse().ok().filter(|n| *n > 0).map(Dim::Number),
    };
    let text = text.trim();
    let (base, rest) = match text.strip_prefix("like") {
        Some(rest) => {
            let (input, rest) = rest.trim_start().strip_prefix('(')?.split_once(')')?;
            let input = input.trim().trim_matches(['\'', '"']);
            (Some(Name::from(input)).filter(|n| is_name(n))?, rest)
        }
        None => (Name::EMPTY, text.strip_prefix("frame")?),
    };
    let rest = rest.trim();
    let (num, den) = match rest.split_once('/') {
        Some((num, den)) => (num.trim(), dim(den.trim())?),
        None => (rest, Dim::Number(1)),
    };
    let num = if num.is_empty() { Dim::Number(1) } else { dim(num.strip_prefix('*')?.trim())? };
    Some(if base.is_empty() { Size::Frame(num, den) } else { Size::Like(base, num, den) })
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
