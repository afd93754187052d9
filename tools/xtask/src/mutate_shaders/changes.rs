//! The small changes of WGSL that mutation testing tries.

use std::ops::Range;

/// A small change of a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Change {
    /// The bytes that it replaces.
    pub at: Range<usize>,
    /// What takes their place.
    pub new: String,
}

/// Operators between spaces, and what each is replaced by.
const OPERATORS: &[(&str, &[&str])] = &[
    ("<", &["<=", ">"]),
    ("<=", &["<"]),
    (">", &[">=", "<"]),
    (">=", &[">"]),
    ("==", &["!="]),
    ("!=", &["=="]),
    ("&&", &["||"]),
    ("||", &["&&"]),
    ("+", &["-"]),
    ("-", &["+"]),
    ("*", &["/"]),
    ("/", &["*"]),
    ("%", &["/"]),
    ("<<", &[">>"]),
    (">>", &["<<"]),
    ("+=", &["-="]),
    ("-=", &["+="]),
    ("*=", &["/="]),
    ("/=", &["*="]),
];

/// Functions, and what is called in place of each.
const FUNCTIONS: &[(&str, &str)] = &[
    ("min", "max"),
    ("max", "min"),
    ("floor", "ceil"),
    ("ceil", "floor"),
    ("any", "all"),
    ("all", "any"),
    ("atomicMin", "atomicMax"),
    ("atomicMax", "atomicMin"),
];

/// Components of vectors, and what is read in place of each.
const COMPONENTS: &[(&str, &str)] = &[("x", "y"), ("y", "x"), ("z", "x")];

/// Returns all changes of a WGSL file: of operators, functions, components, indices, signs and numbers in its code. Directives,
/// attributes, types and the declarations of globals and structs stay as they are.
pub fn changes(text: &str) -> Vec<Change> {
    let code = code(text);
    let mut found = Vec::new();
    let mut at = 0;
    while at < code.len() {
        let length = token(&code[at..]).max(1);
        let (before, word) = (at.checked_sub(1).map_or(b' ', |i| code[i]), &code[at..at + length]);
        let after = *code.get(at + length).unwrap_or(&b' ');
        let word = std::str::from_utf8(word).unwrap_or(" ");
        let mut replace = |new: &str| found.push(Change { at: at..at + length, new: new.to_owned() });
        if let Some(c) = word.bytes().next().filter(u8::is_ascii_alphanumeric) {
            let in_place = |of: &'static [(&str, &str)]| of.iter().find(|(old, _)| *old == word);
            if c.is_ascii_digit() {
                number(word).iter().for_each(|new| replace(new));
            } else if after == b'(' && before != b'.' {
                in_place(FUNCTIONS).iter().for_each(|(_, new)| replace(new));
            } else if before == b'.' {
                in_place(COMPONENTS).iter().for_each(|(_, new)| replace(new));
            } else if before == b'[' && after == b']' && at >= 2 && is_word(code[at - 2]) {
                replace(&format!("{word} + 1"));
            }
        } else if before == b' ' && after == b' ' {
            let new = OPERATORS.iter().find(|(old, _)| *old == word).map_or(&[][..], |(_, new)| new);
            new.iter().for_each(|new| replace(new));
        } else if word == "-" && (before == b' ' || before == b'(') && (is_word(after) || after == b'(') {
            replace("");
        }
        at += length;
    }
    found
}

/// A number that is another: the next integer; a quarter more, but 0 and 1 for each other, of what has a point.
fn number(word: &str) -> Option<String> {
    let digits = word.trim_end_matches(['u', 'i', 'f', 'h']);
    let suffix = &word[digits.len()..];
    if let Ok(whole) = digits.parse::<u32>() {
        return Some(format!("{}{suffix}", whole.checked_add(1)?));
    }
    let new = match digits.parse::<f32>().ok()? {
        0.0 => 1.0,
        1.0 => 0.0,
        other => other * 1.25,
    };
    Some(format!("{new:?}{suffix}"))
}

fn is_word(c: u8) -> bool {
    c.is_ascii_alphanumeric() || c == b'_'
}

/// The bytes of the word, number or operator with which code begins.
fn token(code: &[u8]) -> usize {
    let run =
        |is: &dyn Fn(usize, u8) -> bool| code.iter().enumerate().take_while(|(i, c)| is(*i, **c)).count();
    match code[0] {
        c if c.is_ascii_digit() => run(&|i, c| {
            is_word(c) || c == b'.' || (matches!(c, b'+' | b'-') && matches!(code[i - 1], b'e' | b'p'))
        }),
        c if is_word(c) => run(&|_, c| is_word(c)),
        _ => run(&|_, c| b"<>=!&|+-*/%".contains(&c)),
    }
}

/// The text with spaces in place of all that is not changed, so that places stay the same.
fn code(text: &str) -> Vec<u8> {
    let mut code = text.as_bytes().to_vec();
    let mut at = 0;
    while at < code.len() {
        let rest = &text.as_bytes()[at..];
        let begins_line = at == 0 || code[at - 1] == b'\n';
        let until =
            |end: &[u8]| rest.windows(end.len()).position(|found| found == end).map(|i| i + end.len());
        let length = if rest.starts_with(b"//") {
            until(b"\n")
        } else if rest.starts_with(b"/*") {
            until(b"*/")
        } else if begins_line && [&b"#"[..], b"var", b"@", b"alias"].iter().any(|word| rest.starts_with(word))
        {
            declaration(rest)
        } else if begins_line && rest.starts_with(b"struct ") {
            until(b"}")
        } else if rest[0] == b'<' && at > 0 && is_word(code[at - 1]) {
            until(b">")
        } else {
            at += 1;
            continue;
        };
        let end = at + length.unwrap_or(rest.len());
        code[at..end].iter_mut().filter(|c| **c != b'\n').for_each(|c| *c = b' ');
        at = end;
    }
    code
}

/// The bytes of a directive, a global or attributes: up to the end of the line on which all parentheses are closed.
fn declaration(rest: &[u8]) -> Option<usize> {
    let mut open = 0;
    let end = rest.iter().position(|c| {
        open += i32::from(*c == b'(') - i32::from(*c == b')');
        *c == b'\n' && open <= 0
    });
    end.map(|end| end + 1)
}
