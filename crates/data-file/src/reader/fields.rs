//! Forms and their fields: what every grammar over the tree asks.

use super::tree::{self, Form, MAX_DEPTH, Node, Number, read};
use crate::codes::{self, Code};
use crate::diagnostic::{Diagnostic, Diagnostics, MAX_ERRORS, MAX_QUOTED, Place, Source, Span, shortened};
use crate::files::MAX_TEXT;
use std::sync::Arc;

/// Reads a file by a grammar: a function from its tree to what it describes, which tells the reader what is wrong
/// and goes on.
///
/// # Errors
/// All that is wrong with the text, and all that the grammar told.
pub fn parse<T>(
    source: &Arc<Source>,
    grammar: impl FnOnce(&mut Reader<'_>, &Node) -> Option<T>,
) -> Result<T, Diagnostics> {
    read_as(source, 0, grammar)
}

/// Reads a file whose places carry the index `file`, and what `grammar` makes of its tree.
pub fn read_as<T>(
    source: &Arc<Source>,
    file: u32,
    grammar: impl FnOnce(&mut Reader<'_>, &Node) -> Option<T>,
) -> Result<T, Diagnostics> {
    let mut reader = Reader { source, file, errors: Vec::new() };
    if source.text.len() > MAX_TEXT {
        let message = format!("the file is larger than {} MiB", MAX_TEXT >> 20);
        reader.error(&codes::SYNTAX, Place { file, start: 0, end: 0 }, message);
        return Err(Diagnostics::sorted(reader.errors));
    }
    let (tree, complaints) = read(&source.text);
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
        let message = format!("values are nested deeper than {MAX_DEPTH}");
        reader.error(&codes::NESTING, Place { file, start, end }, message);
    }
    let found = grammar(&mut reader, &tree);
    if broken {
        // What is missing may stand in what could not be read.
        let ends: Vec<usize> = source.text.match_indices('\n').map(|(at, _)| at).collect();
        let line = |e: &Diagnostic| ends.partition_point(|end| *end < e.labels[0].span.start as usize);
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
    /// What is wrong so far.
    pub errors: Vec<Diagnostic>,
}

/// The named fields of a form, known to be among those that it has.
#[derive(Debug)]
pub struct Fields<'a> {
    /// The name of the form.
    pub form: &'static str,
    /// Where it begins.
    pub place: Place,
    fields: Vec<(&'a str, &'a Node)>,
}

impl<'a> Fields<'a> {
    /// Returns the name of the form.
    pub fn form(&self) -> &'static str {
        self.form
    }

    /// Returns the value of a field, where it is given.
    pub fn get(&self, name: &str) -> Option<&'a Node> {
        self.fields.iter().find(|(n, _)| *n == name).map(|(_, node)| *node)
    }
}

