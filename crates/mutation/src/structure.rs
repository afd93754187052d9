//! Edits of what a file says, which leave its syntax whole: most of what they make gets past a parser.

use proptest::prelude::*;
use proptest::sample::Index;
use proptest::strategy::ValueTree;
use serde_json::{Value, json};
use std::ops::Range;

/// Returns one of the good JSON values with a few edits: members and elements left out, repeated, exchanged with others of
/// their sort; numbers and texts replaced.
///
/// # Panics
/// If there are no values.
pub fn json(good: impl IntoIterator<Item = Value>) -> impl Strategy<Value = Value> {
    let good: Vec<Value> = good.into_iter().collect();
    assert!(!good.is_empty(), "there are no good values to edit");
    let edit = || (any::<Index>(), 0..5u8, any::<Index>());
    (0..good.len(), prop::collection::vec(edit(), 1..4)).prop_map(move |(which, edits)| {
        let mut value = good[which].clone();
        for (at, how, other) in edits {
            edit_json(&mut value, &at, how, &other);
        }
        value
    })
}

/// The paths of all values but the outermost.
fn paths(value: &Value, path: &str, found: &mut Vec<String>) {
    let inner: Vec<(String, &Value)> = match value {
        Value::Object(members) => {
            members.iter().map(|(name, value)| (name.replace('~', "~0").replace('/', "~1"), value)).collect()
        }
        Value::Array(elements) => {
            elements.iter().enumerate().map(|(i, value)| (i.to_string(), value)).collect()
        }
        _ => return,
    };
    for (name, value) in inner {
        let path = format!("{path}/{name}");
        paths(value, &path, found);
        found.push(path);
    }
}

fn edit_json(value: &mut Value, at: &Index, how: u8, other: &Index) {
    let mut all = Vec::new();
    paths(value, "", &mut all);
    let Some(path) = (!all.is_empty()).then(|| all[at.index(all.len())].clone()) else { return };
    let (outer, name) = path.rsplit_once('/').expect("a path begins with a slash");
    let old = value.pointer(&path).cloned().unwrap_or_default();
    let alike = |path: &&String| {
        value.pointer(path).is_some_and(|value| std::mem::discriminant(value) == std::mem::discriminant(&old))
    };
    let others: Vec<&String> = all.iter().filter(alike).collect();
    let exchanged = value.pointer(others[other.index(others.len())]).cloned().unwrap_or_default();
    let place = match (how, &old) {
        (0, _) => None,
        (1, _) => Some(exchanged),
        (_, Value::Number(_)) => {
            let odd =
                [json!(0), json!(1), json!(2), json!(3), json!(255), json!(65536), json!(1e30), json!(0.5)];
            Some(odd[other.index(odd.len())].clone())
        }
        (_, Value::String(_)) => Some(json!("\u{1b}é/../")),
        _ => Some(exchanged),
    };
    match (value.pointer_mut(outer), place) {
        (Some(Value::Object(members)), None) => drop(members.remove(name)),
        (Some(Value::Array(elements)), None) => drop(elements.remove(name.parse().expect("an index"))),
        (Some(Value::Array(elements)), Some(new)) if how == 2 => elements.push(new),
        (Some(_), Some(new)) => *value.pointer_mut(&path).expect("it is there") = new,
        (None, _) | (Some(_), None) => {}
    }
}

/// Sets of words of WGSL that may stand for each other.
const ALIKE: &[&[&str]] =
    &[&["+", "-", "*", "/"], &["<", ">", "<=", ">="], &["==", "!="], &["min", "max"], &["0", "1", "2", "3"]];

/// Returns one of the good WGSL texts with a few edits: operators and functions exchanged with those of the same sort,
/// numbers changed, statements left out and repeated.
///
/// # Panics
/// If there are no texts.
pub fn wgsl(good: impl IntoIterator<Item = String>) -> impl Strategy<Value = String> {
    let good: Vec<String> = good.into_iter().collect();
    assert!(!good.is_empty(), "there are no good texts to edit");
    let edit = || (any::<Index>(), 0..8u8, any::<Index>());
    (0..good.len(), prop::collection::vec(edit(), 1..4)).prop_map(move |(which, edits)| {
        edits
            .into_iter()
            .fold(good[which].clone(), |text, (at, how, other)| edit_wgsl(text, &at, how, &other))
    })
}

fn edit_wgsl(mut text: String, at: &Index, how: u8, other: &Index) -> String {
    if how < 2 {
        // A statement on a line of its own. Without a declaration, or with two, the text does not compile.
        let declares = |line: &str| ["let ", "var ", "const "].iter().any(|word| line.starts_with(word));
        let ends = |line: &&str| {
            line.trim_end().ends_with(';') && line.starts_with(' ') && !declares(line.trim_start())
        };
        let lines: Vec<Range<usize>> = text
            .split_inclusive('\n')
            .filter(ends)
            .map(|line| {
                let start = line.as_ptr() as usize - text.as_ptr() as usize;
                start..start + line.len()
            })
            .collect();
        let Some(line) = (!lines.is_empty()).then(|| lines[at.index(lines.len())].clone()) else {
            return text;
        };
        let again = if how == 0 { String::new() } else { text[line.clone()].repeat(2) };
        text.replace_range(line, &again);
        return text;
    }
    let is_word = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '.');
    let mut words: Vec<(Range<usize>, &[&str])> = Vec::new();
    for set in ALIKE {
        for word in *set {
            let whole = |at: usize| {
                let (before, after) =
                    (text[..at].chars().next_back(), text[at + word.len()..].chars().next());
                let bounds = |c: Option<char>| match word.starts_with(is_word) {
                    true => c.is_none_or(|c| !is_word(c)),
                    false => c == Some(' '),
                };
                bounds(before) && bounds(after)
            };
            words.extend(
                text.match_indices(word)
                    .filter(|(at, _)| whole(*at))
                    .map(|(at, _)| (at..at + word.len(), *set)),
            );
        }
    }
    let Some((place, set)) = (!words.is_empty()).then(|| words[at.index(words.len())].clone()) else {
        return text;
    };
    text.replace_range(place, set[other.index(set.len())]);
    text
}

/// Returns how many of `cases` values of a strategy a parser takes; they are the same in every run.
///
/// # Panics
/// If the strategy gives no value.
pub fn taken<T>(strategy: &impl Strategy<Value = T>, cases: u32, parses: impl Fn(T) -> bool) -> u32 {
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let case = |_: &u32| -> bool { parses(strategy.new_tree(&mut runner).expect("a value").current()) };
    (0..cases).filter(case).count() as u32
}
