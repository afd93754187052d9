//! Errors as part of the product: what was wrong, where, what was expected, the nearest name.

use crate::codes::{self, Code};
use crate::excerpt::Excerpts;
use codespan_reporting::diagnostic as codespan;
use codespan_reporting::term;
use serde_json::json;
use std::borrow::Cow;
use std::fmt;
use std::sync::Arc;

/// The most errors that are shown of a file, and that its text is read on for: more than anyone mends at a time.
pub(crate) const MAX_ERRORS: usize = 100;

/// The most lines over which a place is marked; of one that has more, the first is shown.
const MAX_LINES: usize = 100;

/// The longest name that is compared with others, in characters: the time grows with the square.
const MAX_COMPARED: usize = 200;

/// The most names that one that is wrong is compared with: a file may have many of both.
const MAX_KNOWN: usize = 1024;

/// The most characters of a name or a text that stand in a message.
pub(crate) const MAX_QUOTED: usize = 80;

/// The most characters of a message or a note that are shown, whatever names they hold.
const MAX_MESSAGE: usize = 4000;

/// A file's name and text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// As shown to the user: a path relative to the root, such as `pipelines/ism.ron`.
    pub name: String,
    /// The text.
    pub text: String,
}

/// A range of bytes of a source.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Span {
    /// The file.
    pub source: Arc<Source>,
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

/// A place, and what is to be said of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    /// The place.
    pub span: Span,
    /// What is there.
    pub message: String,
}

/// How much is wrong.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Something that a user may want to know.
    Note,
    /// Something that is likely not meant.
    Warning,
    /// Something with which nothing runs.
    #[default]
    Error,
}

impl fmt::Display for Severity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Severity::Note => "note",
            Severity::Warning => "warning",
            Severity::Error => "error",
        })
    }
}

/// One error, or one warning.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// A stable code, such as `E012`.
    pub code: &'static str,
    /// How much is wrong.
    pub severity: Severity,
    /// What is wrong, in one line.
    pub message: String,
    /// Where; the first is the main place, others the other ends of wires.
    pub labels: Vec<Label>,
    /// What to do: the nearest name, what was expected.
    pub notes: Vec<String>,
}

/// All errors of a file, in the order of their places.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Diagnostics(pub Vec<Diagnostic>);

impl Source {
    /// Creates a source of this name and text.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Arc<Source> {
        Arc::new(Source { name: name.into(), text: text.into() })
    }
}

impl Span {
    /// Returns the line and column of the first byte, both from 1; the column counts characters.
    pub fn line_column(&self) -> (usize, usize) {
        let mut start = (self.start as usize).min(self.source.text.len());
        while !self.source.text.is_char_boundary(start) {
            start -= 1;
        }
        let before = &self.source.text[..start];
        let line_start = before.rfind('\n').map_or(0, |at| at + 1);
        (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
    }
}

impl Span {
    /// Returns the place behind the last byte.
    fn end(&self) -> Span {
        Span { start: self.end, ..self.clone() }
    }
}

impl fmt::Display for Span {
    /// Writes `file:line:column`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (line, column) = self.line_column();
        write!(f, "{}:{line}:{column}", self.source.name)
    }
}

