//! Values of a text, each with its place, that are read when they are asked for.

use super::syntax::{skip_blanks, trimmed};
use ron::value::RawValue;
use serde::de::{Deserializer, MapAccess, SeqAccess, Visitor};
use std::fmt;

/// A value of a text: the bytes that it covers, of which nothing is read yet.
#[derive(Clone, Copy, Debug)]
pub struct Node<'a> {
    text: &'a str,
    start: usize,
}

/// The type of value that stands in a text.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape<'a> {
    /// `true` or `false`.
    Bool(bool),
    /// A number.
    Number(Number),
    /// A character in single quotes.
    Char,
    /// Text.
    Text(String),
    /// `b"…"`
    Bytes,
    /// A name alone: `All`.
    Word(&'a str),
    /// `Pass(…)` or, without a name, `(…)`.
    Form(Option<&'a str>),
    /// `[…]`
    List,
    /// `{ key: value }`
    Map,
    /// What no grammar takes, as `1..2`.
    Other,
}

/// A number, as it is written.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize)]
#[serde(rename = "$shape", expecting = "a number")]
pub enum Number {
    /// Whole.
    Integer(i128),
    /// With a point or an exponent; also `inf` and `NaN`.
    Float(f64),
}

/// What stands between brackets.
#[derive(Clone, Debug)]
pub enum Parts<'a> {
    /// The names and values of fields, each name as a node.
    Fields(Vec<(Node<'a>, Node<'a>)>),
    /// The values of a list or a tuple.
    Items(Vec<Node<'a>>),
}

impl Number {
    /// Returns it as a real number.
    pub fn as_f64(self) -> f64 {
        match self {
            Number::Integer(n) => n as f64,
            Number::Float(x) => x,
        }
    }
}

impl From<ron::Number> for Number {
    fn from(number: ron::Number) -> Number {
        match number {
            ron::Number::F32(_) | ron::Number::F64(_) => Number::Float(number.into_f64()),
            ron::Number::I64(n) => Number::Integer(n.into()),
            ron::Number::U64(n) => Number::Integer(n.into()),
            // All others are exact in `f64`.
            _ => Number::Integer(number.into_f64() as i128),
        }
    }
}

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Number::Integer(n) => write!(f, "{n}"),
            Number::Float(x) => write!(f, "{x:?}"),
        }
    }
}

impl<'a> Node<'a> {
    /// Returns the value of a file, behind its attributes. A text that is not RON has none that is worth reading.
    pub fn root(text: &'a str) -> Node<'a> {
        let rest = ron::Deserializer::from_str(text).map_or(text, |ron| ron.remainder());
        Node { text, start: 0 }.part(rest)
    }

    /// Returns the value at these bytes of a text.
    pub fn at(text: &'a str, start: u32, end: u32) -> Node<'a> {
        Node { text: text.get(start as usize..end as usize).unwrap_or_default(), start: start as usize }
    }

    fn part(self, text: &'a str) -> Node<'a> {
        let text = trimmed(text);
        let start = self.start + (text.as_ptr() as usize - self.text.as_ptr() as usize);
        Node { text, start }
    }

    /// Returns the text of the value.
    pub fn text(self) -> &'a str {
        self.text
    }

    /// Returns the first byte.
    pub fn start(self) -> usize {
        self.start
    }

    /// Returns the byte behind the last one.
    pub fn end(self) -> usize {
        self.start + self.text.len()
    }

    /// Returns the name of a form or a word, where it has one.
    pub fn name(self) -> Option<&'a str> {
        let text = self.text.strip_prefix("r#").unwrap_or(self.text);
        let end = text.find(|c: char| !(c == '_' || c.is_alphanumeric())).unwrap_or(text.len());
        let name = &text[..end];
        name.starts_with(|c: char| c == '_' || c.is_alphabetic()).then_some(name)
    }

    /// Returns the part that stands for a long value: the name of a form, or the first line.
    pub fn head(self) -> Node<'a> {
        let end = match self.shape() {
            Shape::Form(Some(name)) => name.len(),
            _ => self.text.find('\n').unwrap_or(self.text.len()),
        };
        Node { text: self.text[..end].trim_end_matches('\r'), ..self }
    }