impl Reader<'_> {
    /// Returns the place of a value.
    pub fn place(&self, node: &Node) -> Place {
        Place { file: self.file, start: node.start, end: node.end }
    }

    /// Returns the first line of a value, for pointing at long ones.
    pub fn head(&self, node: &Node) -> Place {
        let place = self.place(node);
        let text = &self.source.text[place.start as usize..place.end as usize];
        let len = match &node.form {
            Form::Struct(Some(name), _) | Form::Tuple(Some(name), _) => (name.end - name.start) as usize,
            _ => text.find('\n').unwrap_or(text.len()),
        };
        place.part(0, len)
    }

    /// Returns the span of a place in this file.
    pub fn span(&self, place: Place) -> Span {
        Span { source: Arc::clone(self.source), start: place.start, end: place.end }
    }

    /// Adds an error at a place, and gives it for more to be said.
    pub fn error(
        &mut self,
        code: &'static Code,
        place: Place,
        message: impl Into<String>,
    ) -> &mut Diagnostic {
        self.tell(Diagnostic::new(code, message).label(self.span(place), ""));
        self.errors.last_mut().expect("just pushed")
    }

    /// Returns whether there are so many errors that no more are kept. Where each is compared with all names of the
    /// file, a grammar does not look for more.
    pub fn is_full(&self) -> bool {
        self.errors.len() >= MAX_ERRORS * 10
    }

    /// Adds an error of the grammar. Of more than a reader of errors would look at, only the last is kept.
    pub fn tell(&mut self, error: Diagnostic) {
        if self.is_full() {
            self.errors.pop();
        }
        self.errors.push(error);
    }

    /// Returns the bytes of a value.
    pub fn span_of(&self, node: &Node) -> Span {
        self.span(self.place(node))
    }

    /// Returns the name or the first line of a value, for pointing at long ones.
    pub fn head_of(&self, node: &Node) -> Span {
        self.span(self.head(node))
    }

    /// Tells that a value is not what was `expected`; what could not be read has already been reported.
    pub fn wrong(&mut self, node: &Node, expected: &str) {
        if node.form == Form::Bad {
            return;
        }
        let found = match &node.form {
            Form::Bool(b) => format!("`{b}`"),
            Form::Number(Number::Integer(n)) => format!("the number {n}"),
            Form::Number(Number::Float(x)) => format!("the number {x:?}"),
            Form::Char(_) => "a character".to_owned(),
            Form::Text(text, _) => format!("the text {:?}", shortened(text, MAX_QUOTED)),
            Form::Bytes(_) => "bytes".to_owned(),
            Form::Word(word) => format!("`{}`", shortened(word, MAX_QUOTED)),
            Form::Struct(Some(name), _) | Form::Tuple(Some(name), _) => {
                format!("`{}(…)`", shortened(&name.text, MAX_QUOTED))
            }
            Form::Struct(None, _) | Form::Tuple(None, _) => "`(…)`".to_owned(),
            Form::List(_) => "a list".to_owned(),
            Form::Map(_) => "a map".to_owned(),
            Form::Bad => return,
        };
        let place = self.head(node);
        self.error(&codes::WRONG_TYPE, place, format!("expected {expected}, found {found}"));
    }

    /// Returns the fields of a form with one of the names in `forms`; a form without a name is taken too if there is
    /// only one.
    pub fn fields<'n>(
        &mut self,
        node: &'n Node,
        expected: &str,
        forms: &[(&'static str, &[&'static str])],
    ) -> Option<Fields<'n>> {
        let (name, fields): (_, &[tree::Field]) = match &node.form {
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
                    let message = format!(
                        "`{}` is not known here: expected {expected}",
                        shortened(&name.text, MAX_QUOTED)
                    );
                    let error = Diagnostic::new(&codes::UNKNOWN_FORM, message)
                        .label(self.span(place), "")
                        .suggest("forms", &name.text, forms.iter().map(|(form, _)| *form));
                    self.tell(error);
                    return None;
                }
            },
        };
        let mut found: Vec<&tree::Field> = Vec::with_capacity(form.1.len().min(fields.len()));
        for field in fields {
            let place = Place { file: self.file, start: field.name.start, end: field.name.end };
            if !form.1.contains(&field.name.text.as_str()) {
                let error = Diagnostic::new(
                    &codes::UNKNOWN_FIELD,
                    format!("`{}` has no field `{}`", form.0, shortened(&field.name.text, MAX_QUOTED)),
                )
                .label(self.span(place), "")
                .suggest("fields", &field.name.text, form.1.iter().copied());
                self.tell(error);
            } else if let Some(first) = found.iter().find(|first| first.name.text == field.name.text) {
                let first = Place { file: self.file, start: first.name.start, end: first.name.end };
                self.duplicate(&format!("field `{}`", field.name.text), place, first);
            } else {
                found.push(field);
            }
        }
        let fields = found.into_iter().map(|field| (field.name.text.as_str(), &field.value)).collect();
        Some(Fields { form: form.0, place: self.head(node), fields })
    }

    /// Tells that a name or field is given twice.
    pub fn duplicate(&mut self, what: &str, place: Place, first: Place) {
        let first = self.span(first);
        let error = self.error(&codes::DUPLICATE, place, format!("{what} is given twice"));
        error.labels[0].message = "again here".into();
        *error = error.clone().label(first, "first here");
    }

    /// Returns a field that must be there, and reports it where it is missing.
    pub fn need<'n>(&mut self, fields: &Fields<'n>, name: &str) -> Option<&'n Node> {
        let found = fields.get(name);
        if found.is_none() {
            let message = format!("`{}` needs a field `{name}`", fields.form);
            self.error(&codes::MISSING_FIELD, fields.place, message);
        }
        found
    }

    /// Reads text.
    pub fn text<'n>(&mut self, node: &'n Node, expected: &str) -> Option<&'n str> {
        if let Form::Text(text, _) = &node.form {
            return Some(text);
        }
        self.wrong(node, expected);
        None
    }

    /// Reads the items of a list; none where it is something else.
    pub fn list<'n>(&mut self, node: &'n Node, expected: &str) -> &'n [Node] {
        if let Form::List(items) = &node.form {
            return items;
        }
        self.wrong(node, expected);
        &[]
    }
}
