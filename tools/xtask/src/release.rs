//! `cargo xtask wheel` and `cargo xtask release`: what users install. Nothing is published.

use crate::cargo::{cargo, installed, run as run_command};
use anyhow::{Context, Result, ensure};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The versions of the tools that build wheels and lists of what is built in; they are installed among the build outputs.
const MATURIN: &str = "maturin[zig]==1.16.0";
const SBOM: &str = "cargo-sbom@0.10.0";

/// The oldest systems on which a wheel runs (PEP 599): those with glibc 2.17. Zig links against that, on a system with a newer one.
const COMPATIBILITY: &str = "manylinux2014";

/// The most bytes of a wheel.
const MOST: u64 = 30_000_000;

/// The most bytes of the program without its symbols.
const MOST_OF_PROGRAM: u64 = 40_000_000;

/// Builds the wheel of the Python package, and returns where it is.
///
/// # Errors
/// There is no Python that can install maturin, the build fails, or the wheel is too large.
pub fn wheel(root: &Path) -> Result<PathBuf> {
    let tools = root.join("target/tools/maturin");
    let maturin = tools.join("bin/maturin");
    if !maturin.is_file() {
        run_command(Command::new("python3").args(["-m", "venv"]).arg(&tools))
            .context("Python with venv is needed: on Debian or Ubuntu, `apt-get install python3-venv`")?;
        run_command(Command::new(tools.join("bin/pip")).args(["install", "--quiet", MATURIN]))?;
    }
    let folder = root.join("target/wheels");
    // Zig is found by the Python that is first in the path.
    let path = std::env::var_os("PATH").unwrap_or_default();
    let path = std::env::join_paths([tools.join("bin")].into_iter().chain(std::env::split_paths(&path)))?;
    let mut build = Command::new(maturin);
    build.current_dir(root.join("crates/python")).args(["build", "--release", "--zig"]);
    build.args(["--compatibility", COMPATIBILITY, "--out"]).arg(&folder).env("PATH", path);
    run_command(build.env(COMMIT, commit(root)?))?;
    let wheel = newest(&folder, "whl")?;
    check_size(&wheel, MOST)?;
    Ok(wheel)
}

/// Prints how large a file is. Errors where it has more than so many bytes.
fn check_size(path: &Path, most: u64) -> Result<()> {
    let bytes = fs::metadata(path)?.len();
    ensure!(bytes <= most, "{} has {bytes} bytes; at most {most} are allowed", path.display());
    println!("{} ({:.1} MB)", path.display(), bytes as f64 / 1e6);
    Ok(())
}

/// The variable by which the program learns the commit that it is built from.
const COMMIT: &str = "LIGHTLOOM_COMMIT";

/// Returns the commit of the tree, with `-changed` where files differ from it.
fn commit(root: &Path) -> Result<String> {
    let git = |arguments: &[&str]| -> Result<String> {
        let done = Command::new("git").current_dir(root).args(arguments).output()?;
        ensure!(
            done.status.success(),
            "git {}: {}",
            arguments.join(" "),
            String::from_utf8_lossy(&done.stderr)
        );
        Ok(String::from_utf8(done.stdout)?.trim().to_owned())
    };
    let changed = if git(&["status", "--porcelain"])?.is_empty() { "" } else { "-changed" };
    Ok(format!("{}{changed}", git(&["rev-parse", "HEAD"])?))
}

/// The newest file of a folder with an ending.
fn newest(folder: &Path, ending: &str) -> Result<PathBuf> {
    let files = fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<Result<Vec<PathBuf>>>()?;
    let with_ending = files.into_iter().filter(|path| path.extension().is_some_and(|found| found == ending));
    with_ending
        .max_by_key(|path| fs::metadata(path).and_then(|of| of.modified()).ok())
        .with_context(|| format!("no .{ending} in {}", folder.display()))
}

/// Builds all that a release has into `target/release-files`: an archive with the program, its manual and its completions; its symbols;
/// the wheel; a list of all packages that are built in (CycloneDX); and the checksums of these.
///
/// # Errors
/// A build or a tool fails, or is missing.
pub fn run(root: &Path) -> Result<()> {
    let folder = root.join("target/release-files");
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    let name = format!("lightloom-{}-{}-linux", env!("CARGO_PKG_VERSION"), std::env::consts::ARCH);
    let inner = folder.join(&name);
    fs::create_dir_all(&inner)?;

    let build = ["--locked", "--profile", "dist", "--package", "lightloom"];
    run_command(cargo(root, "build").args(build).env(COMMIT, commit(root)?))?;
    let (program, symbols) = (inner.join("lightloom"), folder.join(format!("{name}.debug")));
    fs::copy(root.join("target/dist/lightloom"), &program)?;
    run_command(Command::new("objcopy").arg("--only-keep-debug").args([&program, &symbols]))?;
    run_command(Command::new("strip").arg(&program))?;
    let link = format!("--add-gnu-debuglink={}", symbols.display());
    run_command(Command::new("objcopy").arg(link).arg(&program))?;
    check_size(&program, MOST_OF_PROGRAM)?;

    for (shell, file) in [("bash", "lightloom"), ("zsh", "_lightloom"), ("fish", "lightloom.fish")] {
        let completions = inner.join("completions").join(shell);
        fs::create_dir_all(&completions)?;
        let done = Command::new(&program).args(["completions", shell]).output()?;
        ensure!(done.status.success(), "completions of {shell}: {}", String::from_utf8_lossy(&done.stderr));
        fs::write(completions.join(file), done.stdout)?;
    }
    run_command(Command::new(&program).args(["man", "-o"]).arg(inner.join("man/man1")))?;
    for file in ["LICENSE-APACHE", "LICENSE-MIT", "README.md", "CHANGELOG.md"] {
        fs::copy(root.join(file), inner.join(file))?;
    }
    let archive = folder.join(format!("{name}.tar.gz"));
    run_command(Command::new("tar").arg("-C").arg(&folder).arg("-czf").arg(&archive).arg(&name))?;
    fs::remove_dir_all(&inner)?;

    let wheel = wheel(root)?;
    fs::copy(&wheel, folder.join(wheel.file_name().context("the wheel has a name")?))?;
    list_of_packages(root, &folder.join(format!("{name}.cdx.json")))?;
    checksums(&folder)?;
    println!("{}", folder.display());
    Ok(())
}

/// Writes the list of all packages that the program is built from.
fn list_of_packages(root: &Path, path: &Path) -> Result<()> {
    let mut list = Command::new(installed(root, SBOM)?);
    list.current_dir(root).args([
        "sbom",
        "--cargo-package",
        "lightloom",
        "--output-format",
        "cyclone_dx_json_1_6",
    ]);
    let done = list.output()?;
    ensure!(done.status.success(), "cargo-sbom: {}", String::from_utf8_lossy(&done.stderr));
    fs::write(path, done.stdout)?;
    Ok(())
}

/// Writes the checksums of all files of a folder, as `sha256sum --check` reads them.
fn checksums(folder: &Path) -> Result<()> {
    let mut names: Vec<String> = Vec::new();
    for entry in fs::read_dir(folder)? {
        names.push(entry?.file_name().to_string_lossy().into_owned());
    }
    names.sort();
    let done = Command::new("sha256sum").current_dir(folder).args(&names).output()?;
    ensure!(done.status.success(), "sha256sum: {}", String::from_utf8_lossy(&done.stderr));
    fs::write(folder.join("SHA256SUMS"), done.stdout)?;
    Ok(())
}
