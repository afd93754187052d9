//! What surrounds a position of a text, for editors: the text may be half typed.

use super::syntax::{closing, skip_blanks, token_end};
use std::ops::Range;

/// A position of a text, and the brackets around it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cursor<'t> {
    /// The brackets that are open, the outermost first.
    pub frames: Vec<Frame<'t>>,
    /// The token that holds the position or ends at it; empty where there is none.
    pub token: Range<usize>,
    /// Whether the token is text in quotes, or the position is in a comment.
    pub within: Within,
}

/// Where a position is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Within {
    /// Between tokens, or in a word or number.
    Code,
    /// In text in quotes.
    Text,
    /// In a comment.
    Comment,
}

/// A bracket that is open at a position.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frame<'t> {
    /// Its byte.
    pub open: usize,
    /// The name of the form whose bracket it is.
    pub name: Option<&'t str>,
    /// The number of the item that the position is in.
    pub index: usize,
    /// The key or field whose value the position is in.
    pub key: Option<&'t str>,
}

/// Returns the content of a text in quotes, as it is written; other tokens as they are.
pub fn unquoted(token: &str) -> &str {
    let inner = token.strip_prefix('"').unwrap_or(token);
    if inner.len() < token.len() { inner.strip_suffix('"').unwrap_or(inner) } else { token }
}

/// Returns the end of a token; of a text whose line has no closing quote, that of the line.
fn end_of(text: &str, at: usize) -> usize {
    let line = || text[at..].find('\n').map_or(text.len(), |end| at + end);
    match token_end(text, at) {
        Some(end) if !text[at..].starts_with('"') || end <= line() => end,
        _ => line(),
    }
}

/// Returns the byte after a comment that begins at `at`, where one does.
fn comment(text: &str, at: usize) -> Option<usize> {
    let rest = &text[at..];
    if rest.starts_with("//") {
        return Some(at + rest.find('\n').unwrap_or(rest.len()));
    }
    rest.starts_with("/*").then(|| {
        let end = skip_blanks(text, at);
        if end == at { text.len() } else { at + rest.find("*/").map_or(end - at, |end| end + 2) }
    })
}

