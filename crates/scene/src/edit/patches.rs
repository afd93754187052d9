//! Changes to a text by the places of its tree: everything that is not named stays as it is, byte for byte.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use data_file::grammar::{Node, Parts, Shape, skip_blanks};

/// Replacements of ranges of a text, which do not overlap.
pub(super) struct Patches<'a> {
    text: &'a str,
    list: Vec<(Range<usize>, String)>,
    /// The step of indentation of the text.
    step: String,
}

/// The bytes of a node.
pub(super) fn range(node: Node<'_>) -> Range<usize> {
    node.start()..node.end()
}

impl<'a> Patches<'a> {
    /// Begins to change a text, given its tree.
    pub(super) fn new(text: &'a str, tree: Node<'_>) -> Patches<'a> {
        let mut patches = Patches { text, list: Vec::new(), step: "    ".to_owned() };
        let first = Items::of(tree).ranges.first().map(|item| item.start);
        let outer = patches.indent(tree.start());
        let inner = first.filter(|at| patches.starts_line(*at)).map(|at| patches.indent(at));
        if let Some(step) = inner.and_then(|inner| inner.strip_prefix(outer)).filter(|step| !step.is_empty())
        {
            patches.step = step.to_owned();
        }
        patches
    }

    /// Replaces the bytes of a node.
    pub(super) fn replace(&mut self, node: Node<'_>, by: String) {
        self.list.push((range(node), by));
    }

    /// Replaces a node, of which the comments remain before the new text.
    pub(super) fn rewrite(&mut self, node: Node<'_>, by: &str) {
        let comments = comments_in(&self.text[range(node)]);
        self.replace(node, format!("{comments}{by}"));
    }

    /// Returns the changed text.
    pub(super) fn apply(mut self) -> String {
        // Stable: what is inserted at one place stays in the order in which it was.
        self.list.sort_by_key(|(range, _)| (range.start, range.end));
        let mut out = String::with_capacity(self.text.len() + 256);
        let mut at = 0;
        for (range, by) in &self.list {
            debug_assert!(range.start >= at, "changes overlap at byte {at}");
            if range.start < at {
                // The check of the result finds what is missing.
                continue;
            }
            out.push_str(&self.text[at..range.start]);
            out.push_str(by);
            at = range.end;
        }
        out.push_str(&self.text[at..]);
        out
    }

    /// Returns the indentation of what is within something that is indented by `outer`.
    pub(super) fn within(&self, outer: &str) -> String {
        format!("{outer}{}", self.step)
    }

    /// Returns the end of a line, as the text has it.
    pub(super) fn line_end(&self) -> &'static str {
        if self.text.contains("\r\n") { "\r\n" } else { "\n" }
    }

    fn insert(&mut self, at: usize, by: String) {
        self.list.push((at..at, by));
    }

    fn line_start(&self, at: usize) -> usize {
        self.text[..at].rfind('\n').map_or(0, |newline| newline + 1)
    }

    /// Returns the blanks at the start of the line.
    fn indent(&self, at: usize) -> &'a str {
        let line = &self.text[self.line_start(at)..at];
        &line[..line.len() - line.trim_start_matches([' ', '\t']).len()]
    }

    fn starts_line(&self, at: usize) -> bool {
        self.line_start(at) + self.indent(at).len() == at
    }

    /// Returns the end of the comma that follows an item, if one does.
    fn comma(&self, item: &Range<usize>) -> Option<usize> {
        let at = skip_blanks(self.text, item.end);
        self.text[at..].starts_with(',').then_some(at + 1)
    }

    /// Returns the end of the line, if only blanks and a comment of that line follow `at` in it.
    fn rest_of_line(&self, at: usize) -> Option<usize> {
        let rest = self.text[at..].split('\n').next().unwrap_or_default();
        let rest = rest.strip_suffix('\r').unwrap_or(rest);
        let trimmed = rest.trim_start();
        (trimmed.is_empty() || trimmed.starts_with("//")).then_some(at + rest.len())
    }
}

/// The items of a list or a map, or the fields of a form, and what is to be added and removed.
pub(super) struct Items {
    /// One past the opening bracket.
    open: usize,
    close: usize,
    ranges: Vec<Range<usize>>,
    removed: BTreeSet<usize>,
    /// Texts by the number of items before them.
    added: BTreeMap<usize, Vec<String>>,
}

impl Items {
    /// Returns the items of a node.
    pub(super) fn of(node: Node<'_>) -> Items {
        let pair = |(key, value): (Node<'_>, Node<'_>)| key.start()..value.end();
        let ranges: Vec<_> = match (node.shape(), node.parts()) {
            (Shape::Map, _) => node.entries().into_iter().map(pair).collect(),
            (_, Parts::Fields(fields)) => fields.into_iter().map(pair).collect(),
            (_, Parts::Items(items)) => items.into_iter().map(range).collect(),
        };
        let close = node.end().saturating_sub(1);
        Items { open: node.start(), close, ranges, removed: BTreeSet::new(), added: BTreeMap::new() }
    }

    /// Returns the number of items that there are.
    pub(super) fn len(&self) -> usize {
        self.ranges.len()
    }

