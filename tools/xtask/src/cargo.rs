//! Cargo, and the programs that it builds.

use anyhow::{Context, Result, ensure};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Creates a command of the cargo that runs this program, in the tree.
pub fn cargo(root: &Path, subcommand: &str) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(root).arg(subcommand);
    command
}

/// Runs a command to its end. Errors where it cannot start or fails.
pub fn run(command: &mut Command) -> Result<()> {
    let status = command.status().with_context(|| format!("cannot run {command:?}"))?;
    ensure!(status.success(), "{command:?} failed: {status}");
    Ok(())
}

/// Returns the program of that name, which a build has put beside this one: both are of the dev profile.
pub fn built(name: &str) -> Result<PathBuf> {
    let this = std::env::current_exe().context("cannot find the folder of this program")?;
    let path = this.with_file_name(format!("{name}{}", std::env::consts::EXE_SUFFIX));
    ensure!(path.is_file(), "the build left no {}", path.display());
    Ok(path)
}
