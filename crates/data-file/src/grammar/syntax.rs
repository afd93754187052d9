//! Syntax errors: where they are, and a text without them.
//!
//! The `ron` crate stops at the first error. What it could not read is taken out of a copy of the text, byte by byte of
//! the same length, and the rest is read again, so that one reading finds the errors of several items. For that, and to
//! point at the bracket that is not closed, this module knows brackets, comments and quotes, and nothing else of RON.

use crate::codes::{self, Code};
use crate::diagnostic::{MAX_QUOTED, shortened};
use ron::error::Error;
use serde::de::IgnoredAny;
use std::borrow::Cow;
use std::ops::Range;

/// Deepest nesting of values: far beyond any file, far below the stack and the recursion limit of the `ron` crate.
pub(super) const MAX_DEPTH: usize = 64;

/// The most syntax errors that are looked for: each reads the text up to it once more.
const MAX_SYNTAX: usize = 20;

/// An error of the text, and the bracket that it is about.
pub(super) struct Complaint {
    pub(super) code: &'static Code,
    pub(super) range: Range<usize>,
    pub(super) message: String,
    pub(super) opened: Option<usize>,
}

/// Returns the errors of a text, and a text of the same length without what is wrong; none where nothing is left to read.
pub(super) fn check(text: &str) -> (Vec<Complaint>, Option<Cow<'_, str>>) {
    let mut errors = Vec::new();
    let mut text = Cow::Borrowed(text);
    if text.starts_with('\u{FEFF}') {
        text.to_mut().replace_range(..3, "   ");
    }
    if let Some(at) = scan(&text, text.len()).too_deep {
        let message = format!("values are nested deeper than {MAX_DEPTH}");
        errors.push(Complaint { code: &codes::NESTING, range: at..at + 1, message, opened: None });
        return (errors, None);
    }
    let options = ron::Options::default().without_recursion_limit();
    while let Err(error) = options.from_str::<IgnoredAny>(&text) {
        let at = offset(&text, error.span.end);
        errors.push(explain(&text, at, &error.code));
        if errors.len() == MAX_SYNTAX || !mend(&mut text, at, &error.code) {
            return (errors, None);
        }
    }
    (errors, Some(text))
}

/// Returns the byte of a position.
fn offset(text: &str, position: ron::error::Position) -> usize {
    let line = text.split_inclusive('\n').take(position.line - 1).map(str::len).sum::<usize>();
    let rest = &text[line..];
    line + rest.char_indices().nth(position.col - 1).map_or(rest.len(), |(at, _)| at)
}

fn explain(text: &str, at: usize, error: &Error) -> Complaint {
    let scan = scan(text, at);
    let open = scan.open.last().copied();
    let close = open.map_or(' ', |open| closing(&text[open..]));
    let here = at..token_end(text, at).unwrap_or(text.len()).max(at);
    let word = word(text, at);
    let complaint = |range, message: &str| Complaint {
        code: &codes::SYNTAX,
        range,
        message: message.to_owned(),
        opened: None,
    };
    if let Some((at, what)) = scan.unclosed {
        return complaint(
            at..at + if what == "comment" { 2 } else { 1 },
            &format!("this {what} is not closed"),
        );
    }
    let next = text[at..].chars().next();
    match (error, next) {
        (Error::InvalidEscape(_), _) => {
            let start = text[..at].rfind('\\').unwrap_or(at);
            complaint(start..at.max(start + 1), "this escape is not known")
        }
        (Error::ExpectedChar, _) => {
            let start = text[..at].rfind('\'').unwrap_or(at);
            let line = text[start..].find('\n').map_or(text.len(), |end| start + end);
            let end = text[start..line].rfind('\'').map_or(line, |end| start + end + 1);
            let end = if end > start + 1 { end } else { line };
            complaint(start..end, "expected one character in quotes; text stands in double quotes")
        }
        (Error::ExpectedByteLiteral, _) => complaint(here, "expected one byte in quotes, such as b'a'"),
        (_, None) => match open {
            Some(open) => complaint(open..open + 1, &format!("this is not closed: expected `{close}`")),
            None => complaint(at..at, "expected a value, found the end of the file"),
        },
        (_, Some(')' | ']' | '}')) if !text[at..].starts_with(close) => {
            let opened = open.or(Some(at)).filter(|_| open.is_some());
            let message = match open {
                Some(_) => format!("expected `{close}` before this"),
                None => "expected a value".to_owned(),
            };
            Complaint { opened, ..complaint(at..at + 1, &message) }
        }
        (Error::ExpectedAttribute | Error::ExpectedAttributeEnd | Error::NoSuchExtension(_), _) => {
            let start = text.find('#').unwrap_or(at);
            let end = text[start..].find(['\n', ']']).map_or(text.len(), |end| start + end);
            let end = text.floor_char_boundary(end.min(start + MAX_QUOTED));
            complaint(start..end, "expected an attribute such as `#![enable(implicit_some)]`")
        }
        _ if is_number(&text[word.clone()]) && (word.start < at || is_number_error(error)) => {
            let message = format!("`{}` is not a number", shortened(&text[word.clone()], MAX_QUOTED));
            complaint(word, &message)
        }
        (Error::ExpectedComma, _) => complaint(here, &format!("expected `,` or `{close}`")),
        (Error::ExpectedMapColon, _) => complaint(here, "expected `:` and a value"),
        (Error::TrailingCharacters, _) => complaint(here, "expected the end of the file"),
        (_, Some(')' | ']' | '}' | ',' | ':')) => complaint(at..at + 1, "expected a value"),
        (Error::ExpectedIdentifier | Error::SuggestRawIdentifier(_), _) => {
            complaint(here, "expected the name of a field")
        }
        (Error::UnexpectedChar(c), _) => {
            // A row of the same is one error: a file of zeros has millions of them.
            let start = if next == Some(*c) { at } else { at - c.len_utf8() };
            let row = text[start..].len() - text[start..].trim_start_matches(*c).len();
            complaint(start..start + row, &format!("`{}` has no meaning here", c.escape_debug()))
        }
        _ => complaint(here, &format!("the text is not RON: {error}")),
    }
}

