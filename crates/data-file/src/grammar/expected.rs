//! What a grammar expects at a position of a text, for editors.

use super::cursor::Cursor;
use super::node::Node;
use super::{Reader, de, parse};
use crate::diagnostic::Source;
use serde::de::DeserializeOwned;
use std::cell::RefCell;

/// The value that stands at the position while it is asked for.
const STAND_IN: &str = "_";

/// What may stand at a position.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Expected {
    /// The fields of the form around it, where the name of a field may stand.
    pub fields: Vec<&'static str>,
    /// Forms and words, each as errors write it: `Set("pass.setting", value)`.
    pub forms: Vec<String>,
}

/// The position that a reader is asked about.
#[derive(Debug, Default)]
pub(super) struct Question {
    /// The byte of the bracket of the form whose fields are asked for.
    open: Option<usize>,
    /// The byte of the stand-in.
    at: usize,
    found: Expected,
}

impl Question {
    /// Takes in that a form has these fields.
    pub(super) fn form(&mut self, node: Node<'_>, fields: &[&'static str]) {
        let Some(open) = self.open.and_then(|open| open.checked_sub(node.start())) else { return };
        if node.text().get(..=open).is_some_and(|head| head.find(['(', '[', '{']) == Some(open)) {
            self.found.fields = fields.to_vec();
        }
    }

    /// Takes in which forms a value may have.
    pub(super) fn value(&mut self, node: Node<'_>, forms: impl IntoIterator<Item = String>) {
        if node.start() == self.at && node.text() == STAND_IN && self.found.forms.is_empty() {
            self.found.forms = forms.into_iter().collect();
        }
    }
}

/// Returns what a `T` may have at a byte of a text, of which only what is before that is read.
pub fn expected<T: DeserializeOwned>(text: &str, at: usize) -> Expected {
    let cursor = Cursor::new(text, at);
    let open = cursor.frames.last().map(|frame| frame.open).filter(|_| cursor.at_key(text));
    let ask = |completed: String, open: Option<usize>| {
        let mut found = Expected::default();
        let source = Source::new("", completed);
        // Errors are those of a text that is not finished.
        let _ = parse(&source, 0, |reader: &mut Reader<'_>, node| {
            reader.question = Some(Question { open, at: cursor.token.start, ..Question::default() });
            let _ = T::deserialize(de::De::new(&RefCell::new(&mut *reader), node));
            found = reader.question.take().unwrap_or_default().found;
            Some(())
        });
        found
    };
    let forms = ask(cursor.completed(text, STAND_IN), None).forms;
    let fields = open.map(|_| ask(cursor.completed(text, ""), open).fields).unwrap_or_default();
    Expected { fields, forms }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;

    #[derive(Deserialize)]
    #[serde(rename = "Root")]
    #[expect(dead_code, reason = "only what it may hold is asked for")]
    struct Root {
        name: Option<String>,
        items: Vec<Item>,
        on: Option<bool>,
    }

    #[derive(Deserialize)]
    #[serde(expecting = "`Set(\"path\", 1)` or `Remove(at: …)`")]
    #[expect(dead_code, reason = "only what it may hold is asked for")]
    enum Item {
        Set(String, u32),
        Remove { at: String, all: bool },
    }

    #[test]
    fn fields_and_forms_are_those_of_the_position() {
        let cases = [
            ("|", "", "Root(…)"),
            ("Root(|", "name items on", ""),
            ("Root(name: \"a\", it|: 3", "name items on", ""),
            ("Root(items: [|", "", "Set(\"path\", 1) Remove(at: …)"),
            ("Root(items: [Set(\"x\", 1), Re|", "", "Set(\"path\", 1) Remove(at: …)"),
            ("Root(items: [Remove(|", "at all", ""),
            ("Root(on: |)", "", "true false"),
        ];
        for (marked, fields, forms) in cases {
            let at = marked.find('|').unwrap();
            let found = expected::<Root>(&marked.replacen('|', "", 1), at);
            assert_eq!(found.fields.join(" "), fields, "{marked}");
            assert_eq!(found.forms.join(" "), forms, "{marked}");
        }
    }
}
