//! `demo` and `test` build packages with the same features, so that neither builds again what the other has built.

use std::collections::BTreeSet;
use xtask::cargo::cargo;
use xtask::demo::BUILT;
use xtask::test::BUILT as BUILT_OF_TESTS;
use xtask::tree::root;

/// Returns the packages that a build has, each with its features.
fn packages(args: &[&str]) -> BTreeSet<String> {
    let mut tree = cargo(&root(), "tree");
    tree.args(["--offline", "--prefix", "none", "--format", "{p} {f}"]);
    let output = tree.args(args).output().expect("cargo runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let lines = String::from_utf8(output.stdout).expect("text");
    lines.lines().map(|line| line.trim_end_matches(" (*)").trim_end().to_owned()).collect()
}

#[test]
#[cfg(target_os = "linux")]
fn demo_builds_nothing_that_test_builds_otherwise() {
    let demo = packages(&[BUILT, &["--edges", "normal,build"]].concat());
    let test = packages(&[BUILT_OF_TESTS, &["--edges", "normal,build,dev"]].concat());
    // The program itself has a window in tests.
    let others: Vec<&String> =
        demo.difference(&test).filter(|package| !package.starts_with("lightloom v")).collect();
    assert!(
        others.is_empty() && demo.len() > 100,
        "tools/shared-features lacks features that tests have of {others:#?}"
    );
}
