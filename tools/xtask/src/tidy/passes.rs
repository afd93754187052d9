//! Rules on what a pass says of itself.

use super::Finding;
use crate::tree::{File, Tree, line_at};

const SECTION: &str = "Deviations";
const TAG: &str = "DEVIATION(";

pub(super) fn readme(tree: &Tree) -> Vec<Finding> {
    let paths = tree.passes().into_iter().map(|pass| format!("passes/{pass}/README.md"));
    let missing = paths.filter(|path| tree.file(path).is_none());
    missing.map(|path| Finding::new(&path, 1, "there is no README")).collect()
}

/// In code a deviation is marked by a comment `DEVIATION(name): why`, in the README by an item `- **name**: why`
/// of the section on deviations. Items without a name are for what has no place in the code.
pub(super) fn deviations(tree: &Tree) -> Vec<Finding> {
    let mut findings = Vec::new();
    for pass in tree.passes() {
        let folder = format!("passes/{pass}");
        // A missing README is a finding of another rule.
        let Some(readme) = tree.file(&format!("{folder}/README.md")) else { continue };
        let code = || tree.below(&folder).filter(|file| file.is("rs") || file.is("wgsl"));
        let (section, explained) = explained(readme);
        if section.is_none()
            && let Some((path, line)) = code().find_map(|file| Some((&file.path, cites(file, pass)?)))
        {
            findings.push(Finding::new(
                path,
                line,
                format!("it cites a paper, but {} has no section \"{SECTION} …\"", readme.path),
            ));
        }
        let mut tagged: Vec<&str> = Vec::new();
        for (file, line, name) in code().flat_map(tags) {
            tagged.push(name);
            if !explained.iter().any(|(_, explained)| *explained == name) {
                let message = format!("say it in {}, under \"{SECTION} …\": - **{name}**: …", readme.path);
                findings.push(Finding::new(&file.path, line, message));
            }
        }
        for (line, name) in explained.iter().filter(|(_, name)| !tagged.contains(name)) {
            findings.push(Finding::new(
                &readme.path,
                *line,
                format!("no comment in the code says {TAG}{name})"),
            ));
        }
    }
    findings
}

/// Line of the section on deviations in a README, and the names that it explains.
fn explained(readme: &File) -> (Option<usize>, Vec<(usize, &str)>) {
    let mut section = None;
    let mut inside = false;
    let mut names = Vec::new();
    for (number, line) in readme.lines() {
        if line.starts_with('#') {
            inside = line.trim_start_matches('#').trim_start().starts_with(SECTION);
            section = section.or(inside.then_some(number));
        } else if inside
            && let Some((name, _)) = line.strip_prefix("- **").and_then(|item| item.split_once("**:"))
        {
            names.push((number, name));
        }
    }
    (section, names)
}

/// The deviations that comments of a file mark, with their lines.
fn tags(file: &File) -> impl Iterator<Item = (&File, usize, &str)> {
    file.lines().filter_map(move |(number, line)| {
        let (_, comment) = line.split_once("//")?;
        let (_, tag) = comment.split_once(TAG)?;
        Some((file, number, tag.split_once(')')?.0))
    })
}

/// The line in which a pass names its paper: in Rust, or at the end of the first paragraph of its main WGSL.
fn cites(file: &File, pass: &str) -> Option<usize> {
    if file.path.ends_with(&format!("/{pass}.wgsl")) {
        let paragraph = file.lines().take_while(|(_, line)| line.starts_with("//") && line.trim() != "//");
        return paragraph.last().filter(|(_, line)| line.ends_with(']')).map(|(number, _)| number);
    }

    let names_one = |(at, _): &(usize, &str)| {
        let value = file.text[at + "paper:".len()..].trim_start();
        value.starts_with('"') && !value.starts_with("\"\"")
    };
    file.text.match_indices("paper:").find(names_one).map(|(at, _)| line_at(&file.text, at))
}
