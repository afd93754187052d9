//! A serde deserializer over the values of a text.
//!
//! The `ron` crate splits a text into the texts of its values, and reads numbers and texts; this module gives them to
//! serde one by one. A value that does not fit is reported at its place and a stand-in is given in its stead (zero, an
//! empty text, no items), so that types derived by serde are always read to their end and all errors are found. What is
//! read with an error is thrown away.

mod access;
mod wording;

use super::node::{Node, Number, Shape};
use super::{Reader, SPANNED};
use crate::codes;
use crate::diagnostic::{Diagnostic, MAX_QUOTED, Place, nearest, shortened};
use access::{Entries, FieldAccess, Items, SpannedAccess, Variant};
use serde::de::{self, DeserializeOwned, DeserializeSeed, Deserializer, Visitor};
use serde::forward_to_deserialize_any;
use std::cell::RefCell;
use std::collections::HashMap;
use std::fmt;
use std::rc::Rc;
use wording::{forms, said, shares_a_word, words};

/// Why a type refused a value; empty if that is reported.
#[derive(Debug)]
pub(super) struct Refusal(pub(super) String);

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Refusal {}

impl de::Error for Refusal {
    fn custom<T: fmt::Display>(message: T) -> Refusal {
        Refusal(message.to_string())
    }
}

type Result<T> = std::result::Result<T, Refusal>;

/// Returns what a type expects, as errors say it.
pub(super) fn expected<T: DeserializeOwned>(reader: &mut Reader<'_>) -> String {
    let answer = Rc::new(RefCell::new(String::new()));
    let place = Place { file: reader.file, start: 0, end: 0 };
    let reader = RefCell::new(reader);
    let at = At::Asked(Rc::clone(&answer));
    let de = De { reader: &reader, at, place, key: "".into(), form: None, expected: None, tuple: false };
    // What is read of nothing is a stand-in.
    let _ = T::deserialize(de);
    answer.take()
}

/// What a deserializer reads.
#[derive(Clone, Debug)]
enum At<'r> {
    Value(Node<'r>),
    /// A field that its form does not have.
    Absent,
    /// What is reported, or in something that is.
    Bad,
    /// Nothing: the type says what it expects.
    Asked(Rc<RefCell<String>>),
}

/// The deserializer of one value.
#[derive(Clone)]
pub(super) struct De<'r, 's> {
    reader: &'r RefCell<&'r mut Reader<'s>>,
    at: At<'r>,
    /// Where it stands, or what it is missing from.
    place: Place,
    /// The field or key whose value it is, or is in.
    key: Rc<str>,
    /// The form whose name is already read.
    form: Option<&'r str>,
    /// What a type around it expects.
    expected: Option<String>,
    /// Whether a tuple stands for a list.
    tuple: bool,
}

impl<'r, 's> De<'r, 's> {
    pub(super) fn new(reader: &'r RefCell<&'r mut Reader<'s>>, node: Node<'r>) -> Self {
        let place = reader.borrow().place(node);
        De { reader, at: At::Value(node), place, key: "".into(), form: None, expected: None, tuple: false }
    }

    fn with(&self, at: At<'r>) -> Self {
        let place = match &at {
            At::Value(node) => self.reader.borrow().place(*node),
            _ => self.place,
        };
        De { at, place, key: Rc::clone(&self.key), form: None, expected: None, tuple: false, ..*self }
    }

    fn keyed(&self, key: &str, at: At<'r>) -> Self {
        De { key: key.into(), ..self.with(at) }
    }

    /// Reads one value by a type; what the type refuses is reported at the value.
    fn give<'de, S: DeserializeSeed<'de>>(self, seed: S) -> Result<S::Value> {
        let (reader, place) = (self.reader, self.place);
        seed.deserialize(self).map_err(|Refusal(message)| {
            if !message.is_empty() {
                let mut reader = reader.borrow_mut();
                let place = reader.head(place);
                reader.report_bad(Diagnostic::new(&codes::WRONG_TYPE, message), place);
            }
            Refusal(String::new())
        })
    }

