//! A new pass is the template with another name. The template itself is compiled and tested as a package.

use std::fs;
use std::path::Path;
use tempfile::TempDir;
use xtask::new_pass::create;
use xtask::tidy::findings;
use xtask::tree::{Tree, root};

const CATALOG: &str = "crates/catalog/Cargo.toml";

/// A tree of the files that `new-pass` reads: the template, the catalog's manifest, and the workspace's.
fn fixture() -> TempDir {
    let real = Tree::read(&root()).unwrap();
    let manifests = ["Cargo.toml", CATALOG].map(|path| real.file(path).unwrap());
    let files: Vec<(&str, &str)> =
        real.below("tools/new-pass").chain(manifests).map(|file| (&*file.path, &*file.text)).collect();
    crate::tree(&files)
}

fn read(root: &Path, path: &str) -> String {
    fs::read_to_string(root.join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

#[test]
fn a_new_pass_is_the_template_renamed() {
    let folder = fixture();
    let root = folder.path();
    let made = create(root, "cross-bilateral").unwrap();
    let names: Vec<String> = made.iter().map(|path| path.to_string_lossy().replace('\\', "/")).collect();
    let below = ["Cargo.toml", "README.md", "cross-bilateral.wgsl", "src/lib.rs", "tests/main.rs"];
    for file in below {
        assert!(names.contains(&format!("passes/cross-bilateral/{file}")), "{file} is not among {names:?}");
    }
    for name in &names {
        let text = read(root, name);
        for left in ["new-pass", "new_pass", "NewPass", "template"] {
            assert!(!text.contains(left), "{name} says `{left}`:\n{text}");
        }
    }
    let code = read(root, "passes/cross-bilateral/src/lib.rs");
    assert!(code.lines().count() <= 5 && code.contains("pass::from_wgsl!();"), "{code}");
    assert!(read(root, "passes/cross-bilateral/tests/main.rs").contains("use cross_bilateral::PASS;"));
    assert!(read(root, "passes/cross-bilateral/README.md").starts_with("# cross-bilateral\n"));
}

/// Nothing but the name differs: with the name put back it is the template, whose own tests pass.
#[test]
fn names_that_hold_the_templates_name_are_replaced_once() {
    let folder = fixture();
    let root = folder.path();
    create(root, "a-new-pass-b").unwrap();
    for file in ["Cargo.toml", "new-pass.wgsl", "src/lib.rs", "tests/main.rs"] {
        let back = read(root, &format!("passes/a-new-pass-b/{}", file.replace("new-pass", "a-new-pass-b")))
            .replace("passes/a-new-pass-b", "tools/new-pass")
            .replace("a-new-pass-b", "new-pass")
            .replace("a_new_pass_b", "new_pass")
            .replace("ANewPassB", "NewPass");
        let template = read(root, &format!("tools/new-pass/{file}"));
        let shared = template.split_inclusive('\n').filter(|line| !line.starts_with("publish."));
        assert_eq!(back, shared.collect::<String>(), "{file}");
    }
}

#[test]
fn the_catalog_gets_one_line_after_the_other_passes() {
    let folder = fixture();
    let root = folder.path();
    let before = read(root, CATALOG);
    create(root, "my-blur").unwrap();
    let after = read(root, CATALOG);
    let line = "my-blur = { path = \"../../passes/my-blur\", package = \"lightloom-my-blur\", version = \"";
    let is_its = |l: &str| l.starts_with(line);
    let others: Vec<&str> = after.lines().filter(|l| !is_its(l)).collect();
    assert_eq!(others, before.lines().collect::<Vec<_>>());
    let at = after.lines().position(is_its).unwrap();
    let passes: Vec<usize> =
        (0..).zip(after.lines()).filter(|(_, l)| l.contains("../../passes/")).map(|(i, _)| i).collect();
    assert_eq!(passes.last(), Some(&at));
}

#[test]
fn a_new_pass_is_tidy() {
    let folder = fixture();
    create(folder.path(), "my-blur").unwrap();
    let tree = Tree::read(folder.path()).unwrap();
    for (check, findings) in findings(&tree) {
        let on_it: Vec<_> =
            findings.iter().filter(|finding| finding.to_string().contains("passes/my-blur")).collect();
        assert!(on_it.is_empty(), "{}: {on_it:?}", check.name);
    }
}

#[test]
fn names_that_cannot_be_taken_are_refused_and_nothing_is_written() {
    let folder = fixture();
    let root = folder.path();
    fs::create_dir_all(root.join("passes/taken")).unwrap();
    let catalog = read(root, CATALOG);
    for (name, reason) in [
        ("", "words of a-z and 0-9"),
        ("MyBlur", "words of a-z and 0-9"),
        ("my_blur", "words of a-z and 0-9"),
        ("my--blur", "words of a-z and 0-9"),
        ("-blur", "words of a-z and 0-9"),
        ("2d-blur", "words of a-z and 0-9"),
        ("../blur", "words of a-z and 0-9"),
        ("flou-lumière", "words of a-z and 0-9"),
        ("loop", "cannot be the name of a crate"),
        ("taken", "there is passes/taken already"),
        ("new-pass", "there is tools/new-pass already"),
        ("wgpu", "the name of a dependency"),
        ("pass", "the name of a dependency"),
    ] {
        let error = create(root, name).unwrap_err().to_string();
        assert!(error.contains(reason), "`{name}`: {error}");
    }
    assert_eq!(read(root, CATALOG), catalog);
    let left: Vec<_> =
        fs::read_dir(root.join("passes")).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left, ["taken"]);
}
