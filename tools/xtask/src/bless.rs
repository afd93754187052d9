//! `cargo xtask bless`: takes the results of tests as the expected ones.

use crate::cargo::{cargo, run as run_command};
use crate::tree::{Manifest, Tree};
use anyhow::{Context, Result};
use std::path::Path;
use std::process::Command;

/// Runs the tests of a package so that they rewrite their snapshots (insta) and images (those that heed
/// `LIGHTLOOM_BLESS`), and prints what has changed since the last commit.
pub fn run(root: &Path, package: &str, filter: Option<&str>) -> Result<()> {
    let tree = Tree::read(root)?;
    let manifest = tree.package(package);
    // Where there is no such package, cargo prints the nearest name.
    let package = manifest.and_then(Manifest::name).unwrap_or(package);
    let mut tests = cargo(root, "test");
    tests.args(["--locked", "--no-fail-fast", "--package", package]).args(filter);
    tests.env("LIGHTLOOM_BLESS", "1").env("INSTA_UPDATE", "always");
    let result = run_command(&mut tests);

    if let Some(folder) = manifest.map(Manifest::folder) {
        println!("\nChanged under {folder} since the last commit, sources apart:");
        let only = [folder, ":!*.rs", ":!*.wgsl", ":!*.toml", ":!*.md"];
        let git = |args: &[&str]| {
            run_command(Command::new("git").current_dir(root).args(args).arg("--").args(only))
        };
        git(&["--no-pager", "diff", "--stat", "HEAD"])?;
        git(&["ls-files", "--others", "--exclude-standard"])?;
    }
    result.context("a test fails for another reason than a snapshot")
}
