//! Edits of files.

use proptest::prelude::*;
use proptest::sample::Index;
use std::ops::Range;
use std::sync::Arc;

/// The good files.
pub(crate) type Seeds = Arc<[Vec<u8>]>;

/// The longest file that edits make, in bytes: repeated edits would grow without end.
const MAX_BYTES: usize = 1 << 20;

/// Numbers at the ends of types, and those that are none.
const NUMBERS: &[&str] = &[
    "0",
    "-1",
    "1",
    "2",
    "255",
    "256",
    "65535",
    "65536",
    "16777217",
    "2147483647",
    "-2147483648",
    "4294967295",
    "4294967296",
    "9007199254740993",
    "18446744073709551615",
    "-9223372036854775808",
    "1e38",
    "-1e39",
    "1e308",
    "1e999",
    "1e-320",
    "0.1",
    "inf",
    "NaN",
    "1.5",
    "0x7fffffff",
];

/// An opening bracket and its closing one.
const BRACKETS: &[(u8, u8)] = &[(b'(', b')'), (b'[', b']'), (b'{', b'}'), (b'<', b'>')];

/// Pieces that mean something to some parser.
const PIECES: &[&str] = &[
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    "<",
    ">",
    ",",
    ":",
    ";",
    "\"",
    "'",
    "#",
    "//",
    "/*",
    "*/",
    "\n",
    "\0",
    " ",
    "$",
    "@",
    "..",
    "/",
    "+",
    "-",
    "*",
    "!",
    "&",
    "=",
    "a",
    "é",
    "\u{feff}",
    "\\",
    "else if a {}",
    "true",
    "\"\"",
    "()",
    "null",
];

/// One edit, at places that fit any file.
#[derive(Clone, Debug)]
pub(crate) enum Edit {
    /// Leaves a part out.
    Cut(Index, usize),
    /// Leaves the end out.
    End(Index),
    /// Repeats a part `n` times.
    Repeat(Index, usize, usize),
    /// Puts a part of another file, or of this one, over one.
    Splice(Index, usize, Index, Index, usize),
    /// Puts an odd number in the place of a number.
    Number(Index, Index),
    /// Inserts `n` pieces.
    Insert(Index, Index, usize),
    /// Nests a bracket with its content in itself, `n` times.
    Nest(Index, usize),
    /// Changes a bit.
    Flip(Index, u8),
}

impl Edit {
    pub(crate) fn strategy() -> impl Strategy<Value = Edit> {
        let index = any::<Index>;
        // Often once, sometimes so often that depth or length is what breaks.
        let times = || prop_oneof![6 => Just(1usize), 3 => 2..40usize, 1 => 40..20_000usize];
        let length = || prop_oneof![4 => 1..8usize, 3 => 8..80usize, 1 => 80..4000usize];
        prop_oneof![
            2 => (index(), length()).prop_map(|(at, length)| Edit::Cut(at, length)),
            1 => index().prop_map(Edit::End),
            2 => (index(), length(), times()).prop_map(|(at, length, times)| Edit::Repeat(at, length, times)),
            2 => (index(), length(), index(), index(), length())
                .prop_map(|(at, length, file, from, other)| Edit::Splice(at, length, file, from, other)),
            4 => (index(), index()).prop_map(|(at, which)| Edit::Number(at, which)),
            2 => (index(), index(), times()).prop_map(|(at, which, times)| Edit::Insert(at, which, times)),
            2 => (index(), times()).prop_map(|(at, times)| Edit::Nest(at, times)),
            1 => (index(), 0..8u8).prop_map(|(at, bit)| Edit::Flip(at, bit)),
        ]
    }