    /// Returns the indentation of these items, or of the first that is added.
    pub(super) fn indent(&self, patches: &Patches<'_>) -> String {
        match self.ranges.first() {
            Some(item) => patches.indent(item.start).to_owned(),
            None => patches.within(patches.indent(self.open)),
        }
    }

    /// Removes an item; comments in it remain.
    pub(super) fn remove(&mut self, index: usize) {
        self.removed.insert(index);
    }

    /// Adds an item behind the first `before` items, of which the last must not be removed.
    pub(super) fn add(&mut self, before: usize, text: String) {
        self.added.entry(before).or_default().push(text);
    }

    /// Puts all this into effect.
    pub(super) fn finish(self, patches: &mut Patches<'_>) {
        for (before, texts) in &self.added {
            match (before.checked_sub(1).and_then(|i| self.ranges.get(i)), self.ranges.first()) {
                (Some(item), _) => {
                    // No comma is left behind where all that followed is removed.
                    let last = (*before..self.len()).all(|index| self.removed.contains(&index))
                        && self.ranges.last().is_some_and(|last| patches.comma(last).is_none());
                    insert_after(patches, item, texts, last);
                }
                (None, Some(first)) => insert_before(patches, first, texts),
                (None, None) => self.fill(patches, texts),
            }
        }
        for index in &self.removed {
            self.take_out(patches, *index);
        }
    }

    /// Adds the first items, each on a line of its own.
    fn fill(&self, patches: &mut Patches<'_>, texts: &[String]) {
        let (inner, end) = (self.indent(patches), patches.line_end());
        let mut lines: String = texts.iter().map(|text| format!("{end}{inner}{text},")).collect();
        let between = &patches.text[self.open..self.close];
        let open = self.close - between.len() + between.find(['(', '[', '{']).map_or(0, |at| at + 1);
        if patches.text[open..self.close].trim().is_empty() {
            lines.push_str(end);
            lines.push_str(patches.indent(self.open));
            patches.list.push((open..self.close, lines));
        } else {
            patches.insert(open, lines);
        }
    }

    fn take_out(&self, patches: &mut Patches<'_>, index: usize) {
        let item = &self.ranges[index];
        let comments = comments_in(&patches.text[item.clone()]);
        let comma = patches.comma(item);
        // Comments between the item and its comma remain as well.
        let end = comma.filter(|comma| patches.text[item.end..comma - 1].trim().is_empty());
        let Some(end) = end else {
            let before = index.checked_sub(1).filter(|before| !self.removed.contains(before));
            let before = before
                .map(|before| self.ranges[before].end)
                .filter(|end| comma.is_none() && patches.text[*end..item.start].trim() == ",");
            // An item added in place of this one goes behind the comma before it.
            let before = before.map(|end| if self.added.contains_key(&index) { end + 1 } else { end });
            let before =
                before.filter(|end| patches.text[*end..item.start].trim_start_matches(',').trim().is_empty());
            patches.list.push((before.unwrap_or(item.start)..item.end, comments));
            if let Some(comma) = comma {
                patches.list.push((comma - 1..comma, String::new()));
            }
            return;
        };
        let alone = patches.starts_line(item.start) && comments.is_empty();
        let line = patches.rest_of_line(end).filter(|line| patches.text[end..*line].trim().is_empty());
        let range = match line {
            Some(line) if alone && line < patches.text.len() => {
                let newline = patches.text[line..].find('\n').map_or(0, |at| at + 1);
                patches.line_start(item.start)..line + newline
            }
            _ => {
                let blanks =
                    patches.text[end..].len() - patches.text[end..].trim_start_matches([' ', '\t']).len();
                item.start..end + blanks
            }
        };
        patches.list.push((range, comments));
    }
}

/// Adds items after one; each on a line of its own if that one is.
fn insert_after(patches: &mut Patches<'_>, item: &Range<usize>, texts: &[String], last: bool) {
    let comma = patches.comma(item);
    let end = comma.unwrap_or(item.end);
    let line = patches.rest_of_line(end).filter(|_| patches.starts_line(item.start));
    let before = match line {
        Some(_) => format!("{}{}", patches.line_end(), patches.indent(item.start)),
        None => " ".to_owned(),
    };
    if comma.is_none() {
        patches.insert(end, ",".to_owned());
    }
    let lines: Vec<String> = texts.iter().map(|text| format!("{before}{text}")).collect();
    let last = if last { "" } else { "," };
    patches.insert(line.unwrap_or(end), format!("{}{last}", lines.join(",")));
}

fn insert_before(patches: &mut Patches<'_>, item: &Range<usize>, texts: &[String]) {
    let after = if patches.starts_line(item.start) {
        format!(",{}{}", patches.line_end(), patches.indent(item.start))
    } else {
        ", ".to_owned()
    };
    patches.insert(item.start, texts.iter().map(|text| format!("{text}{after}")).collect());
}

/// Returns the comments of a text that holds no quotes, with the blanks after them: a line must end after `//`.
fn comments_in(text: &str) -> String {
    let (mut out, mut at) = (String::new(), 0);
    while let Some(next) = text[at..].find("//").into_iter().chain(text[at..].find("/*")).min() {
        let start = at + next;
        at = skip_blanks(text, start);
        out.push_str(&text[start..at]);
    }
    out
}