impl<'t> Cursor<'t> {
    /// Looks at a byte of a text.
    pub fn new(text: &'t str, at: usize) -> Cursor<'t> {
        let at = text.floor_char_boundary(at);
        let mut cursor = Cursor { frames: Vec::new(), token: at..at, within: Within::Code };
        let (mut next, mut last) = (0, 0..0);
        loop {
            let blank = text[next..].len() - text[next..].trim_start().len();
            let start = next + blank;
            if start >= at {
                return cursor;
            }
            if let Some(end) = comment(text, start) {
                if at < end || (at == end && text[start..].starts_with("//")) {
                    cursor.within = Within::Comment;
                    return cursor;
                }
                next = end;
                continue;
            }
            let end = end_of(text, start).max(start + 1);
            let is_text = text[start..].starts_with('"');
            let closed = is_text && end > start + 1 && text[..end].ends_with('"');
            let word = text[start..].starts_with(|c: char| c.is_alphanumeric() || c == '_');
            if at < end || (at == end && (word || (is_text && !closed))) {
                cursor.token = start..end;
                cursor.within = if is_text { Within::Text } else { Within::Code };
                return cursor;
            }
            match text.as_bytes()[start] {
                b'(' | b'[' | b'{' => {
                    let name = &text[last.clone()];
                    let named = text.as_bytes()[start] == b'('
                        && name.starts_with(|c: char| c.is_alphabetic() || c == '_');
                    let name = named.then_some(name);
                    cursor.frames.push(Frame { open: start, name, index: 0, key: None });
                }
                b')' | b']' | b'}' => {
                    cursor.frames.pop();
                }
                b',' => {
                    if let Some(frame) = cursor.frames.last_mut() {
                        (frame.index, frame.key) = (frame.index + 1, None);
                    }
                }
                b':' => {
                    if let Some(frame) = cursor.frames.last_mut() {
                        frame.key = Some(unquoted(&text[last.clone()]));
                    }
                }
                _ => {}
            }
            (last, next) = (start..end, end);
        }
    }

    /// Returns the part of the token before a byte, without its quote.
    pub fn prefix(&self, text: &'t str, at: usize) -> &'t str {
        let at = text.floor_char_boundary(at).max(self.token.start);
        let typed = &text[self.token.start..at.min(self.token.end.max(self.token.start))];
        typed.strip_prefix('"').unwrap_or(typed)
    }

    /// Returns the part of the token without quotes.
    pub fn content(&self, text: &str) -> Range<usize> {
        let token = &text[self.token.clone()];
        let inner = unquoted(token);
        let start = self.token.start + usize::from(inner.len() < token.len());
        start..start + inner.len()
    }

    /// Returns the text before the token with all brackets closed, and `value` in place of the token: what can be read
    /// of it shows what may stand there.
    pub(super) fn completed(&self, text: &str, value: &str) -> String {
        let mut completed = format!("{}{value}", &text[..self.token.start]);
        completed.extend(self.frames.iter().rev().map(|frame| closing(&text[frame.open..])));
        completed
    }

    /// Returns whether a key or the name of a field may stand here.
    pub fn at_key(&self, text: &str) -> bool {
        self.frames.last().is_some_and(|frame| frame.key.is_none() && !text[frame.open..].starts_with('['))
    }

    /// Returns the frame that is `up` brackets around the innermost one.
    pub fn frame(&self, up: usize) -> Option<&Frame<'t>> {
        self.frames.len().checked_sub(up + 1).map(|index| &self.frames[index])
    }
}

/// Returns a half-typed text with a quote at the end of each line that lacks one, and with all brackets closed.
pub fn closed(text: &str) -> String {
    let (mut closed, mut open, mut at) = (String::with_capacity(text.len() + 8), Vec::new(), 0);
    while at < text.len() {
        let blank = text[at..].len() - text[at..].trim_start().len();
        let start = at + blank;
        let end = match comment(text, start) {
            Some(end) => end,
            None if start < text.len() => end_of(text, start).max(start + 1),
            None => start,
        };
        closed.push_str(&text[at..end]);
        let token = &text[start..end];
        match token.as_bytes().first() {
            Some(b'"') if token.len() < 2 || !token.ends_with('"') => {
                let end = closed.trim_end_matches(['\r', '\\']).len();
                closed.replace_range(end.., "\"");
            }
            Some(b'(' | b'[' | b'{') => open.push(closing(token)),
            Some(b')' | b']' | b'}') => {
                open.pop();
            }
            _ => {}
        }
        at = end;
    }
    closed.push('\n');
    closed.extend(open.iter().rev());
    closed
}

/// Returns the keys and values between a bracket and the one that closes it, as they are written. What cannot be
/// told apart in a half-typed text is left out.
pub fn entries(text: &str, open: usize) -> Vec<(&str, &str)> {
    let mut found = Vec::new();
    let (mut at, mut depth) = (open + 1, 0_usize);
    let (mut key, mut first, mut last): (Option<&str>, Option<usize>, Range<usize>) = (None, None, 0..0);
    loop {
        at = skip_blanks(text, at);
        let byte = text.as_bytes().get(at).copied();
        let ends = depth == 0 && matches!(byte, None | Some(b')' | b']' | b'}' | b','));
        if ends || byte.is_none() {
            if let (Some(key), Some(first)) = (key.take(), first) {
                found.push((key, &text[first..last.end]));
            }
            if byte != Some(b',') {
                return found;
            }
            (first, at) = (None, at + 1);
            continue;
        }
        let end = comment(text, at).unwrap_or_else(|| end_of(text, at)).max(at + 1);
        match byte {
            Some(b'(' | b'[' | b'{') => depth += 1,
            Some(b')' | b']' | b'}') => depth -= 1,
            Some(b':') if depth == 0 && key.is_none() => {
                key = first.map(|first| unquoted(&text[first..last.end]));
                (first, last, at) = (None, end..end, end);
                continue;
            }
            _ => {}
        }
        first.get_or_insert(at);
        (last, at) = (at..end, end);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The text with `|` at the position.
    fn at(marked: &str) -> (String, usize) {
        let at = marked.find('|').unwrap();
        (marked.replacen('|', "", 1), at)
    }

    #[test]
    fn the_brackets_around_a_position_are_found_in_half_typed_text() {
        let cases = [
            ("P(a: [R(\"|", "P.a#0 [.#0 R.#0", ""),
            ("P(a: {\"x\": Pass(kind: \"ga|\n in: {}", "P.a#0 {.x#0 Pass.kind#0", "ga"),
            ("P(a: 1, // (\n b|: 2)", "P.#1", "b"),
            ("P(a: \"(\", |", "P.#1", ""),
            ("P(/* ( */ q: {\"é\": \"$l|i\"", "P.q#0 {.é#0", "$l"),
            ("|P(", "", ""),
        ];
        for (marked, expected, prefix) in cases {
            let (text, at) = at(marked);
            let cursor = Cursor::new(&text, at);
            let frames = cursor.frames.iter().map(|frame| {
                let name = frame.name.unwrap_or(&text[frame.open..=frame.open]);
                format!("{name}.{}#{}", frame.key.unwrap_or_default(), frame.index)
            });
            assert_eq!(frames.collect::<Vec<_>>().join(" ").replace("(.", "."), expected, "{marked}");
            assert_eq!(cursor.prefix(&text, at), prefix, "{marked}");
        }
        let (text, at) = at("P(a: 1 // no|te\n)");
        assert_eq!(Cursor::new(&text, at).within, Within::Comment);
    }

    #[test]
    fn a_half_typed_text_is_closed() {
        assert_eq!(closed("P(a: \"x\n  b: [R(\"y\", // ("), "P(a: \"x\"\n  b: [R(\"y\", // (\n)])");
    }

    #[test]
    fn entries_are_those_of_one_bracket() {
        let text = "Pass(kind: \"a\", /* , */ in: { \"x\": \"y\" }, set: {\"n\": (1, 2)}, off: Input(\"z\"";
        let found = entries(text, 4);
        let expected = [
            ("kind", "\"a\""),
            ("in", "{ \"x\": \"y\" }"),
            ("set", "{\"n\": (1, 2)}"),
            ("off", "Input(\"z\""),
        ];
        assert_eq!(found, expected);
        assert_eq!(entries(text, text.find('{').unwrap()), [("x", "\"y\"")]);
    }
}