    fn expected(&self, default: impl FnOnce() -> String) -> String {
        match &self.expected {
            Some(expected) => expected.clone(),
            None => default(),
        }
    }

    fn plain(&self, what: &str) -> String {
        self.expected(|| match &*self.key {
            "" => what.to_owned(),
            key => format!("{what} for `{}`", shortened(key, MAX_QUOTED)),
        })
    }

    /// Returns the value where it is there.
    fn node(&self, expected: impl FnOnce() -> String) -> Option<Node<'r>> {
        match &self.at {
            At::Value(node) => return Some(*node),
            At::Absent => self.missing(),
            At::Asked(answer) => *answer.borrow_mut() = expected(),
            At::Bad => {}
        }
        None
    }

    /// Answers an editor's question about the value: which forms it may have, as errors write them.
    fn answer(&self, expected: &str, variants: &[&str]) {
        let (At::Value(node), Some(question)) = (&self.at, &mut self.reader.borrow_mut().question) else {
            return;
        };
        let written: Vec<String> = words(expected).map(|(_, form)| form.to_owned()).collect();
        let plain = || variants.iter().map(|variant| (*variant).to_owned()).collect();
        question.value(*node, if written.is_empty() { plain() } else { written });
    }

    fn missing(&self) {
        let mut reader = self.reader.borrow_mut();
        let message = format!("`{}` needs a field `{}`", self.form.unwrap_or_default(), self.key);
        reader.report_bad(Diagnostic::new(&codes::MISSING_FIELD, message), self.place);
    }

    fn wrong(&self, expected: &str) {
        if let At::Value(node) = &self.at {
            self.reader.borrow_mut().wrong_node(*node, expected);
        }
    }

    /// Reads what a value is by its shape; reports it where it is something else.
    fn leaf<T>(&self, what: &str, read: impl FnOnce(Shape<'r>) -> Option<T>) -> Option<T> {
        let found = read(self.node(|| self.expected(|| what.to_owned()))?.shape());
        if found.is_none() {
            self.wrong(&self.plain(what));
        }
        found
    }

    fn whole<T: TryFrom<i128>>(&self, (min, max): (i128, i128)) -> Option<T> {
        let number = self.leaf("a whole number", |shape| match shape {
            Shape::Number(Number::Integer(n)) => Some(n),
            _ => None,
        })?;
        let fits = T::try_from(number).ok();
        if fits.is_none() {
            self.wrong(&self.plain(&format!("a whole number from {min} to {max}")));
        }
        fits
    }

    fn float(&self) -> f64 {
        let number = self.leaf("a number", |shape| match shape {
            Shape::Number(number) => Some(number.as_f64()),
            _ => None,
        });
        number.unwrap_or_default()
    }

    fn text(&self) -> String {
        self.leaf("text", |shape| if let Shape::Text(text) = shape { Some(text) } else { None })
            .unwrap_or_default()
    }

    /// Returns the fields of a form, by their order in `known`; reports those that are none of them, or are given twice.
    fn known_fields(
        &self,
        form: &str,
        known: &'static [&'static str],
        fields: Vec<(Node<'r>, Node<'r>)>,
    ) -> Vec<At<'r>> {
        let mut values = vec![At::Absent; known.len()];
        let mut places = vec![self.place; known.len()];
        let (mut unknown, mut again) = (Vec::new(), Vec::new());
        let mut reader = self.reader.borrow_mut();
        for (name, value) in fields {
            let place = reader.place(name);
            match known.iter().position(|known| *known == name.text()) {
                None => unknown.push(name),
                Some(index) if matches!(values[index], At::Absent) => {
                    values[index] = At::Value(value);
                    places[index] = place;
                }
                Some(index) => again.push((name, index)),
            }
        }
        for name in unknown {
            let text = name.text();
            let message = format!("`{form}` has no field `{}`", shortened(text, MAX_QUOTED));
            let error = Diagnostic::new(&codes::UNKNOWN_FIELD, message);
            // What is absent is meant before what is there too.
            let absent = || (0..known.len()).filter(|index| matches!(values[*index], At::Absent));
            let near = nearest(text, absent().map(|index| known[index]))
                .or_else(|| absent().map(|index| known[index]).find(|known| shares_a_word(text, known)));
            let error = error.suggest("fields", near.unwrap_or(text), known.iter().copied());
            if let Some(index) = known.iter().position(|known| Some(*known) == near) {
                // It is this field by another name, and not missing too; what a stand-in gives is not reported.
                values[index] = At::Bad;
                let form = reader.head(self.place);
                reader.bad.insert((form.start, form.end));
            }
            let place = reader.place(name);
            reader.report_bad(error, place);
        }
        for (name, index) in again {
            let place = reader.place(name);
            reader.duplicate(&format!("field `{}`", name.text()), place, places[index]);
        }
        values
    }

    /// Gives the fields of a form whose name is read; stand-ins where there are none.
    fn form<'de, V: Visitor<'de>>(
        &self,
        form: &'r str,
        known: &'static [&'static str],
        fields: Option<Vec<(Node<'r>, Node<'r>)>>,
        visitor: V,
    ) -> Result<V::Value> {
        if let (At::Value(node), Some(question)) = (&self.at, &mut self.reader.borrow_mut().question) {
            question.form(*node, known);
        }
        let values = match fields {
            Some(fields) => self.known_fields(form, known, fields),
            None => vec![At::Bad; known.len()],
        };
        let place = self.reader.borrow().head(self.place);
        let de = De { place, form: Some(form), ..self.with(At::Bad) };
        visitor.visit_map(FieldAccess { de, known, values, next: 0 })
    }

    /// Reports a name of a form that is none of those that are known.
    fn unknown_form(&self, node: Node<'r>, expected: &str, known: &[&str]) {
        let mut reader = self.reader.borrow_mut();
        let name = node.name().unwrap_or_default();
        let start = node.start() + node.text().find(name).unwrap_or(0);
        let place = Place { file: reader.file, start: start as u32, end: (start + name.len()) as u32 };
        let message = format!("`{}` is not known here: expected {expected}", shortened(name, MAX_QUOTED));
        let error = Diagnostic::new(&codes::UNKNOWN_FORM, message);
        // A word where a list is expected is like one of the list.
        let others = words(expected).map(|(word, _)| word).filter(|word| !known.contains(word));
        reader.report_bad(error.suggest("forms", name, known.iter().copied().chain(others)), place);
        reader.bad(node);
    }

    /// Returns what the elements of a visitor of sequences expect, each.
    fn asked<'de, V: Visitor<'de>>(&self, visitor: V, count: usize) -> Result<(V::Value, String)> {
        let answer = Rc::new(RefCell::new(String::new()));
        let item = De { at: At::Asked(Rc::clone(&answer)), ..self.with(At::Bad) };
        let mut items = vec![item];
        items.resize(count, self.with(At::Bad));
        let value = visitor.visit_seq(Items { items: items.into_iter() })?;
        let answer = answer.borrow().clone();
        Ok((value, answer))
    }

    /// Returns the name of the shape of the value among those of `variants`, and whether that is a tuple.
    fn shaped(&self, node: Node<'r>, variants: &'static [&'static str]) -> Option<(&'static str, bool)> {
        let names: &[&str] = match node.shape() {
            Shape::Bool(_) => &["Bool"],
            Shape::Number(Number::Integer(_)) => &["Integer", "Number"],
            Shape::Number(Number::Float(_)) => &["Float", "Number"],
            Shape::Text(_) => &["Text"],
            Shape::Word(_) => &["Word"],
            Shape::Form(Some(_)) => &["Form"],
            Shape::Form(None) => &["Tuple"],
            Shape::List => &["List"],
            Shape::Map => &["Map"],
            Shape::Char | Shape::Bytes | Shape::Other => &[],
        };
        let find = |name: &str| variants.iter().copied().find(|variant| *variant == name);
        let found = names.iter().find_map(|name| find(name)).or_else(|| find("Other"))?;
        Some((found, found == "Tuple"))
    }
}

