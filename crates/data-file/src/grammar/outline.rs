//! The named things of a file, for the outline of an editor.

use super::node::{Node, Parts, Shape};
use super::syntax;
use std::ops::Range;

/// How deep items are listed within each other.
const DEPTH: usize = 6;
/// The most items of a file.
const MOST: usize = 5000;

/// A field, an entry of a map, or a form of a list, that has others in it or is in a map.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Item {
    /// The key, the name of the field, or the form.
    pub name: String,
    /// The form of its value, where it has one.
    pub form: String,
    /// All bytes of it.
    pub range: Range<usize>,
    /// Those of the name.
    pub selection: Range<usize>,
    /// What is in it.
    pub items: Vec<Item>,
}

/// Returns the items of a file, as far as it can be read.
pub fn outline(text: &str) -> Vec<Item> {
    let mended = (text.len() <= crate::MAX_TEXT).then(|| syntax::check(text).1).flatten();
    let Some(mended) = mended else { return Vec::new() };
    let mut left = MOST;
    within(Node::root(&mended), DEPTH, &mut left)
}

fn within(node: Node<'_>, depth: usize, left: &mut usize) -> Vec<Item> {
    if depth == 0 {
        return Vec::new();
    }
    // What names each, its value, and whether it is listed though nothing is in it.
    let all: Vec<(Node<'_>, Node<'_>, bool)> = match node.shape() {
        Shape::Map => node.entries().into_iter().map(|(key, value)| (key, value, true)).collect(),
        Shape::Form(_) => match node.parts() {
            Parts::Fields(fields) => fields.into_iter().map(|(name, value)| (name, value, false)).collect(),
            Parts::Items(items) => items.into_iter().map(|item| (item.head(), item, false)).collect(),
        },
        Shape::List => node.items().into_iter().filter_map(|item| Some((named(item)?, item, true))).collect(),
        _ => Vec::new(),
    };
    let mut items = Vec::new();
    for (name, value, keep) in all {
        let inner = within(value, depth - 1, left);
        if (!keep && inner.is_empty()) || *left == 0 {
            continue;
        }
        *left -= 1;
        let form = value.name().filter(|_| matches!(value.shape(), Shape::Form(_))).unwrap_or_default();
        items.push(Item {
            name: super::unquoted(name.text()).to_owned(),
            form: form.to_owned(),
            range: name.start().min(value.start())..value.end(),
            selection: name.start()..name.end(),
            items: inner,
        });
    }
    items
}

/// Returns what names a form of a list: its field `name`, or the text with which it begins, as `Replace("pass", …)`.
fn named(item: Node<'_>) -> Option<Node<'_>> {
    let first = || item.items().first().copied().filter(|node| matches!(node.shape(), Shape::Text(_)));
    let name = item.field("name").or_else(first);
    name.filter(|_| matches!(item.shape(), Shape::Form(Some(_))))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(items: &[Item]) -> String {
        let name = |item: &Item| format!("{}:{}({})", item.name, item.form, names(&item.items));
        items.iter().map(name).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn named_things_are_listed_also_of_a_broken_file() {
        let text = "P(about: \"x\", passes: { \"a\": Pass(kind: \"k\"), \"b\": 1 }, patch: [Set(\"p\", 1), Remove(\"q\")], ,)";
        assert_eq!(names(&outline(text)), "passes:(a:Pass() b:()) patch:(p:Set() q:Remove())");
        assert!(outline("P(").is_empty());
    }
}
