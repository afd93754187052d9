//! The Python package as Python sees it: its tests, its examples and its types, in a virtual environment among the build outputs.
//!
//! The package is put together from what was built, without a wheel; `cargo xtask wheel` makes one.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;

/// What the tests need, beside NumPy.
const NEEDED: &[&str] = &["numpy", "pytest", "mypy", "nbclient", "ipykernel"];

fn package() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// The folder for build outputs: this program is in its folder `deps`.
fn outputs() -> PathBuf {
    let this = std::env::current_exe().unwrap();
    this.ancestors().nth(3).unwrap().to_owned()
}

fn succeeds(command: &mut Command) -> bool {
    command.stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok_and(|status| status.success())
}

/// Returns a Python that has what the tests need; `None`, said on stderr, where there is no Python 3.10, or it cannot install them.
fn python() -> Option<PathBuf> {
    static FOUND: OnceLock<Option<PathBuf>> = OnceLock::new();
    FOUND.get_or_init(find_python).clone()
}

fn find_python() -> Option<PathBuf> {
    let folder = outputs().join("python");
    let python = folder.join("bin/python");
    let has_all =
        || succeeds(Command::new(&python).args(["-c", "import numpy, pytest, mypy, nbclient, ipykernel"]));
    let is_new = ["-c", "import sys; sys.exit(sys.version_info < (3, 10))"];
    let install = ["-m", "pip", "install", "--retries", "1", "--timeout", "20"];
    let made = has_all()
        || (succeeds(Command::new("python3").args(is_new))
            && succeeds(Command::new("python3").args(["-m", "venv"]).arg(&folder))
            && succeeds(Command::new(&python).args(install).args(NEEDED))
            && has_all());
    if !made {
        eprintln!("skipped: Python cannot install {} in {}", NEEDED.join(", "), folder.display());
    }
    made.then_some(python)
}

/// Puts the package together from its files and what was built, and returns the folder that holds it.
fn site() -> tempfile::TempDir {
    let site = tempfile::tempdir().unwrap();
    let package = package().join("lightloom");
    let within = site.path().join("lightloom");
    std::fs::create_dir(&within).unwrap();
    for entry in std::fs::read_dir(package).unwrap() {
        let path = entry.unwrap().path();
        if path.is_file() {
            std::fs::copy(&path, within.join(path.file_name().unwrap())).unwrap();
        }
    }
    let built = std::env::current_exe().unwrap().with_file_name("lib_lightloom.so");
    std::os::unix::fs::symlink(built, within.join("_lightloom.abi3.so")).unwrap();
    site
}

/// Runs a module of Python on the package, in a folder that is outside of any tree.
fn run(module: &str, arguments: &[&Path]) {
    let Some(python) = python() else { return };
    let (site, elsewhere) = (site(), tempfile::tempdir().unwrap());
    let mut command = Command::new(python);
    command.current_dir(elsewhere.path()).args(["-m", module]);
    for argument in arguments {
        // What is not in the tree is in the package.
        command.arg(if argument.starts_with("lightloom") {
            site.path().join(argument)
        } else {
            argument.to_path_buf()
        });
    }
    command.env("PYTHONPATH", site.path()).env("PYTHONDONTWRITEBYTECODE", "1");
    let done = command.output().unwrap();
    let (out, err) = (String::from_utf8_lossy(&done.stdout), String::from_utf8_lossy(&done.stderr));
    assert!(done.status.success(), "{module}: {}\n{out}\n{err}", done.status);
    println!("{}", out.lines().last().unwrap_or_default());
}

fn pytest(what: &[&Path]) {
    let config = package().join("pyproject.toml");
    let fixed: [&Path; 3] = ["-q".as_ref(), "-c".as_ref(), &config];
    run("pytest", &[&fixed, what].concat());
}

#[test]
#[ignore = "slow"]
fn the_tests_in_python_pass() {
    pytest(&[&package().join("tests")]);
}

#[test]
#[ignore = "slow"]
fn the_examples_of_documentation_are_true() {
    pytest(&["lightloom".as_ref(), &package().join("README.md")]);
}

#[test]
#[ignore = "slow"]
fn the_types_are_checked() {
    run("mypy", &["--strict".as_ref(), "lightloom".as_ref()]);
}
