//! Reads RON into types that serde derives, with the place of every value and all errors at once.
//!
//! The `ron` crate gives places for what it cannot read, but not for the values that it has read, and most errors of a
//! file are in values that read well; it also stops at the first error. So it is asked for the texts of values, each of
//! which is read by itself.
//!
//! A grammar is a set of types for [`read`]. A value that does not fit is reported at its place, and a stand-in is given
//! in its stead (zero, an empty text, no items), so that all of a file is read.
//! - [`Spanned<T>`] is a value with its place.
//! - A field may be left out if it is an `Option`, a list or a map; others are needed.
//! - An enum renamed to `$shape` has a variant for each [`Shape`] that may stand there, and `Other` for all others; the
//!   variant has the value itself.
//! - `#[serde(expecting = "…")]` is what errors say was expected.

mod cursor;
mod de;
mod expected;
mod format;
mod node;
mod outline;
mod syntax;

pub use cursor::{Cursor, Frame, Within, closed, entries, unquoted};
pub use expected::{Expected, expected};
pub use format::format;
pub use node::{Node, Number, Parts, Shape};
pub use outline::{Item, outline};
pub use syntax::skip_blanks;

use crate::codes::{self, Code};
use crate::diagnostic::{Diagnostic, Diagnostics, MAX_ERRORS, MAX_QUOTED, Place, Source, Span, shortened};
use crate::files::MAX_TEXT;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::cell::RefCell;
use std::collections::HashSet;
use std::ops::Deref;
use std::sync::Arc;

/// The name by which [`Spanned`] asks for places.
const SPANNED: &str = "$spanned";

/// A value and its place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(from = "Parted<T>")]
pub struct Spanned<T> {
    /// The value.
    pub value: T,
    /// All bytes of the value.
    pub place: Place,
}

#[derive(Deserialize)]
#[serde(rename = "$spanned")]
struct Parted<T> {
    file: u32,
    start: u32,
    end: u32,
    value: T,
}

impl<T> From<Parted<T>> for Spanned<T> {
    fn from(Parted { file, start, end, value }: Parted<T>) -> Spanned<T> {
        Spanned { value, place: Place { file, start, end } }
    }
}

impl<T> Spanned<T> {
    /// Returns another value at the same place.
    pub fn with<U>(&self, value: U) -> Spanned<U> {
        Spanned { value, place: self.place }
    }
}

impl<T> Deref for Spanned<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.value
    }
}

/// The entries of a map, in the order of the file, each key once.
#[derive(Clone, Debug)]
pub struct Entries<T>(pub Vec<(Spanned<String>, T)>);

impl<T> Default for Entries<T> {
    fn default() -> Entries<T> {
        Entries(Vec::new())
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Entries<T> {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Entries<T>, D::Error> {
        struct Visitor<T>(std::marker::PhantomData<T>);

        impl<'de, T: Deserialize<'de>> serde::de::Visitor<'de> for Visitor<T> {
            type Value = Entries<T>;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a map")
            }

            fn visit_map<A: serde::de::MapAccess<'de>>(self, mut map: A) -> Result<Entries<T>, A::Error> {
                let mut entries = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    entries.push(entry);
                }
                Ok(Entries(entries))
            }
        }

        deserializer.deserialize_map(Visitor(std::marker::PhantomData))
    }
}

impl<T> IntoIterator for Entries<T> {
    type Item = (Spanned<String>, T);
    type IntoIter = std::vec::IntoIter<Self::Item>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.into_iter()
    }
}

