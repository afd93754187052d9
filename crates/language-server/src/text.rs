//! Positions of the protocol, which count UTF-16 code units, and bytes of texts.

use lsp_types::{Position, Range, TextDocumentContentChangeEvent};
use std::ops;

/// Returns the bytes at which the lines of a text begin; `\n`, `\r\n` and `\r` end lines.
fn lines(text: &str) -> impl Iterator<Item = usize> {
    let bytes = text.as_bytes();
    let ends =
        move |at: &usize| bytes[*at] == b'\n' || (bytes[*at] == b'\r' && bytes.get(at + 1) != Some(&b'\n'));
    std::iter::once(0).chain((0..bytes.len()).filter(ends).map(|at| at + 1))
}

/// Returns the byte of a position; of one behind the end of its line, that end.
pub(crate) fn offset(text: &str, position: Position) -> usize {
    let Some(start) = lines(text).nth(position.line as usize) else { return text.len() };
    let line = &text[start..];
    let end = line.find(['\n', '\r']).unwrap_or(line.len());
    let mut units = 0;
    for (at, c) in line[..end].char_indices() {
        if units >= position.character as usize {
            return start + at;
        }
        units += c.len_utf16();
    }
    start + end
}

/// Returns the position of a byte.
pub(crate) fn position(text: &str, at: usize) -> Position {
    let at = text.floor_char_boundary(at);
    let (mut line, mut start) = (0, 0);
    for (number, begin) in lines(text).enumerate().take_while(|(_, begin)| *begin <= at) {
        (line, start) = (number, begin);
    }
    Position::new(line as u32, text[start..at].encode_utf16().count() as u32)
}

/// Returns the range of bytes of a text.
pub(crate) fn range(text: &str, bytes: ops::Range<usize>) -> Range {
    let start = position(text, bytes.start);
    // Most ranges are short.
    Range::new(start, if bytes.end > bytes.start { position(text, bytes.end) } else { start })
}

/// Applies what an editor changed; without a range it is the whole text.
pub(crate) fn change(text: &mut String, change: TextDocumentContentChangeEvent) {
    match change.range {
        None => *text = change.text,
        Some(range) => {
            let (start, end) = (offset(text, range.start), offset(text, range.end));
            text.replace_range(start..end.max(start), &change.text);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn positions_count_utf16() {
        let text = "aé\r\n😀b\rc\n";
        for (line, character, at) in
            [(0, 0, 0), (0, 2, 3), (0, 9, 3), (1, 0, 5), (1, 2, 9), (2, 1, 12), (3, 0, 13), (9, 9, 13)]
        {
            assert_eq!(offset(text, Position::new(line, character)), at, "{line}:{character}");
        }
        assert_eq!(position(text, 9), Position::new(1, 2));
        // Within a surrogate pair is behind it.
        assert_eq!(offset(text, Position::new(1, 1)), 9);
    }

    proptest! {
        #[test]
        fn a_position_is_that_of_its_byte(text in "[a\u{e9}\u{1f600}\r\n]{0,20}", at in 0_usize..60) {
            let at = text.floor_char_boundary(at.min(text.len()));
            let found = offset(&text, position(&text, at));
            // Between the two bytes of `\r\n` is the end of that line.
            let end_of_line = text[..at].ends_with('\r') && text[at..].starts_with('\n');
            prop_assert_eq!(found, if end_of_line { at - 1 } else { at });
        }
    }
}