/// Takes out what could not be read at `at`; `false` where the rest would only be noise.
fn mend(text: &mut Cow<'_, str>, at: usize, error: &Error) -> bool {
    if *error == Error::TrailingCharacters {
        blank(text, at..text.len());
        return true;
    }
    let found = scan(text, at);
    let (Some(open), Some(next)) = (found.open.last(), text[at..].chars().next()) else { return false };
    if found.unclosed.is_some() || (matches!(next, ')' | ']' | '}') && closing(&text[*open..]) != next) {
        return false;
    }
    let at = at.max(found.end);
    let after = skip_blanks(text, token_end(text, at).unwrap_or(text.len()));
    let is_item = closing(&text[*open..]) == ']' || text[after..].starts_with(':');
    let forgotten = *error == Error::ExpectedComma && !matches!(next, ')' | ']' | '}' | ':') && is_item;
    if forgotten && found.end < at && text.as_bytes()[found.end].is_ascii_whitespace() {
        text.to_mut().replace_range(found.end..found.end + 1, ",");
        return true;
    }
    let item = found.item..item_end(text, at);
    let empty = text[item.clone()].trim().is_empty();
    blank(text, item);
    !empty
}

fn blank(text: &mut Cow<'_, str>, range: Range<usize>) {
    let blanks: String = text[range.clone()].bytes().map(|b| if b == b'\n' { '\n' } else { ' ' }).collect();
    text.to_mut().replace_range(range, &blanks);
}

pub(super) fn closing(open: &str) -> char {
    match open.as_bytes().first() {
        Some(b'(') => ')',
        Some(b'[') => ']',
        _ => '}',
    }
}