impl Diagnostic {
    /// Creates an error without a place yet.
    pub fn new(code: &'static Code, message: impl Into<String>) -> Diagnostic {
        Diagnostic {
            code: code.code,
            severity: Severity::Error,
            message: message.into(),
            labels: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// Creates what is no error.
    pub fn warning(code: &'static Code, severity: Severity, message: impl Into<String>) -> Diagnostic {
        Diagnostic { severity, ..Diagnostic::new(code, message) }
    }

    /// Notes that a name at `span` means the file `own` beside the one that names it, and could mean `other`, of a root.
    pub fn shadowed(name: &str, own: &str, other: &str, span: Span) -> Diagnostic {
        let message = format!("`{name}` means `{own}`, and there is `{other}` too");
        Diagnostic::warning(&codes::SHADOWED, Severity::Note, message)
            .label(span, "named here")
            .note("a file beside the one that names it comes before those of the roots")
    }

    /// Returns it for programs: code, severity, message, the main place, all places with what is there, and advice.
    pub fn to_json(&self) -> serde_json::Value {
        let labels = self.labels.iter().map(|label| {
            let ((line, column), (end_line, end_column)) =
                (label.span.line_column(), label.span.end().line_column());
            json!({
                "file": label.span.source.name,
                "line": line,
                "column": column,
                "end_line": end_line,
                "end_column": end_column,
                "message": label.message,
            })
        });
        let labels: Vec<serde_json::Value> = labels.collect();
        let main = |key: &str| labels.first().map_or(&serde_json::Value::Null, |label| &label[key]);
        json!({
            "code": self.code,
            "severity": self.severity.to_string(),
            "message": self.message,
            "file": main("file"),
            "line": main("line"),
            "column": main("column"),
            "labels": labels,
            "help": self.notes,
        })
    }

    /// Adds a place; the first is the main one.
    pub fn label(mut self, span: Span, message: impl Into<String>) -> Diagnostic {
        self.labels.push(Label { span, message: message.into() });
        self
    }

    /// Adds what to do.
    pub fn note(mut self, note: impl Into<String>) -> Diagnostic {
        self.notes.push(note.into());
        self
    }

    /// Adds `did you mean …?`, where a known name is near, and the names there are.
    pub fn suggest<'a>(
        mut self,
        what: &str,
        wrong: &str,
        known: impl IntoIterator<Item = &'a str>,
    ) -> Diagnostic {
        let mut known: Vec<&str> = known.into_iter().collect();
        if known.is_empty() {
            self.notes.push(format!("there are no {what}"));
            return self;
        }
        let (all, shown) = (known.len(), 12);
        known.truncate(MAX_KNOWN);
        if let Some(near) = nearest(wrong, known.iter().copied()) {
            self.notes.push(format!("did you mean `{near}`?"));
        }
        if all > shown {
            let likeness = |name: &str| match is_comparable(wrong) && is_comparable(name) {
                true => strsim::jaro_winkler(wrong, name),
                false => 0.0,
            };
            let mut likely: Vec<_> = known.iter().map(|name| (likeness(name), *name)).collect();
            likely.sort_by(|(a, _), (b, _)| b.total_cmp(a));
            known = likely.into_iter().take(shown).map(|(_, name)| name).collect();
        }
        let rest = if all > shown { format!(", and {} more", all - shown) } else { String::new() };
        let known: Vec<_> = known.into_iter().map(|name| shortened(name, MAX_QUOTED)).collect();
        self.notes.push(format!("{what}: {}{rest}", known.join(", ")));
        self
    }
}

/// Returns the known name nearest to one that is wrong, where any is near enough to be meant.
pub fn nearest<'a>(wrong: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // One edit in three characters, none in a single one; a name that is a part of the other one is near as well.
    let limit = match wrong.chars().count() {
        0 | 1 => 0,
        count => (count / 3).max(1),
    };
    near(wrong, known, limit)
}

/// As [`nearest`], for a name that stands alone, as one on the command line: more of it may be wrong.
pub fn nearest_of_few<'a>(wrong: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let limit = match wrong.chars().count() {
        0 | 1 => 0,
        count => count.div_ceil(3),
    };
    near(wrong, known, limit)
}

/// Returns the known name that is fewest edits away; two letters that changed places are one.
fn near<'a>(wrong: &str, known: impl IntoIterator<Item = &'a str>, limit: usize) -> Option<&'a str> {
    if !is_comparable(wrong) {
        return None;
    }
    let lower = wrong.to_lowercase();
    let distance = |name: &str| {
        if !is_comparable(name) {
            return None;
        }
        let edits = strsim::damerau_levenshtein(&lower, &name.to_lowercase());
        let part = lower.len() >= 3 && (name.contains(wrong) || (name.len() >= 3 && wrong.contains(name)));
        if edits <= limit { Some((0, edits)) } else { part.then_some((1, edits)) }
    };
    known.into_iter().filter_map(|name| Some((distance(name)?, name))).min_by_key(|(d, _)| *d).map(|(_, n)| n)
}

/// Returns whether a name is short enough to be compared with others.
fn is_comparable(name: &str) -> bool {
    name.len() <= MAX_COMPARED
}

/// Returns the first `most` characters of a text, with `…` behind them where there are more.
pub(crate) fn shortened(text: &str, most: usize) -> Cow<'_, str> {
    match text.char_indices().nth(most) {
        Some((end, _)) => Cow::Owned(format!("{}…", &text[..end])),
        None => Cow::Borrowed(text),
    }
}

