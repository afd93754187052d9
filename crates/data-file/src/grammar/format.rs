//! The layout of RON files: spaces, indentation and commas. Lines are broken where they were, and comments stay.

use super::syntax::{check, token_end};

/// The indentation of a bracket's content.
const INDENT: usize = 4;

/// A token, or a comment.
struct Piece<'t> {
    text: &'t str,
    /// Line breaks before it.
    breaks: usize,
    /// Blanks before it, where there is no line break.
    blanks: usize,
}

/// Returns a text in the one layout of RON files: four spaces for each bracket that is open at the end of a line, one
/// space after `,` and `:` and within `{ }`, a comma before a bracket that closes on a line of its own, no blanks at the
/// ends of lines, and at most one empty line. Comments and the breaks of lines stay, as does `\r\n`. `None` for a text
/// that is not RON.
pub fn format(text: &str) -> Option<String> {
    if text.len() > crate::MAX_TEXT || !check(text).0.is_empty() {
        return None;
    }
    let line = if text.contains("\r\n") { "\r\n" } else { "\n" };
    let pieces = pieces(text.strip_prefix('\u{FEFF}').unwrap_or(text));
    let mut out = String::with_capacity(text.len() + text.len() / 8);
    // The indentation of the line on which each open bracket stands.
    let mut open: Vec<usize> = Vec::new();
    let mut indent = 0;
    for (i, piece) in pieces.iter().enumerate() {
        let before = i.checked_sub(1).map(|before| &pieces[before]);
        let closes = matches!(piece.text, ")" | "]" | "}");
        let is_line = |piece: &Piece<'_>| piece.text.starts_with("//");
        let breaks = match before {
            None => 0,
            Some(before) if is_line(before) => piece.breaks.max(1),
            Some(_) => piece.breaks,
        };
        if let Some(before) = before {
            let opened = matches!(before.text, "(" | "[" | "{");
            if breaks > 0 {
                out.push_str(line);
                if breaks > 1 && !opened && !closes {
                    out.push_str(line);
                }
                indent = match (closes, open.last()) {
                    (true, Some(outer)) => *outer,
                    (false, Some(outer)) => outer + INDENT,
                    (_, None) => 0,
                };
                out.extend(std::iter::repeat_n(' ', indent));
            } else if is_line(piece) {
                out.extend(std::iter::repeat_n(' ', piece.blanks.max(1)));
            } else if has_space(before.text, piece) {
                out.push(' ');
            }
        }
        out.push_str(piece.text);
        match piece.text {
            "(" | "[" | "{" => open.push(indent),
            ")" | "]" | "}" => {
                open.pop();
            }
            _ => {}
        }
        // The bracket on the next line closes it.
        let is_code = !is_comment(piece.text) && !matches!(piece.text, "," | "(" | "[" | "{");
        let next = pieces[i + 1..].iter().position(|piece| !is_comment(piece.text)).map(|next| i + 1 + next);
        if let Some(next) = next.filter(|_| is_code && !open.is_empty())
            && matches!(pieces[next].text, ")" | "]" | "}")
            && pieces[i + 1..=next].iter().any(|piece| piece.breaks > 0)
        {
            out.push(',');
        }
    }
    if !out.is_empty() {
        out.push_str(line);
    }
    Some(out)
}

fn is_comment(text: &str) -> bool {
    text.starts_with("//") || text.starts_with("/*")
}

/// Returns whether a space stands between two pieces on one line.
fn has_space(before: &str, piece: &Piece<'_>) -> bool {
    match (before, piece.text) {
        (_, "," | ":") | ("(" | "[", _) | (_, ")" | "]") | ("{", "}") => false,
        ("{", _) | (_, "}") | ("," | ":", _) => true,
        (before, text) if is_comment(before) || is_comment(text) => true,
        (_, "(") => false,
        _ => piece.blanks > 0,
    }
}

