//! What errors say that a type expects.

use serde::de::{Expected, Visitor};

/// Returns whether two names have a word in common: `outer_angle` and `outer_deg`.
pub(super) fn shares_a_word(a: &str, b: &str) -> bool {
    a.split('_').any(|word| word.len() >= 3 && b.split('_').any(|other| other == word))
}

/// Returns what stands in backticks in a text, each with the word with which it begins.
pub(super) fn words(text: &str) -> impl Iterator<Item = (&str, &str)> {
    let quoted = text.split('`').skip(1).step_by(2);
    quoted.filter_map(|form| {
        let word = form.split(|c: char| !(c.is_alphanumeric() || c == '_')).next()?;
        (!word.is_empty()).then_some((word, form))
    })
}

/// Returns what a visitor expects, where its type says so and serde does not.
pub(super) fn said<'de>(visitor: &impl Visitor<'de>) -> Option<String> {
    let expected = (visitor as &dyn Expected).to_string();
    let derived = ["struct ", "enum ", "tuple ", "unit ", "a tuple "];
    (!derived.iter().any(|start| expected.starts_with(start))).then_some(expected)
}

/// Returns the forms of these names as errors write them.
pub(super) fn forms(names: &[&str]) -> String {
    match names {
        [] => String::new(),
        [name] => format!("`{name}(…)`"),
        [first, last] => format!("`{first}(…)` or `{last}(…)`"),
        [first, rest @ ..] => format!("`{first}(…)`, {}", forms(rest)),
    }
}
