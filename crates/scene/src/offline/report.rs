//! Reads the files of a scene of an offline renderer, and collects what is said of them: errors, and notes of what is left
//! out, each with file, line and column.

use std::collections::BTreeMap;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use data_file::paths::{OUTSIDE, may_name};
use data_file::{Code, Diagnostic, Diagnostics, Source, Span};
use flate2::read::GzDecoder;
use metrics::decode::read_file;

use crate::budget::Budget;
use crate::codes;
use crate::description::files_in;
use crate::error::SceneError;

/// The most bytes of a file that was compressed by gzip.
const MAX_UNPACKED: u64 = 1 << 30;

/// The most files within each other: one that includes itself is refused, not read until memory ends.
pub(super) const MAX_DEPTH: usize = 32;

/// The most different notes that are kept.
const MAX_NOTES: usize = 1000;

/// The most characters of a name that stand in a note.
const MAX_NAME: usize = 200;

/// The files that were read, and the notes.
pub(super) struct Report<'a> {
    roots: &'a [PathBuf],
    pub(super) budget: &'a Budget,
    pub(super) files: Vec<PathBuf>,
    notes: Vec<Note>,
    /// The index of each note by its text.
    known: BTreeMap<String, usize>,
}

/// A note, where it is first needed, and the number of times.
struct Note {
    text: String,
    first: Span,
    count: usize,
}

/// Returns an error with its place.
pub(super) fn error(code: &'static Code, span: &Span, message: impl Into<String>, label: &str) -> SceneError {
    located(Diagnostic::new(code, message).label(span.clone(), label))
}

/// Returns an error that has its place already.
pub(super) fn located(diagnostic: Diagnostic) -> SceneError {
    Diagnostics(vec![diagnostic]).into()
}

/// Returns the error for a name that nothing has; `what` is the plural of the things that have names.
pub(super) fn unknown<'a>(
    span: &Span,
    (thing, what): (&str, &str),
    name: &str,
    known: impl IntoIterator<Item = &'a str>,
) -> SceneError {
    let name = shortened(name);
    let error = Diagnostic::new(&codes::NAME, format!("there is no {thing} `{name}`"));
    located(error.label(span.clone(), "not found").suggest(what, &name, known))
}

/// Returns a name that is short enough for a message.
pub(super) fn shortened(name: &str) -> String {
    name.chars().take(MAX_NAME).collect()
}

impl<'a> Report<'a> {
    pub(super) fn new(roots: &'a [PathBuf], budget: &'a Budget) -> Report<'a> {
        Report { roots, budget, files: Vec::new(), notes: Vec::new(), known: BTreeMap::new() }
    }

    /// Notes what is left out or replaced, once for all places that need it.
    pub(super) fn note(&mut self, span: &Span, text: impl Into<String>) {
        let text = text.into();
        match self.known.get(&text) {
            Some(index) => self.notes[*index].count += 1,
            None if self.notes.len() < MAX_NOTES => {
                self.known.insert(text.clone(), self.notes.len());
                self.notes.push(Note { text, first: span.clone(), count: 1 });
            }
            None => {}
        }
    }

    /// Returns the notes as sentences.
    pub(super) fn notes(&self) -> Vec<String> {
        let sentence = |Note { text, first, count }: &Note| match count - 1 {
            0 => format!("{first}: {text}"),
            1 => format!("{first} and one more place: {text}"),
            more => format!("{first} and {more} more places: {text}"),
        };
        self.notes.iter().map(sentence).collect()
    }

    /// Counts what is about to be made.
    pub(super) fn take(&self, count: usize, size: usize, span: &Span) -> Result<(), SceneError> {
        self.budget
            .take(count, size)
            .map_err(|problem| SceneError::TooLarge { file: span.to_string(), problem })
    }

    /// Returns the path of the file that the file of `span` names.
    pub(super) fn path(&self, name: &str, span: &Span) -> Result<PathBuf, SceneError> {
        let by = Path::new(&span.source.name);
        let folder = by.parent().unwrap_or(Path::new(""));
        let path = folder.join(name);
        if !may_name(by, &path, self.roots) {
            let message = format!("the file {} {OUTSIDE}", path.display());
            return Err(error(&codes::NAME, span, message, "outside"));
        }
        if path.is_file() {
            return Ok(path);
        }
        let missing = Diagnostic::new(&codes::NAME, format!("there is no file {}", path.display()))
            .label(span.clone(), "not found")
            .note("file names start from the folder of the file that names them");
        let inner = Path::new(name).parent().unwrap_or(Path::new(""));
        let there = files_in(folder, inner, &[""]);
        Err(located(match there.is_empty() {
            true => missing,
            false => missing.suggest("files there", name, there.iter().map(String::as_str)),
        }))
    }

    /// Reads a file that the file of `span` names; one that ends in `.gz` is decompressed.
    pub(super) fn bytes(&mut self, name: &str, span: &Span) -> Result<(PathBuf, Vec<u8>), SceneError> {
        let path = self.path(name, span)?;
        let bytes = self.content(&path).map_err(|problem| {
            error(&codes::FILE, span, format!("{}: cannot be read: {problem}", path.display()), "this file")
        })?;
        Ok((path, bytes))
    }

    fn content(&mut self, path: &Path) -> Result<Vec<u8>, String> {
        let bytes = read_file(path).map_err(|problem| problem.to_string())?;
        self.read(path, bytes.len());
        if path.extension().is_none_or(|ending| ending != "gz") {
            return Ok(bytes);
        }
        let mut unpacked = Vec::new();
        let mut decoder = GzDecoder::new(&bytes[..]).take(MAX_UNPACKED);
        decoder.read_to_end(&mut unpacked).map_err(|problem| problem.to_string())?;
        self.budget.take(unpacked.len(), 1)?;
        Ok(unpacked)
    }

    /// Records a file that was read.
    pub(super) fn read(&mut self, path: &Path, bytes: usize) {
        self.budget.file(path, bytes);
        if !self.files.iter().any(|file| file == path) {
            self.files.push(path.into());
        }
    }

    /// Reads the text of a file that the file of `span` names.
    pub(super) fn text(&mut self, name: &str, span: &Span) -> Result<Arc<Source>, SceneError> {
        let (path, bytes) = self.bytes(name, span)?;
        source(&path, bytes).map_err(|problem| error(&codes::FILE, span, problem, "this file"))
    }

    /// Reads the file of a scene.
    pub(super) fn first(&mut self, path: &Path) -> Result<Arc<Source>, SceneError> {
        let bytes = read_file(path).map_err(|error| match error.kind() {
            io::ErrorKind::NotFound => {
                SceneError::NotFound { spec: path.display().to_string(), nearest: None, known: Vec::new() }
            }
            _ => SceneError::Unreadable { path: path.into(), error },
        })?;
        self.budget.file(path, bytes.len());
        source(path, bytes).map_err(|problem| SceneError::Unreadable {
            path: path.into(),
            error: io::Error::new(io::ErrorKind::InvalidData, problem),
        })
    }
}

/// Returns the text of a file; places in it have 32 bits.
fn source(path: &Path, bytes: Vec<u8>) -> Result<Arc<Source>, String> {
    if u32::try_from(bytes.len()).is_err() {
        return Err(format!("{}: the text is longer than 4 GiB", path.display()));
    }
    match String::from_utf8(bytes) {
        Ok(text) => Ok(Source::new(path.display().to_string(), text)),
        Err(_) => Err(format!("{}: the text is not UTF-8", path.display())),
    }
}