/// Splits a text that can be read.
fn pieces(text: &str) -> Vec<Piece<'_>> {
    let mut pieces = Vec::new();
    let mut at = 0;
    loop {
        // Line feeds count within all that RON takes for blanks.
        let rest = &text[at..];
        let blank = rest.find(|c: char| !is_blank(c)).unwrap_or(rest.len());
        let space = &rest[..blank];
        let start = at + blank;
        if start == text.len() {
            return pieces;
        }
        let rest = &text[start..];
        let end = if rest.starts_with("//") {
            start + rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            start + comment_end(rest)
        } else {
            token_end(text, start).unwrap_or(text.len()).max(start + 1)
        };
        let breaks = space.matches('\n').count();
        let piece = text[start..end].trim_end_matches(['\r', ' ', '\t']);
        let piece = if rest.starts_with("//") { piece } else { &text[start..end] };
        pieces.push(Piece { text: piece, breaks, blanks: space.chars().count() });
        at = end;
    }
}

fn is_blank(c: char) -> bool {
    super::syntax::skip_blanks(c.encode_utf8(&mut [0; 4]), 0) > 0
}

/// Returns the length of the comment in `/* */` with which a text begins; such comments nest.
fn comment_end(text: &str) -> usize {
    let (mut depth, mut at) = (0_usize, 0);
    while let Some(next) = text[at..].find(['/', '*']) {
        at += next;
        match text.get(at..at + 2) {
            Some("/*") => depth += 1,
            Some("*/") => depth -= 1,
            _ => {
                at += 1;
                continue;
            }
        }
        at += 2;
        if depth == 0 {
            return at;
        }
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_file_is_laid_out() {
        let rough = "// About.\nPipeline (\n\n  a :1,b:[ 1,2 ],   // one\n\n\n c: {\"x\":(1 ,2)} /* end */\n, d: [R(\"x\",Pass(\nkind:\"k\"\n)),\n],)";
        let smooth = "// About.\nPipeline(\n    a: 1, b: [1, 2],   // one\n\n    c: { \"x\": (1, 2) } /* end */\n    , d: [R(\"x\", Pass(\n        kind: \"k\",\n    )),\n    ],)\n";
        assert_eq!(format(rough).unwrap(), smooth);
        assert_eq!(format(&rough.replace('\n', "\r\n")).unwrap(), smooth.replace('\n', "\r\n"));
    }

    #[test]
    fn what_is_no_ron_is_left_alone() {
        for text in ["P(", "P(a: \"x)", "/* P()", "P(a 1)"] {
            assert_eq!(format(text), None, "{text}");
        }
    }

    /// The tokens and comments without commas before brackets, which layout adds.
    fn content(text: &str) -> Vec<String> {
        let all: Vec<String> = pieces(text).into_iter().map(|piece| piece.text.to_owned()).collect();
        let code = |from: usize| all[from..].iter().find(|text| !is_comment(text));
        let closes = |i: usize| code(i + 1).is_some_and(|next| matches!(&**next, ")" | "]" | "}"));
        (0..all.len()).filter(|&i| all[i] != "," || !closes(i)).map(|i| all[i].clone()).collect()
    }

    proptest! {
        #[test]
        fn layout_keeps_tokens_and_comments_and_is_final(
            parts in prop::collection::vec(
                prop::sample::select(vec![
                    "P(", "(", ")", "[", "]", "{", "}", ",", ":", "\"a\": ", "x: ", "1", "-2.5", "\"ä(\"", "// c\n", "/* d */",
                    "\n", "\r\n", " ", "W", "r#\"\n\"#", "/* e\n f */",
                ]),
                0..30,
            )
        ) {
            let text = format!("P({})", parts.concat());
            if let Some(laid_out) = format(&text) {
                prop_assert_eq!(content(&text), content(&laid_out));
                prop_assert_eq!(format(&laid_out), Some(laid_out.clone()));
            }
        }
    }
}
