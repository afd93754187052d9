//! Reads the brackets in doc comments: `[default: 1.0, max: 4.0]`.

use std::ops::Range;

/// An error in a bracket, at a range of the doc text.
pub(crate) struct Problem {
    pub(crate) range: Range<usize>,
    pub(crate) message: String,
    pub(crate) note: Option<String>,
}

impl Problem {
    pub(crate) fn new(range: Range<usize>, message: impl Into<String>) -> Self {
        Problem { range, message: message.into(), note: None }
    }

    pub(crate) fn note(mut self, note: impl Into<String>) -> Self {
        self.note = Some(note.into());
        self
    }
}

/// A value as written.
#[derive(Clone, Debug)]
pub(crate) enum Literal {
    Bool(bool),
    /// A number, as written.
    Number(String),
    Text(String),
    List(Vec<(Literal, Range<usize>)>),
}

/// Reads the words and values of a bracket.
pub(crate) struct Reader<'a> {
    pub(crate) text: &'a str,
    pub(crate) at: usize,
}

impl<'a> Reader<'a> {
    /// Reads `text` from byte `at` on.
    pub(crate) fn new(text: &'a str, at: usize) -> Self {
        Reader { text, at }
    }

    /// Skips space and gives the character there.
    pub(crate) fn skip(&mut self) -> Option<char> {
        let rest = &self.text[self.at..];
        self.at += rest.len() - rest.trim_start().len();
        self.text[self.at..].chars().next()
    }

    /// Where the next character stands.
    pub(crate) fn here(&self) -> Range<usize> {
        let len = self.text[self.at..].chars().next().map_or(0, char::len_utf8);
        if len == 0 { self.at.saturating_sub(1)..self.at } else { self.at..self.at + len }
    }

    /// Steps over `c`, if it is next.
    pub(crate) fn accept(&mut self, c: char) -> bool {
        let found = self.skip() == Some(c);
        if found {
            self.at += c.len_utf8();
        }
        found
    }

    /// Reads a word or a number; empty where neither is next.
    pub(crate) fn word(&mut self) -> (String, Range<usize>) {
        self.skip();
        let rest = &self.text[self.at..];
        let len = rest
            .find(|c: char| !(c.is_alphanumeric() || matches!(c, '_' | '.' | '+' | '-')))
            .unwrap_or(rest.len());
        let range = self.at..self.at + len;
        self.at += len;
        (rest[..len].to_owned(), range)
    }

    /// Reads a value; lists may stand in lists once.
    pub(crate) fn literal(&mut self, depth: u32) -> Result<(Literal, Range<usize>), Problem> {
        let first = self.skip();
        let start = self.at;
        match first {
            Some(open @ ('[' | '(')) if depth < 2 => {
                self.at += 1;
                let close = if open == '[' { ']' } else { ')' };
                let mut items = Vec::new();
                while !self.accept(close) {
                    items.push(self.literal(depth + 1)?);
                    if !self.accept(',') && self.skip() != Some(close) {
                        return Err(Problem::new(self.here(), format!("expected `,` or `{close}`")));
                    }
                }
                Ok((Literal::List(items), start..self.at))
            }
            Some('"') => match self.text[start + 1..].find('"') {
                Some(len) => {
                    self.at = start + len + 2;
                    Ok((Literal::Text(self.text[start + 1..start + 1 + len].to_owned()), start..self.at))
                }
                None => Err(Problem::new(start..self.text.len(), "a quote that does not end")),
            },
            _ => {
                let (word, range) = self.word();
                match word.as_str() {
                    "true" => Ok((Literal::Bool(true), range)),
                    "false" => Ok((Literal::Bool(false), range)),
                    number if number.parse::<f64>().is_ok_and(f64::is_finite) => {
                        Ok((Literal::Number(word), range))
                    }
                    "" => Err(Problem::new(self.here(), "expected a value")),
                    other => Err(Problem::new(range, format!("`{other}` is not a value"))
                        .note(format!("a word wants quotes: \"{other}\""))),
                }
            }
        }
    }
}
