//! The guides: their files are written, their commands run, and their listings are what is printed.
//!
//! A block of `ron` or `wgsl` is a file where its name stands behind the language or in a comment in its first line. The commands of `sh` blocks must succeed.
//! In `console` blocks, lines behind a command (`$ …`) are what it prints; `…` stands for any lines. Numbers with a point
//! or an exponent differ between machines, and are not compared, nor how long is left, nor how many WGSL files passes import. Paths are from
//! the working folder on.

use crate::adapter::{gpu, root};
use std::path::Path;
use std::process::Command;

/// Commands that are not run: windows and programs of others.
const LEFT_OUT: &[&str] = &["lightloom view", "cargo"];

fn is_left_out(command: &str) -> bool {
    LEFT_OUT.iter().any(|left_out| command.starts_with(left_out))
}

/// A fenced block of a page.
struct Block<'a> {
    language: &'a str,
    /// The name of a file, where the fence has one.
    name: Option<&'a str>,
    text: &'a str,
}

fn blocks(page: &str) -> Vec<Block<'_>> {
    let fenced = page.split("\n```").skip(1).step_by(2).filter_map(|block| block.split_once('\n'));
    let block = |(fence, text)| {
        let mut words = str::split_whitespace(fence);
        Block { language: words.next().unwrap_or_default(), name: words.next(), text }
    };
    fenced.map(block).collect()
}

/// A folder that has all of the tree, in which files can be made.
fn copy_of_tree(folder: &Path) {
    for entry in std::fs::read_dir(root()).unwrap().flatten() {
        let name = entry.file_name();
        if !["target", ".git", "out"].contains(&&*name.to_string_lossy()) {
            // Links would lead out of the folder, whose files name none there.
            let copied = Command::new("cp").arg("-r").arg(entry.path()).arg(folder).status();
            assert!(copied.unwrap().success());
        }
    }
}

/// Runs a command of a page: its exit code, and what it printed on both outputs.
fn run(folder: &Path, command: &str) -> (Option<i32>, String) {
    let words = command.split_whitespace().map(str::to_owned);
    let mut words: Vec<String> = words.take_while(|word| !word.starts_with('#')).collect();
    if words[0] == "lightloom" {
        words[0] = env!("CARGO_BIN_EXE_lightloom").to_owned();
    }
    let done = Command::new("sh")
        .args(["-c", "exec 2>&1; \"$@\"", "sh"])
        .args(&words)
        .current_dir(folder)
        .env("NO_COLOR", "1")
        .output()
        .unwrap();
    let printed = String::from_utf8_lossy(&done.stdout).into_owned();
    let folder = folder.canonicalize().unwrap();
    (done.status.code(), printed.replace(&format!("{}/", folder.display()), ""))
}

/// A command that renders as many pixels and frames as show whether it works.
fn smaller(command: &str) -> String {
    let mut words: Vec<&str> = command.split_whitespace().collect();
    if !["render", "study"].contains(words.get(1).unwrap_or(&"")) {
        return command.to_owned();
    }
    // A size that the page states is one that it compares pictures of.
    if !words.contains(&"--size") {
        words.extend(["--size", "32x24"]);
    }
    if let Some(i) = words.iter().position(|word| *word == "--frames") {
        words[i + 1] = "2";
    }
    words.join(" ")
}

/// A line without the numbers that differ between machines, and with single spaces.
fn comparable(line: &str) -> String {
    let line = match line.rsplit_once(", about ") {
        Some((line, time)) if time.ends_with(" left") => line,
        _ => line,
    };
    let counts_files = line.split_whitespace().skip(1).map(|next| next == "WGSL").chain([false]);
    let words = line.split_whitespace().zip(counts_files).map(|(word, counts_files)| {
        let number = word.trim_matches(|c: char| !c.is_ascii_alphanumeric());
        let differs = (number.contains('.') || counts_files) && number.parse::<f64>().is_ok();
        if differs { "#".to_owned() } else { word.to_owned() }
    });
    words.collect::<Vec<_>>().join(" ")
}

/// Whether the lines that are printed are those of the page, in which `…` stands for any.
fn agrees(expected: &[String], printed: &[String]) -> bool {
    match expected.split_first() {
        None => printed.is_empty(),
        Some((line, rest)) if line == "…" => (0..=printed.len()).any(|skip| agrees(rest, &printed[skip..])),
        Some((line, rest)) => printed.first() == Some(line) && agrees(rest, &printed[1..]),
    }
}

/// Runs the commands of a listing, and returns how many there were.
fn check_console(folder: &Path, text: &str, page: &str, wrong: &mut Vec<String>) -> usize {
    let mut commands = 0;
    for part in format!("\n{text}").split("\n$ ").skip(1) {
        let (command, expected) = part.split_once('\n').unwrap_or((part, ""));
        if is_left_out(command) {
            continue;
        }
        commands += 1;
        let (_, printed) = run(folder, command);
        let lines = |text: &str| -> Vec<String> {
            text.lines().map(comparable).filter(|line| !line.is_empty()).collect()
        };
        if !agrees(&lines(expected), &lines(&printed)) {
            wrong.push(format!("{page}: `{command}` prints\n{printed}and the page says\n{expected}"));
        }
    }
    commands
}

#[test]
fn files_commands_and_listings_of_the_first_guides_are_right() {
    assert_pages_are_right(&["docs/first-pipeline.md", "docs/first-pass.md", "docs/scenes.md"], 19);
}

/// The commands in the README are those of `--help`, with that of the window.
#[cfg(feature = "window")]
#[test]
fn commands_of_the_readme_are_those_of_the_help() {
    assert_pages_are_right(&["README.md"], 1);
}

#[test]
#[ignore = "slow"]
fn files_commands_and_listings_of_the_guides_to_studies_are_right() {
    assert_pages_are_right(&["docs/guide.md", "docs/first-study.md", "docs/judge.md"], 10);
}

/// Checks pages, which have at least `least` commands together.
fn assert_pages_are_right(pages: &[&str], least: usize) {
    if gpu().is_none() {
        return;
    }
    let mut wrong = Vec::new();
    let mut commands = 0;
    for &page in pages {
        let folder = tempfile::tempdir().unwrap();
        copy_of_tree(folder.path());
        let text = std::fs::read_to_string(root().join(page)).unwrap();
        for Block { language, name, text } in blocks(&text) {
            match language {
                "ron" | "wgsl" => {
                    let first = text.lines().next().and_then(|line| line.strip_prefix("// "));
                    let name = name.or(first.and_then(|line| line.split([':', ' ']).next()));
                    let is_file = |name: &&str| name.ends_with(".ron") || name.ends_with(".wgsl");
                    if let Some(name) = name.filter(is_file) {
                        std::fs::write(folder.path().join(name), text).unwrap();
                    }
                }
                "sh" => {
                    for line in text.lines().filter(|line| !line.trim().is_empty()) {
                        if is_left_out(line) {
                            continue;
                        }
                        let (code, printed) = run(folder.path(), &smaller(line));
                        commands += 1;
                        if code != Some(0) {
                            wrong.push(format!("{page}: `{line}` fails:\n{printed}"));
                        }
                    }
                }
                "console" => commands += check_console(folder.path(), text, page, &mut wrong),
                _ => {}
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
    assert!(commands >= least, "{commands} commands were found");
}