/// Reads a file as a `T`, and what `convert` makes of that. Where something is wrong in the file, `convert` still looks
/// for more, with stand-ins for what could not be read; what it returns is then dropped.
///
/// # Errors
/// All that is wrong with the text and the values, and all that `convert` reported.
pub fn read<T: DeserializeOwned, U>(
    source: &Arc<Source>,
    file: u32,
    convert: impl FnOnce(&mut Reader<'_>, T) -> U,
) -> Result<U, Diagnostics> {
    if skip_blanks(&source.text, 0) == source.text.len() {
        return Err(empty::<T>(source, file).into());
    }
    parse(source, file, |reader, node| read_node(reader, node, convert))
}

/// Returns the error of a file without a value.
fn empty<T: DeserializeOwned>(source: &Arc<Source>, file: u32) -> Diagnostic {
    let mut reader = Reader { source, file, errors: Vec::new(), bad: HashSet::new(), question: None };
    let expected = de::expected::<T>(&mut reader);
    reader.at(
        &codes::SYNTAX,
        Place { file, start: 0, end: 0 },
        format!("the file is empty: expected {expected}"),
    )
}

/// Reads the same of a file that may be broken: what can be read of it, with stand-ins for the rest.
pub fn read_broken<T: DeserializeOwned, U>(
    source: &Arc<Source>,
    convert: impl FnOnce(&mut Reader<'_>, T) -> U,
) -> Option<U> {
    let mut found = None;
    // The errors are those that reading the file as a whole one reports.
    let _ = parse(source, 0, |reader, node| {
        found = read_node(reader, node, convert);
        Some(())
    });
    found
}

fn read_node<T: DeserializeOwned, U>(
    reader: &mut Reader<'_>,
    node: Node<'_>,
    convert: impl FnOnce(&mut Reader<'_>, T) -> U,
) -> Option<U> {
    let read = {
        let reader = RefCell::new(&mut *reader);
        T::deserialize(de::De::new(&reader, node))
    };
    match read {
        Ok(read) => Some(convert(reader, read)),
        Err(de::Refusal(message)) => {
            if !message.is_empty() {
                let place = reader.head(reader.place(node));
                reader.report_bad(Diagnostic::new(&codes::WRONG_TYPE, message), place);
            }
            None
        }
    }
}

/// Reads a file whose places carry the index `file`, and what `read` makes of its value.
///
/// # Errors
/// All that is wrong with the text, and all that `read` reported.
pub fn parse<T>(
    source: &Arc<Source>,
    file: u32,
    read: impl FnOnce(&mut Reader<'_>, Node<'_>) -> Option<T>,
) -> Result<T, Diagnostics> {
    let mut reader = Reader { source, file, errors: Vec::new(), bad: HashSet::new(), question: None };
    if source.text.len() > MAX_TEXT {
        let message = format!("the file is larger than {} MiB", MAX_TEXT >> 20);
        reader.error(&codes::SYNTAX, Place { file, start: 0, end: 0 }, message);
        return Err(Diagnostics::sorted(reader.errors));
    }
    let (complaints, text) = syntax::check(&source.text);
    let place = |start: usize, end: usize| Place { file, start: start as u32, end: end as u32 };
    let mut lines: Vec<usize> = Vec::new();
    let line = |at: u32| source.text.as_bytes()[..at as usize].iter().filter(|b| **b == b'\n').count();
    for complaint in complaints {
        let range = place(complaint.range.start, complaint.range.end);
        lines.push(line(range.start));
        let mut error = reader.at(complaint.code, range, complaint.message);
        if let Some(open) = complaint.opened {
            error = error.label(reader.span(place(open, open + 1)), "opened here");
        }
        reader.errors.push(error);
    }
    let broken = reader.errors.len();
    let found = text.and_then(|text| read(&mut reader, Node::root(&text)));
    if broken > 0 {
        // What is missing may stand in what could not be read.
        let mut index = 0;
        reader.errors.retain(|error| {
            index += 1;
            let shape = || {
                [codes::WRONG_TYPE.code, codes::UNKNOWN_FORM.code].contains(&error.code)
                    && lines.contains(&line(error.labels[0].span.start))
            };
            index <= broken || (error.code != codes::MISSING_FIELD.code && !shape())
        });
    }
    match found {
        Some(found) if reader.errors.is_empty() => Ok(found),
        _ => Err(Diagnostics::sorted(reader.errors)),
    }
}

/// A file that is being read, and the errors so far.
#[derive(Debug)]
pub struct Reader<'a> {
    /// The file.
    pub source: &'a Arc<Source>,
    /// The index that places in it carry.
    pub file: u32,
    errors: Vec<Diagnostic>,
    /// The places of values that stand-ins were given for.
    bad: HashSet<(u32, u32)>,
    /// The position that an editor asks about.
    question: Option<expected::Question>,
}

impl Reader<'_> {
    /// Returns the place of a node.
    pub fn place(&self, node: Node<'_>) -> Place {
        Place { file: self.file, start: node.start() as u32, end: node.end() as u32 }
    }

    fn node(&self, place: Place) -> Node<'_> {
        Node::at(&self.source.text, place.start, place.end)
    }

    /// Returns the name or the first line of a value, for pointing at long ones.
    pub fn head(&self, place: Place) -> Place {
        self.place(self.node(place).head())
    }

    /// Returns where the content of a text begins, if its bytes are those between the quotes.
    pub fn content(&self, text: &Spanned<String>) -> Option<u32> {
        let written = self.node(text.place).text();
        let start = written.find('"')? + 1;
        let rest = written[start..].strip_prefix(text.value.as_str())?;
        rest.starts_with('"').then(|| text.place.start + start as u32)
    }

    /// Returns the span of a place in this file.
    pub fn span(&self, place: Place) -> Span {
        Span { source: Arc::clone(self.source), start: place.start, end: place.end }
    }

    /// Returns an error at a place.
    pub fn at(&self, code: &'static Code, place: Place, message: impl Into<String>) -> Diagnostic {
        Diagnostic::new(code, message).label(self.span(place), "")
    }

    /// Adds an error at a place, unless one is known there.
    pub fn error(&mut self, code: &'static Code, place: Place, message: impl Into<String>) {
        self.report(self.at(code, place, message));
        self.bad.insert((place.start, place.end));
    }

    /// Adds an error, unless it is about a value that could not be read.
    pub fn report(&mut self, error: Diagnostic) {
        if !error.labels.iter().any(|label| self.bad.contains(&(label.span.start, label.span.end))) {
            self.push(error);
        }
    }

    /// Returns whether the number of errors is such that no more are kept. Where each is compared with all names of the
    /// file, a grammar does not look for more.
    pub fn is_full(&self) -> bool {
        self.errors.len() >= MAX_ERRORS * 10
    }

    fn push(&mut self, error: Diagnostic) {
        if self.is_full() {
            self.errors.pop();
        }
        self.errors.push(error);
    }

    /// Reports that a name or field is given twice.
    pub fn duplicate(&mut self, what: &str, place: Place, first: Place) {
        let error = Diagnostic::new(&codes::DUPLICATE, format!("{what} is given twice"));
        self.report(error.label(self.span(place), "again here").label(self.span(first), "first here"));
    }

    /// Reports that a value is not what was `expected`.
    pub fn wrong(&mut self, place: Place, expected: &str) {
        let source = Arc::clone(self.source);
        if !self.bad.contains(&(place.start, place.end)) {
            self.wrong_node(Node::at(&source.text, place.start, place.end), expected);
        }
    }

    fn wrong_node(&mut self, node: Node<'_>, expected: &str) {
        let found = match node.shape() {
            Shape::Bool(b) => format!("`{b}`"),
            Shape::Number(number) => format!("the number {number}"),
            Shape::Char => "a character".to_owned(),
            Shape::Text(text) => format!("the text {:?}", shortened(&text, MAX_QUOTED)),
            Shape::Bytes => "bytes".to_owned(),
            Shape::Form(Some(name)) => format!("`{}(…)`", shortened(name, MAX_QUOTED)),
            Shape::Form(None) => "`(…)`".to_owned(),
            Shape::List => "a list".to_owned(),
            Shape::Map => "a map".to_owned(),
            Shape::Word(text) => format!("`{}`", shortened(text, MAX_QUOTED)),
            Shape::Other => format!("`{}`", shortened(node.text(), MAX_QUOTED)),
        };
        let error = Diagnostic::new(&codes::WRONG_TYPE, format!("expected {expected}, found {found}"));
        self.report_bad(error, self.place(node.head()));
        self.bad(node);
    }

    /// Adds an error of a value in whose stead another is given.
    fn report_bad(&mut self, error: Diagnostic, place: Place) {
        self.bad.insert((place.start, place.end));
        let error = error.label(self.span(place), "");
        self.push(error);
    }

    fn bad(&mut self, node: Node<'_>) {
        for node in [node, node.head()] {
            self.bad.insert((node.start() as u32, node.end() as u32));
        }
    }
}
