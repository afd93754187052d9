//! The lines of texts, as errors show them.

use crate::Source;
use codespan_reporting::files::{Error, Files};
use std::ops::Range;
use std::sync::Arc;

/// The longest line that is shown, in bytes; longer ones are cut into parts, each shown like a line.
const MAX_LINE: usize = 400;

/// The texts that errors point into, each looked through once however many errors there are.
#[derive(Debug, Default)]
pub(crate) struct Excerpts {
    texts: Vec<Excerpt>,
}

#[derive(Debug)]
struct Excerpt {
    source: Arc<Source>,
    parts: Vec<Part>,
}

/// A line, or a part of one that is too long to be shown.
#[derive(Clone, Copy, Debug)]
struct Part {
    /// First byte.
    start: usize,
    /// The number of its line, from 1.
    line: usize,
    /// First byte of its line.
    line_start: usize,
}

impl Excerpts {
    /// Adds a text, unless it is there, and returns its index.
    pub(crate) fn add(&mut self, source: &Arc<Source>) -> usize {
        // Copies of one text are known by where it is: to compare texts would take longer than to read one twice.
        if let Some(index) = self.texts.iter().position(|text| Arc::ptr_eq(&text.source, source)) {
            return index;
        }
        let mut parts = Vec::new();
        let mut line_start = 0;
        let lines = source.text.split_inclusive('\n').chain(source.text.ends_with('\n').then_some(""));
        for (index, line) in lines.enumerate() {
            let mut at = 0;
            while at == 0 || at < line.len() {
                parts.push(Part { start: line_start + at, line: index + 1, line_start });
                at = line.floor_char_boundary(at + MAX_LINE).max(at + 1);
            }
            line_start += line.len();
        }
        if parts.is_empty() {
            parts.push(Part { start: 0, line: 1, line_start: 0 });
        }
        self.texts.push(Excerpt { source: Arc::clone(source), parts });
        self.texts.len() - 1
    }

    /// Returns what is marked of a range: all, or what is on its first line where it has more than `lines` of them; of a
    /// line that is shown in parts, what is on its first part.
    pub(crate) fn clipped(&self, id: usize, range: Range<usize>, lines: usize) -> Range<usize> {
        let Ok(text) = self.text(id) else { return range };
        let index = |byte| text.parts.partition_point(|part| part.start <= byte).saturating_sub(1);
        let (first, last) = (index(range.start), index(range.end));
        let of_one_line = text.parts[first].line == text.parts[last].line;
        if first == last || (!of_one_line && last - first < lines) {
            return range;
        }
        // The last character of it, since what ends where another part begins would be marked on both.
        let end = text.source.text.floor_char_boundary(text.parts[first + 1].start - 1);
        range.start..end.max(range.start)
    }

    fn text(&self, id: usize) -> Result<&Excerpt, Error> {
        self.texts.get(id).ok_or(Error::FileMissing)
    }

    fn part(&self, id: usize, index: usize) -> Result<Part, Error> {
        let parts = &self.text(id)?.parts;
        parts.get(index).copied().ok_or(Error::LineTooLarge { given: index, max: parts.len() - 1 })
    }
}

impl<'a> Files<'a> for Excerpts {
    type FileId = usize;
    type Name = &'a str;
    type Source = &'a str;

    fn name(&'a self, id: usize) -> Result<&'a str, Error> {
        Ok(&self.text(id)?.source.name)
    }

    fn source(&'a self, id: usize) -> Result<&'a str, Error> {
        Ok(&self.text(id)?.source.text)
    }

    fn line_index(&self, id: usize, byte: usize) -> Result<usize, Error> {
        Ok(self.text(id)?.parts.partition_point(|part| part.start <= byte).saturating_sub(1))
    }

    fn line_number(&self, id: usize, index: usize) -> Result<usize, Error> {
        Ok(self.part(id, index)?.line)
    }

    fn column_number(&self, id: usize, index: usize, byte: usize) -> Result<usize, Error> {
        let line = self.part(id, index)?.line_start;
        let text = &self.text(id)?.source.text;
        Ok(text[line..text.floor_char_boundary(byte).max(line)].chars().count() + 1)
    }

    fn line_range(&self, id: usize, index: usize) -> Result<Range<usize>, Error> {
        let end = self.part(id, index + 1).map_or(self.text(id)?.source.text.len(), |next| next.start);
        Ok(self.part(id, index)?.start..end)
    }
}
