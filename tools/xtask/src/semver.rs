//! `cargo xtask semver`: whether APIs changed no more than their version says.

use crate::cargo::{installed, run as run_command};
use anyhow::Result;
use std::path::Path;
use std::process::Command;

const TOOL: &str = "cargo-semver-checks@0.51.0";

/// The packages on which applications and crates with passes of their own depend.
const APIS: &[&str] = &["lightloom-renderer", "lightloom-pass", "lightloom-interfaces"];

/// Compares the APIs with those of a commit: by default that of the last release, a tag that begins with `v`. Where there is no release
/// there is nothing to compare with, and that is said.
///
/// # Errors
/// An API changed more than its version says, or a tool fails or is missing.
pub fn run(root: &Path, baseline: Option<&str>) -> Result<()> {
    let Some(baseline) = baseline.map(str::to_owned).or_else(|| last_release(root)) else {
        println!("skipped: the APIs, since there is no release to compare them with: no tag begins with `v`");
        return Ok(());
    };
    let mut check = Command::new(installed(root, TOOL)?);
    check.current_dir(root).args(["semver-checks", "--baseline-rev", &baseline]);
    for package in APIS {
        check.args(["--package", package]);
    }
    run_command(&mut check)
}

/// Returns the tag of the last release before this commit.
fn last_release(root: &Path) -> Option<String> {
    let mut describe = Command::new("git");
    describe.current_dir(root).args(["describe", "--tags", "--abbrev=0", "--match", "v*"]);
    let done = describe.output().ok().filter(|done| done.status.success())?;
    Some(String::from_utf8_lossy(&done.stdout).trim().to_owned())
}