macro_rules! integers {
    ($($method:ident $visit:ident $ty:ty;)*) => {
        $(fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
            visitor.$visit(self.whole((<$ty>::MIN as i128, <$ty>::MAX as i128)).unwrap_or_default())
        })*
    };
}

impl<'de, 'r, 's> Deserializer<'de> for De<'r, 's> {
    type Error = Refusal;

    integers! {
        deserialize_i32 visit_i32 i32;
        deserialize_i64 visit_i64 i64;
        deserialize_i128 visit_i128 i128;
        deserialize_u32 visit_u32 u32;
        deserialize_u64 visit_u64 u64;
    }

    forward_to_deserialize_any! { i8 i16 u8 u16 char bytes byte_buf unit_struct identifier }

    fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value> {
        Err(Refusal("no grammar reads such a value".to_owned()))
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        self.answer("`true` or `false`", &[]);
        let found = self.leaf("`true` or `false`", |shape| match shape {
            Shape::Bool(bool) => Some(bool),
            _ => None,
        });
        visitor.visit_bool(found.unwrap_or_default())
    }

    fn deserialize_f32<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        visitor.visit_f32(self.float() as f32)
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        visitor.visit_f64(self.float())
    }

    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        visitor.visit_string(self.text())
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        visitor.visit_string(self.text())
    }

    fn deserialize_unit<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        visitor.visit_unit()
    }

    fn deserialize_ignored_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        visitor.visit_unit()
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        match &self.at {
            At::Absent | At::Bad => visitor.visit_none(),
            At::Value(node) if node.text() == "None" => visitor.visit_none(),
            At::Value(_) | At::Asked(_) => visitor.visit_some(self),
        }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        mut self,
        _name: &'static str,
        visitor: V,
    ) -> Result<V::Value> {
        self.expected = self.expected.or_else(|| said(&visitor));
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        if let At::Value(node) = self.at {
            let is_list = match node.shape() {
                Shape::List => true,
                Shape::Form(None) => self.tuple,
                _ => false,
            };
            if is_list {
                let items: Vec<_> = node.items().into_iter().map(|item| self.with(At::Value(item))).collect();
                return visitor.visit_seq(Items { items: items.into_iter() });
            }
            let (value, item) = self.asked(visitor, 1)?;
            self.wrong(&self.expected(|| format!("a list: [{item}, …]")));
            return Ok(value);
        }
        if let At::Asked(answer) = &self.at {
            let (value, item) = self.asked(visitor, 1)?;
            *answer.borrow_mut() = self.expected(|| format!("[{item}, …]"));
            return Ok(value);
        }
        visitor.visit_seq(Items { items: Vec::new().into_iter() })
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, len: usize, visitor: V) -> Result<V::Value> {
        let describe = |item: &str| format!("({})", vec![item; len].join(", "));
        let node = match &self.at {
            At::Value(node) => *node,
            other => {
                if matches!(other, At::Absent) {
                    self.missing();
                }
                let (value, item) = self.asked(visitor, len)?;
                if let At::Asked(answer) = other {
                    *answer.borrow_mut() = self.expected(|| describe(&item));
                }
                return Ok(value);
            }
        };
        let items = if node.shape() == Shape::Form(None) { node.items() } else { Vec::new() };
        if items.len() == len {
            let items: Vec<_> = items.into_iter().map(|item| self.with(At::Value(item))).collect();
            return visitor.visit_seq(Items { items: items.into_iter() });
        }
        let (value, item) = self.asked(visitor, len)?;
        self.wrong(&self.expected(|| describe(&item)));
        Ok(value)
    }

    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        len: usize,
        visitor: V,
    ) -> Result<V::Value> {
        self.deserialize_tuple(len, visitor)
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        let mut entries: Vec<(Self, Self)> = Vec::new();
        match &self.at {
            At::Value(node) if node.shape() == Shape::Map => {
                let mut seen: HashMap<String, Place> = HashMap::new();
                for (key, value) in node.entries() {
                    let place = self.reader.borrow().place(key);
                    let name = match key.shape() {
                        Shape::Text(name) => name,
                        _ => String::new(),
                    };
                    if let Some(first) = seen.get(&name).filter(|_| !name.is_empty()) {
                        self.reader.borrow_mut().duplicate(&format!("`{name}`"), place, *first);
                        continue;
                    }
                    entries.push((
                        De { expected: Some("a name in quotes".to_owned()), ..self.with(At::Value(key)) },
                        self.keyed(&name, At::Value(value)),
                    ));
                    seen.insert(name, place);
                }
            }
            At::Value(_) => {
                let answer = Rc::new(RefCell::new(String::new()));
                let key = self.with(At::Bad);
                let value = De { at: At::Asked(Rc::clone(&answer)), ..self.with(At::Bad) };
                let found =
                    visitor.visit_map(Entries { entries: vec![(key, value)].into_iter(), value: None })?;
                let answer = answer.borrow();
                self.wrong(&self.expected(|| format!("a map: {{ \"name\": {answer} }}")));
                return Ok(found);
            }
            At::Asked(answer) => *answer.borrow_mut() = self.expected(|| "{ \"name\": … }".to_owned()),
            At::Absent | At::Bad => {}
        }
        visitor.visit_map(Entries { entries: entries.into_iter(), value: None })
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        known: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value> {
        if name == SPANNED {
            let mut de = self;
            if matches!(de.at, At::Absent) {
                de.missing();
                de.at = At::Bad;
            }
            return visitor.visit_seq(SpannedAccess { de: Some(de), next: 0 });
        }
        let expected = self.expected(|| said(&visitor).unwrap_or_else(|| forms(&[name])));
        self.answer(&expected, &[name]);
        let form = self.form.filter(|_| matches!(self.at, At::Value(_))).unwrap_or(name);
        let Some(node) = self.node(|| expected.clone()) else {
            return self.form(form, known, None, visitor);
        };
        let fits = match node.shape() {
            Shape::Form(_) if self.form.is_some() => true,
            Shape::Form(None) => true,
            Shape::Form(Some(found)) | Shape::Word(found) if found == name => true,
            Shape::Form(Some(_)) => {
                self.unknown_form(node, &expected, &[name]);
                return self.form(form, known, None, visitor);
            }
            _ => false,
        };
        let fields = if fits { node.fields() } else { None };
        if fields.is_none() {
            self.wrong(&expected);
        }
        self.form(form, known, fields, visitor)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value> {
        let expected = self.expected(|| said(&visitor).unwrap_or_else(|| forms(variants)));
        self.answer(&expected, variants);
        if name == "$shape" {
            let at = match &self.at {
                At::Value(node) => self.shaped(*node, variants),
                _ => variants
                    .iter()
                    .find(|variant| **variant == "Other")
                    .or(variants.first())
                    .map(|v| (*v, false)),
            };
            let Some((variant, tuple)) = at else {
                self.wrong(&expected);
                return visitor.visit_enum(Variant {
                    de: self.with(At::Bad),
                    name: variants[0],
                    expected: None,
                });
            };
            let expected = said(&visitor).or_else(|| self.expected.clone());
            let de = De { expected, tuple, ..self };
            return visitor.visit_enum(Variant { de, name: variant, expected: None });
        }
        let bad = |de: &Self| Variant { de: de.with(At::Bad), name: variants[0], expected: None };
        let Some(node) = self.node(|| expected.clone()) else { return visitor.visit_enum(bad(&self)) };
        let (Shape::Form(Some(found)) | Shape::Word(found)) = node.shape() else {
            self.wrong(&expected);
            return visitor.visit_enum(bad(&self));
        };
        match variants.iter().find(|variant| **variant == found) {
            Some(variant) => {
                let de = De { expected: None, ..self };
                let of_variant = words(&expected).find(|(word, _)| word == variant);
                let expected = of_variant.map_or(expected.clone(), |(_, form)| format!("`{form}`"));
                visitor.visit_enum(Variant { de, name: variant, expected: Some(expected) })
            }
            None => {
                self.unknown_form(node, &expected, variants);
                visitor.visit_enum(bad(&self))
            }
        }
    }
}
