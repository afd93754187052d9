//! Splits the text of a pbrt-v4 file into words, quoted strings, brackets and numbers, each with its place.
//!
//! The crate `pbrt4` (0.2) also parses this format, but its errors and values have no places, and it needs a second version of
//! glam.

use std::sync::Arc;

use data_file::{Source, Span};

use crate::codes;
use crate::error::SceneError;
use crate::offline::report::{error, shortened};

/// A part of the text.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token {
    /// A word that is not quoted, such as a directive or a number.
    Word(String),
    /// The content of a quoted string.
    Quoted(String),
    /// `[`
    Open,
    /// `]`
    Close,
}

/// A token and its place.
pub(super) type Found = (Token, Span);

/// The tokens of one file.
pub(super) struct Tokens {
    source: Arc<Source>,
    at: usize,
    /// A token that was looked at and not taken.
    next: Option<Found>,
}

impl Tokens {
    pub(super) fn new(source: Arc<Source>) -> Tokens {
        Tokens { source, at: 0, next: None }
    }

    pub(super) fn span(&self, start: usize, end: usize) -> Span {
        Span { source: Arc::clone(&self.source), start: start as u32, end: end as u32 }
    }

    /// Returns the next token without taking it.
    pub(super) fn peek(&mut self) -> Result<Option<&Found>, SceneError> {
        if self.next.is_none() {
            self.next = self.read()?;
        }
        Ok(self.next.as_ref())
    }

    /// Takes the next token.
    pub(super) fn take(&mut self) -> Result<Option<Found>, SceneError> {
        match self.next.take() {
            Some(found) => Ok(Some(found)),
            None => self.read(),
        }
    }

    fn read(&mut self) -> Result<Option<Found>, SceneError> {
        let source = Arc::clone(&self.source);
        let text = source.text.as_bytes();
        loop {
            match text.get(self.at) {
                Some(b' ' | b'\t' | b'\r' | b'\n') => self.at += 1,
                Some(b'#') => {
                    let line = text[self.at..].iter().position(|byte| *byte == b'\n');
                    self.at = line.map_or(text.len(), |length| self.at + length);
                }
                _ => break,
            }
        }
        let start = self.at;
        let Some(first) = text.get(start) else { return Ok(None) };
        let token = match first {
            b'[' | b']' => {
                self.at += 1;
                if *first == b'[' { Token::Open } else { Token::Close }
            }
            b'"' => self.quoted(&source.text)?,
            _ => {
                let is_end =
                    |byte: &u8| matches!(byte, b' ' | b'\t' | b'\r' | b'\n' | b'[' | b']' | b'"' | b'#');
                let length = text[start..].iter().position(is_end);
                self.at = length.map_or(text.len(), |length| start + length);
                Token::Word(source.text[start..self.at].to_owned())
            }
        };
        Ok(Some((token, self.span(start, self.at))))
    }

    fn quoted(&mut self, text: &str) -> Result<Token, SceneError> {
        let start = self.at;
        let mut content = String::new();
        let mut characters = text[start + 1..].char_indices();
        while let Some((at, character)) = characters.next() {
            let character = match character {
                '"' => {
                    self.at = start + 1 + at + 1;
                    return Ok(Token::Quoted(content));
                }
                '\n' => break,
                '\\' => match characters.next() {
                    Some((_, 'n')) => '\n',
                    Some((_, 't')) => '\t',
                    Some((_, escaped @ ('"' | '\\'))) => escaped,
                    _ => {
                        let place = self.span(start + 1 + at, start + 2 + at);
                        let problem = "expected \\n, \\t, \\\" or \\\\ behind a backslash";
                        return Err(error(&codes::FORMAT, &place, problem, "here"));
                    }
                },
                other => other,
            };
            content.push(character);
        }
        let place = self.span(start, start + 1);
        Err(error(&codes::FORMAT, &place, "the string has no end in its line", "begins here"))
    }
}

/// Returns the number that a word stands for.
pub(super) fn number(word: &str, span: &Span) -> Result<f64, SceneError> {
    let number: Option<f64> = word.parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| {
        error(
            &codes::VALUE,
            span,
            format!("expected a finite number, found `{}`", shortened(word)),
            "no number",
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(text: &str) -> Vec<(Token, usize)> {
        let mut tokens = Tokens::new(Source::new("a.pbrt", text));
        let mut found = Vec::new();
        while let Some((token, span)) = tokens.take().expect("tokens") {
            found.push((token, span.start as usize));
        }
        found
    }

    #[test]
    fn tokens_have_their_places() {
        let word = |text: &str| Token::Word(text.into());
        let quoted = |text: &str| Token::Quoted(text.into());
        let expected = vec![
            (word("Shape"), 0),
            (quoted("a \"b\\"), 6),
            (Token::Open, 15),
            (word("-1e3"), 16),
            (Token::Close, 20),
            (word("x"), 28),
        ];
        assert_eq!(all("Shape \"a \\\"b\\\\\"[-1e3] # no \nx"), expected);
        assert_eq!(all("# é"), vec![]);
    }

    #[test]
    fn strings_end_in_their_line() {
        for (text, place) in
            [("\"abc", "a.pbrt:1:1"), ("x\n \"a\nb\"", "a.pbrt:2:2"), ("\"a\\q\"", "a.pbrt:1:3")]
        {
            let mut tokens = Tokens::new(Source::new("a.pbrt", text));
            let error = loop {
                match tokens.take() {
                    Ok(Some(_)) => {}
                    Ok(None) => panic!("{text} is read"),
                    Err(error) => break error.to_string(),
                }
            };
            assert!(error.contains(place) && error.contains("error[C006]"), "{error}");
        }
    }
}