/// Returns a text for a terminal: control characters, which could move its cursor or change its title, and those that
/// reverse the order of letters are written as `\u001b`, as JSON writes them. Line feeds and tabs stay.
pub fn visible(text: &str) -> Cow<'_, str> {
    let acts = |c: char| {
        (c.is_control() && !matches!(c, '\n' | '\t'))
            || matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
    };
    if !text.contains(acts) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len());
    for c in text.replace("\r\n", "\n").chars() {
        match acts(c) {
            true => out.push_str(&format!("\\u{:04x}", u32::from(c))),
            false => out.push(c),
        }
    }
    Cow::Owned(out)
}

impl Diagnostics {
    /// Returns the text shown to the user: each error with its code, file, line, column, the text with a caret, the
    /// other end where there is one, and advice.
    pub fn render(&self, color: bool) -> String {
        let mut out =
            if color { term::termcolor::Buffer::ansi() } else { term::termcolor::Buffer::no_color() };
        let config = term::Config::default();
        let mut files = Excerpts::default();
        for diagnostic in self.0.iter().take(MAX_ERRORS) {
            let mut labels = Vec::with_capacity(diagnostic.labels.len());
            for (i, label) in diagnostic.labels.iter().enumerate() {
                let id = files.add(&label.span.source);
                let style =
                    if i == 0 { codespan::LabelStyle::Primary } else { codespan::LabelStyle::Secondary };
                let range = label.span.start as usize..label.span.end as usize;
                let range = files.clipped(id, range, MAX_LINES);
                labels.push(
                    codespan::Label::new(style, id, range)
                        .with_message(shortened(&label.message, MAX_MESSAGE)),
                );
            }
            let severity = match diagnostic.severity {
                Severity::Note => codespan::Severity::Note,
                Severity::Warning => codespan::Severity::Warning,
                Severity::Error => codespan::Severity::Error,
            };
            let shown = codespan::Diagnostic::new(severity)
                .with_code(diagnostic.code)
                .with_message(shortened(&diagnostic.message, MAX_MESSAGE))
                .with_labels(labels)
                .with_notes(
                    diagnostic.notes.iter().map(|n| shortened(n, MAX_MESSAGE).into_owned()).collect(),
                );
            // Writing to memory does not fail, and every label is within its file.
            if term::emit_to_write_style(&mut out, &config, &files, &shown).is_err() {
                return self
                    .0
                    .iter()
                    .map(|d| format!("{}[{}]: {}\n", d.severity, d.code, d.message))
                    .collect();
            }
        }
        let mut text = String::from_utf8_lossy(out.as_slice()).trim_end().to_owned();
        let more = self.0.len().saturating_sub(MAX_ERRORS);
        if more > 0 {
            text.push_str(&format!("\n\nand {more} more errors"));
        }
        text
    }

    /// Returns each for programs: see [`Diagnostic::to_json`].
    pub fn to_json(&self) -> serde_json::Value {
        self.0.iter().map(Diagnostic::to_json).collect()
    }

    /// Sorts by place, and drops what is said twice.
    pub fn sorted(mut list: Vec<Diagnostic>) -> Diagnostics {
        let key = |d: &Diagnostic| d.labels.first().map(|l| (l.span.source.name.clone(), l.span.start));
        list.sort_by_cached_key(key);
        list.dedup();
        Diagnostics(list)
    }
}

impl From<Diagnostic> for Diagnostics {
    fn from(diagnostic: Diagnostic) -> Diagnostics {
        Diagnostics(vec![diagnostic])
    }
}

impl fmt::Display for Diagnostics {
    /// Writes each error with file, line, column, the text, and a caret.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.render(false))
    }
}

impl std::error::Error for Diagnostics {}

/// A place in one of several files: a span without its text, for descriptions that keep many.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Place {
    /// Index into [`Sources`].
    pub file: u32,
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Place {
    /// Returns the part of this place from byte `from` on, `len` bytes long.
    pub fn part(self, from: usize, len: usize) -> Place {
        let start = self.start + from as u32;
        Place { file: self.file, start, end: start + len as u32 }
    }
}

/// The files that places point into.
#[derive(Clone, Debug, Default)]
pub struct Sources(pub Vec<Arc<Source>>);

impl Sources {
    /// Returns the span of a place.
    pub fn span(&self, place: Place) -> Span {
        Span { source: Arc::clone(&self.0[place.file as usize]), start: place.start, end: place.end }
    }

    /// Adds a file and returns its index.
    pub fn add(&mut self, source: Arc<Source>) -> u32 {
        self.0.push(source);
        self.0.len() as u32 - 1
    }
}