    /// Returns what type of value it is.
    pub fn shape(self) -> Shape<'a> {
        let number = || match ron::from_str(self.text) {
            Ok(ron::Value::Number(number)) => Shape::Number(number.into()),
            _ => Shape::Other,
        };
        let text = || ron::from_str(self.text).map_or(Shape::Other, Shape::Text);
        let raw = |prefix| {
            self.text
                .strip_prefix(prefix)
                .is_some_and(|rest: &str| rest.trim_start_matches('#').starts_with('"'))
        };
        match self.text.chars().next() {
            Some('"') => text(),
            Some('\'') => Shape::Char,
            Some('[') => Shape::List,
            Some('{') => Shape::Map,
            Some('(') => Shape::Form(None),
            Some('r') if raw("r") => text(),
            Some('b') if raw("b") || raw("br") => Shape::Bytes,
            Some('b') if self.text.starts_with("b'") => number(),
            Some('0'..='9' | '+' | '-' | '.') => number(),
            _ => match self.name() {
                Some("true") => Shape::Bool(true),
                Some("false") => Shape::Bool(false),
                Some("inf" | "inff32" | "inff64" | "NaN" | "NaNf32" | "NaNf64") => number(),
                Some(name) if self.text.ends_with(')') => Shape::Form(Some(name)),
                Some(name) if self.text.ends_with(name) => Shape::Word(name),
                _ => Shape::Other,
            },
        }
    }

    /// Returns what stands between the brackets of a form or a list; no items for anything else.
    pub fn parts(self) -> Parts<'a> {
        let open = match self.shape() {
            Shape::Form(Some(name)) => {
                let end = name.as_ptr() as usize + name.len() - self.text.as_ptr() as usize;
                Some(skip_blanks(self.text, end))
            }
            Shape::Form(None) | Shape::List => Some(0),
            _ => None,
        };
        let raw = open.and_then(|open| read(&self.text[open..], |ron| ron.deserialize_any(PartsVisitor)));
        match raw.unwrap_or(Raw::Items(Vec::new())) {
            Raw::Fields(fields) => Parts::Fields(
                fields.into_iter().map(|(name, value)| (self.part(name), self.part(value))).collect(),
            ),
            Raw::Items(items) => Parts::Items(items.into_iter().map(|item| self.part(item)).collect()),
        }
    }

    /// Returns the keys and values of a map; none for anything else.
    pub fn entries(self) -> Vec<(Node<'a>, Node<'a>)> {
        let raw = match self.shape() {
            Shape::Map => read(self.text, |ron| ron.deserialize_map(EntriesVisitor)).unwrap_or_default(),
            _ => Vec::new(),
        };
        raw.into_iter().map(|(key, value)| (self.part(key), self.part(value))).collect()
    }

    /// Returns the values of a list or a tuple.
    pub fn items(self) -> Vec<Node<'a>> {
        match self.parts() {
            Parts::Items(items) => items,
            Parts::Fields(_) => Vec::new(),
        }
    }

    /// Returns the names and values of the fields of a form; `None` where values without names stand in it.
    pub fn fields(self) -> Option<Vec<(Node<'a>, Node<'a>)>> {
        match self.parts() {
            Parts::Fields(fields) => Some(fields),
            Parts::Items(items) => items.is_empty().then(Vec::new),
        }
    }

    /// Returns the value of a field of a form.
    pub fn field(self, name: &str) -> Option<Node<'a>> {
        self.fields()?.iter().find(|(n, _)| n.text == name).map(|(_, value)| *value)
    }

    /// Returns the number that it is.
    pub fn number(self) -> Option<Number> {
        if let Shape::Number(number) = self.shape() { Some(number) } else { None }
    }
}

fn read<'a, T>(
    text: &'a str,
    read: impl FnOnce(&mut ron::Deserializer<'a>) -> Result<T, ron::Error>,
) -> Option<T> {
    let options = ron::Options::default().without_recursion_limit();
    read(&mut ron::Deserializer::from_str_with_options(text, &options).ok()?).ok()
}

enum Raw<'a> {
    Fields(Vec<(&'a str, &'a str)>),
    Items(Vec<&'a str>),
}

struct PartsVisitor;

impl<'a> Visitor<'a> for PartsVisitor {
    type Value = Raw<'a>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("values in brackets")
    }

    fn visit_unit<E>(self) -> Result<Raw<'a>, E> {
        Ok(Raw::Items(Vec::new()))
    }

    fn visit_seq<A: SeqAccess<'a>>(self, mut items: A) -> Result<Raw<'a>, A::Error> {
        let mut found = Vec::new();
        while let Some(item) = items.next_element::<&RawValue>()? {
            found.push(item.get_ron());
        }
        Ok(Raw::Items(found))
    }

    fn visit_map<A: MapAccess<'a>>(self, mut fields: A) -> Result<Raw<'a>, A::Error> {
        let mut found = Vec::new();
        while let Some((name, value)) = fields.next_entry::<&str, &RawValue>()? {
            found.push((name, value.get_ron()));
        }
        Ok(Raw::Fields(found))
    }
}

struct EntriesVisitor;

impl<'a> Visitor<'a> for EntriesVisitor {
    type Value = Vec<(&'a str, &'a str)>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("keys and values")
    }

    fn visit_map<A: MapAccess<'a>>(self, mut entries: A) -> Result<Self::Value, A::Error> {
        let mut found = Vec::new();
        while let Some((key, value)) = entries.next_entry::<&RawValue, &RawValue>()? {
            found.push((key.get_ron(), value.get_ron()));
        }
        Ok(found)
    }
}