    pub(crate) fn apply(&self, mut bytes: Vec<u8>, good: &Seeds) -> Vec<u8> {
        let part = |bytes: &[u8], at: &Index, length: usize| -> Range<usize> {
            let start = at.index(bytes.len() + 1);
            start..(start + length).min(bytes.len())
        };
        // The first of some places at or behind a chosen one.
        let chosen =
            |places: Vec<usize>, at: &Index| (!places.is_empty()).then(|| places[at.index(places.len())]);
        match self {
            Edit::Cut(at, length) => {
                bytes.drain(part(&bytes, at, *length));
            }
            Edit::End(at) => bytes.truncate(at.index(bytes.len() + 1)),
            Edit::Repeat(at, length, times) => {
                let part = part(&bytes, at, *length);
                let again = repeated(&bytes[part.clone()], *times);
                bytes.splice(part.end..part.end, again);
            }
            Edit::Splice(at, length, file, from, other) => {
                let source = &good[file.index(good.len())];
                let from = source[part(source, from, *other)].to_vec();
                let part = part(&bytes, at, *length);
                bytes.splice(part, from);
            }
            Edit::Number(at, which) => {
                let number = |byte: &u8| byte.is_ascii_digit() || matches!(byte, b'.' | b'-');
                let starts = |i: &usize| bytes[*i].is_ascii_digit() && (*i == 0 || !number(&bytes[*i - 1]));
                let Some(start) = chosen((0..bytes.len()).filter(starts).collect(), at) else { return bytes };
                let length = bytes[start..].iter().take_while(|byte| number(byte)).count();
                let odd = NUMBERS[which.index(NUMBERS.len())].bytes();
                bytes.splice(start..start + length, odd);
            }
            Edit::Insert(at, which, times) => {
                let at = at.index(bytes.len() + 1);
                let piece = repeated(PIECES[which.index(PIECES.len())].as_bytes(), *times);
                bytes.splice(at..at, piece);
            }
            Edit::Nest(at, times) => {
                let opens = |i: &usize| BRACKETS.iter().any(|(open, _)| *open == bytes[*i]);
                let Some(start) = chosen((0..bytes.len()).filter(opens).collect(), at) else { return bytes };
                // With the word before the bracket, for the name of a form or a function.
                let word = bytes[..start].iter().rev();
                let word =
                    word.take_while(|b| b.is_ascii_alphanumeric() || matches!(b, b'_' | b':' | b' ')).count();
                let Some(length) = closed(&bytes[start..]) else { return bytes };
                let head = repeated(&bytes[start - word..=start], *times);
                let tail = repeated(&bytes[start + length - 1..start + length], *times);
                bytes.splice(start + length..start + length, tail);
                bytes.splice(start - word..start - word, head);
            }
            Edit::Flip(at, bit) if !bytes.is_empty() => {
                let at = at.index(bytes.len());
                bytes[at] ^= 1 << bit;
            }
            Edit::Flip(..) => {}
        }
        bytes.truncate(MAX_BYTES);
        bytes
    }
}

fn repeated(part: &[u8], times: usize) -> Vec<u8> {
    part.repeat(times.min(MAX_BYTES / part.len().max(1)))
}

/// Returns the length of what starts with a bracket, up to the one that closes it.
fn closed(bytes: &[u8]) -> Option<usize> {
    let (open, close) = BRACKETS.iter().find(|(open, _)| *open == bytes[0])?;
    let mut depth = 0_usize;
    let end = bytes.iter().position(|byte| {
        depth += usize::from(byte == open);
        depth = depth.saturating_sub(usize::from(byte == close));
        depth == 0
    });
    end.map(|end| end + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::strategy::ValueTree;
    use proptest::test_runner::TestRunner;

    #[test]
    fn edits_change_good_files() {
        let good: Seeds =
            [b"Form(a: (1, 2.5), b: [\"x\"])".to_vec(), b"fn f() { return 3; }".to_vec()].into();
        let mut runner = TestRunner::deterministic();
        let (mut kinds, mut changed) = (std::collections::BTreeSet::new(), 0);
        for _ in 0..2000 {
            let edit = Edit::strategy().new_tree(&mut runner).expect("an edit").current();
            let edited = edit.apply(good[0].clone(), &good);
            assert!(edited.len() <= MAX_BYTES);
            changed += usize::from(edited != good[0]);
            kinds.insert(format!("{edit:?}").split('(').next().map(str::to_owned));
        }
        assert_eq!(kinds.len(), 8, "{kinds:?}");
        assert!(changed > 1800, "{changed} of 2000 edits change something");
    }

    #[test]
    fn a_bracket_is_put_into_itself_with_its_name() {
        let good: Seeds = [b"A(b)".to_vec()].into();
        let mut runner = TestRunner::deterministic();
        let index = any::<Index>().new_tree(&mut runner).expect("an index").current();
        assert_eq!(Edit::Nest(index, 2).apply(good[0].clone(), &good), b"A(A(A(b)))");
    }
}
