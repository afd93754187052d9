//! Rules on text.

use super::Finding;
use crate::tree::{File, Tree, line_at};
use pulldown_cmark::{Event, Parser, Tag};
use std::path::Path;

/// The folder that names what is forbidden.
const HERE: &str = "tools/xtask/";

/// Lines of code above which a file may hold two things, and those of a pass's README.
const LINES: (usize, usize) = (500, 40);

pub(super) fn header(tree: &Tree) -> Vec<Finding> {
    tree.files()
        .iter()
        .filter(|file| file.is("wgsl") || (file.is("ron") && file.path.starts_with("pipelines/")))
        // What tests feed to a parser begins as the test wants.
        .filter(|file| !file.path.split('/').any(|folder| folder == "tests"))
        .filter(|file| !file.text.starts_with("//"))
        .map(|file| {
            Finding::new(&file.path, 1, "begin with a comment that says what it computes, and its paper")
        })
        .collect()
}

pub(super) fn unfinished(tree: &Tree) -> Vec<Finding> {
    const MACROS: &[&str] = &["todo!", "unimplemented!", "dbg!"];
    const WORDS: &[&str] = &["TODO", "FIXME"];
    each_line(tree, |file, line| {
        // An example in a document may leave out what it is not about.
        let code = file.is("rs") && !["///", "//!"].iter().any(|doc| line.trim_start().starts_with(doc));
        let found = MACROS.iter().filter(|_| code).chain(WORDS).find(|word| holds_word(line, word));
        found.map(|word| format!("`{word}` is left"))
    })
}

pub(super) fn machine(tree: &Tree) -> Vec<Finding> {
    const FOLDERS: &[&str] = &["/home/", "/root/", "/work/", "/Users/"];
    each_line(tree, |_, line| {
        let begins = |at: usize| !line[..at].ends_with(|c: char| c.is_alphanumeric() || "._-/}".contains(c));
        let found = FOLDERS.iter().find(|folder| line.match_indices(**folder).any(|(at, _)| begins(at)));
        found.map(|folder| format!("a path of one machine: `{folder}…`"))
    })
}

pub(super) fn links(tree: &Tree) -> Vec<Finding> {
    tree.files()
        .iter()
        .filter(|file| file.is("md"))
        .flat_map(|file| broken_links(tree.root(), file))
        .collect()
}

pub(super) fn long(tree: &Tree) -> Vec<Finding> {
    let limit = |file: &File| match file.path.strip_prefix("passes/") {
        _ if file.is("rs") || file.is("wgsl") => LINES.0,
        Some(path) if path.ends_with("/README.md") => LINES.1,
        _ => usize::MAX,
    };
    let lines = tree.files().iter().map(|file| (file, by_hand(file)));
    lines
        .filter(|(file, lines)| *lines > limit(file))
        .map(|(file, lines)| Finding::new(&file.path, 1, format!("{lines} lines")))
        .collect()
}

/// Returns the number of lines that `cargo xtask docs` has not written.
fn by_hand(file: &File) -> usize {
    let mut written = false;
    let by_hand = file.text.lines().filter(|line| {
        written = (written || line.ends_with(": written by cargo xtask docs -->"))
            && !line.starts_with("<!-- end of ");
        !written
    });
    by_hand.count()
}

fn broken_links(root: &Path, file: &File) -> Vec<Finding> {
    let folder = root.join(&file.path);
    let folder = folder.parent().unwrap_or(root);
    Parser::new(&file.text)
        .into_offset_iter()
        .filter_map(|(event, range)| {
            let (Event::Start(Tag::Link { dest_url, .. }) | Event::Start(Tag::Image { dest_url, .. })) =
                event
            else {
                return None;
            };
            let target = dest_url.split('#').next().unwrap_or_default();
            let elsewhere = target.is_empty() || target.contains("://") || target.starts_with("mailto:");
            if elsewhere || (!target.starts_with('/') && folder.join(target).exists()) {
                return None;
            }
            Some(Finding::new(
                &file.path,
                line_at(&file.text, range.start),
                format!("there is no `{target}`"),
            ))
        })
        .collect()
}

fn each_line(tree: &Tree, wrong: impl Fn(&File, &str) -> Option<String>) -> Vec<Finding> {
    let wrong = &wrong;
    tree.files()
        .iter()
        .filter(|file| !file.path.starts_with(HERE))
        .flat_map(|file| {
            file.lines()
                .filter_map(move |(number, line)| Some(Finding::new(&file.path, number, wrong(file, line)?)))
        })
        .collect()
}

/// Whether a word is in the line, and not as a part of another.
fn holds_word(line: &str, word: &str) -> bool {
    let joins = |c: char| c.is_alphanumeric() || c == '_';
    line.match_indices(word)
        .any(|(at, _)| !line[..at].ends_with(joins) && !line[at + word.len()..].starts_with(joins))
}
