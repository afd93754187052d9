//! A composed text with its origins, and errors in it reported at the user's own lines.

use crate::directive::{self, Define, Directive};
use crate::exact::DeclaredExact;
use crate::line_map::{LineMap, span};
use crate::port::{self, DeclaredPort};
use data_file::codes::Code;
use data_file::{Diagnostic, Label, Setting, Source, Span, Value};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::sync::Arc;

/// The declarations of a file and its imports that concern who loads it, found without looking at the WGSL.
#[derive(Clone, Debug, Default)]
pub struct Outline {
    /// The options, in the order they are declared in.
    pub options: Vec<ShaderOption>,
    /// Names of the interfaces that are imported.
    pub interfaces: BTreeSet<String>,
    /// The inputs that are declared, in order.
    pub inputs: Vec<DeclaredPort>,
    /// The outputs that are declared, in order.
    pub outputs: Vec<DeclaredPort>,
    /// Where `#lights` stands: that a use says which lights of the scene it takes.
    pub lights: Option<String>,
    /// What the pass approximates, in order.
    pub exact: Vec<DeclaredExact>,
    /// Paths of all files that take part.
    pub files: Vec<String>,
}

impl Outline {
    /// Returns the ports that the lines of one text declare that can be read: of a text that is half typed.
    pub fn of_broken(source: &Arc<Source>) -> Outline {
        let mut outline = Outline { files: vec![source.name.clone()], ..Outline::default() };
        let (text, mut at) = (&source.text, 0);
        for line in text.split_inclusive('\n') {
            if line.trim_start().starts_with('#') {
                let whole = &text[at..at + port::extent(&text[at..], line.len())];
                if let Ok(Directive::Port { input, port, .. }) = directive::parse(source, whole, at) {
                    if input { &mut outline.inputs } else { &mut outline.outputs }.push(port);
                }
            }
            at += line.len();
        }
        outline
    }
}

/// The value of a setting that leaves the choice to the scene, where an option has such a choice.
pub const AUTO: &str = "auto";

/// An `#option`: a choice between variants.
#[derive(Clone, Debug)]
pub struct ShaderOption {
    /// The name in `#if`, and of the WGSL constant where the values are numbers or booleans.
    pub name: String,
    /// The value where the request gives none.
    pub default: Define,
    /// The only values it takes; empty where any of its type will do.
    pub one_of: Vec<Define>,
    /// Whether only the pass itself sets it: neither a user nor the scene does.
    pub internal: bool,
    /// The value, not the default, that the setting `auto` means where the scene has a trait, and that trait.
    pub auto: Option<(Define, String)>,
    /// The comment behind it.
    pub doc: String,
    /// The declaration.
    pub place: Span,
    /// The values with which conditions compare it: with the default, those that make a difference.
    pub(crate) compared: BTreeSet<Define>,
}

impl ShaderOption {
    /// Returns the option as a setting: named in small letters, of the option's default and values. Of a word, the
    /// values are those that make variants.
    pub fn setting(&self) -> Setting {
        let negative = |value: &Define| matches!(value, Define::Int(number) if *number < 0);
        let signed = negative(&self.default) || self.one_of.iter().any(negative);
        let value = |define: &Define| match define {
            Define::Bool(on) => Value::Bool(*on),
            Define::Int(n) if signed => Value::I32((*n).clamp(i32::MIN.into(), i32::MAX.into()) as i32),
            Define::Int(n) => Value::U32((*n).clamp(0, u32::MAX.into()) as u32),
            Define::Text(word) => Value::Text(word.clone()),
        };
        let mut one_of =
            if let Define::Text(_) = &self.default { self.values() } else { self.one_of.clone() };
        let mut default = value(&self.default);
        if self.auto.is_some() {
            let auto = Define::Text(AUTO.to_owned());
            default = value(&auto);
            one_of.insert(0, auto);
        }
        Setting {
            name: self.name.to_lowercase(),
            ty: default.ty(),
            default,
            min: None,
            max: None,
            one_of: one_of.iter().map(value).collect(),
            unit: String::new(),
            doc: self.doc.clone(),
            declared: self.place.to_string(),
        }
    }

    /// Returns the values that make variants: `false` and `true`; all of `one_of`; or else the default and whatever a
    /// condition compares with.
    pub fn values(&self) -> Vec<Define> {
        if matches!(self.default, Define::Bool(_)) {
            return vec![Define::Bool(false), Define::Bool(true)];
        }
        if !self.one_of.is_empty() {
            return self.one_of.clone();
        }
        let mut values = self.compared.clone();
        values.insert(self.default.clone());
        values.into_iter().collect()
    }
}

/// A composed text.
#[derive(Clone, Debug)]
pub(crate) struct Composed {
    pub(crate) text: String,
    pub(crate) map: LineMap,
    pub(crate) outline: Outline,
    /// For each file, how it came in; the first is the one asked for.
    pub(crate) origins: BTreeMap<String, Option<Import>>,
    /// The values of all options.
    pub(crate) values: BTreeMap<String, Define>,
    pub(crate) main: Arc<Source>,
}

/// A line that brings in a file.
#[derive(Clone, Debug)]
pub(crate) struct Import {
    pub(crate) place: Span,
    /// The interface, where the path stands in the request.
    pub(crate) interface: Option<String>,
}

impl Composed {
    /// An error at ranges of the composed text, reported at the user's own lines, with how the file came in.
    pub(crate) fn diagnostic(
        &self,
        code: &'static Code,
        message: impl Into<String>,
        labels: impl IntoIterator<Item = (Range<u32>, String)>,
        notes: impl IntoIterator<Item = String>,
    ) -> Diagnostic {
        let mut labels: Vec<Label> = labels
            .into_iter()
            .filter_map(|(range, message)| Some(Label { span: self.map.span(range)?, message }))
            .collect();
        if labels.is_empty() {
            labels.push(Label { span: span(&self.main, 0..0), message: String::new() });
        }
        let mut notes: Vec<String> = notes.into_iter().collect();
        notes.extend(import_chain(&self.origins, &labels[0].span.source.name));
        if !self.values.is_empty() {
            notes.push(format!("in the variant {}", self.variant()));
        }
        Diagnostic { labels, notes, ..Diagnostic::new(code, message) }
    }

    /// The values of the options.
    pub(crate) fn variant(&self) -> String {
        let values: Vec<String> =
            self.values.iter().map(|(name, value)| format!("{name} = {value}")).collect();
        values.join(", ")
    }
}

/// Returns how `file` came in, from import to import; `None` for the file asked for.
pub(crate) fn import_chain(origins: &BTreeMap<String, Option<Import>>, file: &str) -> Option<String> {
    let mut note = String::new();
    let mut file = file;
    while let Some(Some(Import { place, interface })) = origins.get(file) {
        let what = if note.is_empty() { format!("`{file}` is") } else { ", which is".to_owned() };
        let role = interface.as_ref().map_or(String::new(), |name| format!(" as interface \"{name}\""));
        note.push_str(&format!("{what} imported{role} by {place}"));
        file = &place.source.name;
    }
    (!note.is_empty()).then_some(note)
}
