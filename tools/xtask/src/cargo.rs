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

/// Returns a program of crates.io, given as `NAME@VERSION`, which is installed among the build outputs if it is not there. It is not
/// optimized, since it runs seldom.
pub fn installed(root: &Path, package: &str) -> Result<PathBuf> {
    let (name, version) = package.split_once('@').context("a version")?;
    let folder = root.join("target/tools").join(format!("{name}-{version}"));
    let program = folder.join("bin").join(format!("{name}{}", std::env::consts::EXE_SUFFIX));
    if !program.is_file() {
        let mut install = cargo(root, "install");
        install.args(["--debug", "--quiet", "--locked", package, "--root"]).arg(&folder);
        run(install
            .arg("--target-dir")
            .arg(root.join("target/tools/build"))
            .env("CARGO_PROFILE_DEV_DEBUG", "0"))?;
    }
    Ok(program)
}
