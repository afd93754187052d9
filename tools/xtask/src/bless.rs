//! `cargo xtask bless`: takes what tests make now as what they are compared with.

use crate::cargo::{cargo, run as run_command};
use crate::tree::Tree;
use anyhow::{Context, Result, bail};
use std::path::Path;
use std::process::Command;

/// Runs the tests of a package so that they rewrite their snapshots (insta) and images (those that heed
/// `LIGHTLOOM_BLESS`), and prints what has changed since the last commit.
pub fn run(root: &Path, package: &str, filter: Option<&str>) -> Result<()> {
    let folder = folder_of(&Tree::read(root)?, package)?;
    let mut tests = cargo(root, "test");
    tests.args(["--locked", "--no-fail-fast", "--package", package]).args(filter);
    tests.env("LIGHTLOOM_BLESS", "1").env("INSTA_UPDATE", "always");
    let result = run_command(&mut tests);

    println!("\nChanged under {folder} since the last commit, sources apart:");
    let only = [folder.as_str(), ":!*.rs", ":!*.wgsl", ":!*.toml", ":!*.md"];
    let git =
        |args: &[&str]| run_command(Command::new("git").current_dir(root).args(args).arg("--").args(only));
    git(&["--no-pager", "diff", "--stat", "HEAD"])?;
    git(&["ls-files", "--others", "--exclude-standard"])?;
    result.context("what still fails is no snapshot")
}

/// The folder of a package.
fn folder_of(tree: &Tree, package: &str) -> Result<String> {
    let names =
        || tree.manifests().iter().filter_map(|manifest| Some((manifest.package()?, manifest.folder())));
    if let Some((_, folder)) = names().find(|(name, _)| *name == package) {
        return Ok(folder.to_owned());
    }
    let nearest = names().max_by(|(a, _), (b, _)| {
        strsim::jaro_winkler(a, package).total_cmp(&strsim::jaro_winkler(b, package))
    });
    match nearest {
        Some((nearest, _)) => bail!("there is no package `{package}`; the nearest name is `{nearest}`"),
        None => bail!("there is no package `{package}`"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packages_are_found_by_name() {
        let tree = Tree::read(&crate::tree::root()).unwrap();
        assert_eq!(folder_of(&tree, "frame-graph").unwrap(), "crates/frame-graph");
        let error = folder_of(&tree, "frame-grahp").unwrap_err().to_string();
        assert_eq!(error, "there is no package `frame-grahp`; the nearest name is `frame-graph`");
    }
}