/// What stands before a byte of a text.
struct Scan {
    /// The brackets that are open.
    open: Vec<usize>,
    /// Where the item within the innermost of them begins.
    item: usize,
    /// The end of the last token.
    end: usize,
    too_deep: Option<usize>,
    /// A comment or a text without an end.
    unclosed: Option<(usize, &'static str)>,
}

fn scan(text: &str, until: usize) -> Scan {
    let mut items = vec![0];
    let mut found = Scan { open: Vec::new(), item: 0, end: 0, too_deep: None, unclosed: None };
    loop {
        let at = skip_blanks(text, found.end);
        if text[at..].starts_with("/*") {
            found.unclosed = Some((at, "comment"));
        }
        if at >= until || found.unclosed.is_some() {
            found.item = items.last().copied().unwrap_or(0);
            return found;
        }
        match text.as_bytes()[at] {
            b'(' | b'[' | b'{' => {
                if found.open.len() > MAX_DEPTH {
                    found.too_deep.get_or_insert(at);
                }
                found.open.push(at);
                items.push(at + 1);
            }
            b')' | b']' | b'}' => {
                found.open.pop();
                items.truncate(items.len().saturating_sub(1).max(1));
            }
            b',' => *items.last_mut().expect("the root") = at + 1,
            _ => {}
        }
        match token_end(text, at) {
            Some(end) => found.end = end,
            None => found.unclosed = Some((at, "text")),
        }
    }
}

/// Returns the end of the item that `at` is in, with its comma.
fn item_end(text: &str, mut at: usize) -> usize {
    let mut depth = 0;
    loop {
        at = skip_blanks(text, at);
        match text.as_bytes().get(at) {
            None => return text.len(),
            Some(b'(' | b'[' | b'{') => depth += 1,
            Some(b')' | b']' | b'}') if depth == 0 => return at,
            Some(b')' | b']' | b'}') => depth -= 1,
            Some(b',') if depth == 0 => return at + 1,
            Some(_) => {}
        }
        at = token_end(text, at).unwrap_or(text.len());
    }
}

/// Returns the byte at or after `at`, which is between two tokens, at which the next token begins: past blanks and
/// comments, but not past a comment without an end.
pub fn skip_blanks(text: &str, mut at: usize) -> usize {
    let blank = |c: char| {
        matches!(
            c,
            ' ' | '\t'..='\r' | '\u{85}' | '\u{200E}' | '\u{200F}' | '\u{2028}' | '\u{2029}' | '\u{FEFF}'
        )
    };
    loop {
        at = text.len() - text[at..].trim_start_matches(blank).len();
        let rest = &text[at..];
        if rest.starts_with("//") {
            at += rest.find('\n').unwrap_or(rest.len());
        } else if rest.starts_with("/*") {
            let (mut end, mut depth) = (2, 1);
            while depth > 0 {
                let Some(next) = rest[end..].find(['/', '*']) else { return at };
                end += next;
                let mark = rest[end..].get(..2);
                depth += i32::from(mark == Some("/*")) - i32::from(mark == Some("*/"));
                end += if matches!(mark, Some("/*" | "*/")) { 2 } else { 1 };
            }
            at += end;
        } else {
            return at;
        }
    }
}

/// Returns the end of the token that begins at `at`; none where it is a text without an end.
pub(super) fn token_end(text: &str, at: usize) -> Option<usize> {
    let rest = &text[at..];
    let word = rest.find(|c: char| !(c == '_' || c.is_alphanumeric())).unwrap_or(rest.len());
    let quoted = &rest[word..];
    match &rest[..word] {
        "r" | "br" if quoted.trim_start_matches('#').starts_with('"') => {
            let hashes = quoted.find('"')?;
            let close = format!("\"{}", &quoted[..hashes]);
            let content = at + word + hashes + 1;
            return Some(content + text[content..].find(&close)? + close.len());
        }
        "" | "b" if quoted.starts_with('"') => {
            let mut end = 1;
            while let Some(next) = quoted[end..].find(['"', '\\']) {
                end += next + 1;
                if quoted.as_bytes()[end - 1] == b'"' {
                    return Some(at + word + end);
                }
                end += quoted[end..].chars().next().map_or(0, char::len_utf8);
            }
            return None;
        }
        "" | "b" if quoted.starts_with('\'') => {
            let mut inner = quoted[1..].chars();
            let first = inner.next();
            let skipped = if first == Some('\\') { inner.next() } else { None };
            let from = 1 + first.map_or(0, char::len_utf8) + skipped.map_or(0, char::len_utf8);
            let escape =
                quoted[from..].find('\'').filter(|end| *end == 0 || (skipped.is_some() && *end < 12));
            return Some(at + word + escape.map_or(1, |end| from + end + 1));
        }
        "" => {}
        _ => return Some(at + word),
    }
    Some(at + rest.chars().next().map_or(0, char::len_utf8))
}

/// Returns the word or number that `at` is in.
fn word(text: &str, at: usize) -> Range<usize> {
    let part = |c: char| c == '_' || c == '.' || c == '+' || c == '-' || c.is_alphanumeric();
    let start = text[..at].trim_end_matches(part).len();
    start..text.len() - text[at..].trim_start_matches(part).len()
}

fn is_number(word: &str) -> bool {
    word.trim_start_matches(['+', '-', '.']).starts_with(|c: char| c.is_ascii_digit() || c == '_')
}

fn is_number_error(error: &Error) -> bool {
    use Error::{ExpectedFloat, ExpectedInteger, FloatUnderscore, IntegerOutOfBounds, UnderscoreAtBeginning};
    matches!(
        error,
        ExpectedFloat | ExpectedInteger | FloatUnderscore | IntegerOutOfBounds | UnderscoreAtBeginning
    ) || matches!(error, Error::InvalidIntegerDigit { .. })
}

/// Returns the part of a text without blanks and comments around it.
pub(super) fn trimmed(text: &str) -> &str {
    let start = skip_blanks(text, 0);
    let text = text[start..].trim_end();
    if !text.contains('/') {
        return text;
    }
    let (mut at, mut end) = (0, 0);
    while at < text.len() {
        end = token_end(text, at).unwrap_or(text.len()).max(at + 1);
        at = skip_blanks(text, end);
    }
    &text[..end.min(text.len())]
}
