//! `cargo xtask new-pass`: a pass to begin with.
//!
//! The template is tools/new-pass, a pass of the workspace like any other, so it is compiled and tested. A new pass
//! is a copy of it with another name.

use anyhow::{Context, Result, bail, ensure};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const TEMPLATE: &str = "tools/new-pass";
const CATALOG: &str = "crates/catalog/Cargo.toml";

/// Names that a crate cannot have: the keywords of Rust, and the crates that every crate knows.
const RESERVED: &str = "abstract alloc as async await become box break const continue core crate do dyn else enum extern false \
    final fn for gen if impl in let loop macro match mod move mut override priv proc-macro pub ref return \
    self static std struct super test trait true try type typeof unsafe unsized use virtual where while yield";

/// Makes the pass and says what to do next.
pub fn run(root: &Path, name: &str) -> Result<()> {
    let files = create(root, name)?;
    // The order of imports and the breaks of lines depend on the name. The pass is right without it, too.
    let sources = files.iter().filter(|path| path.extension().is_some_and(|extension| extension == "rs"));
    let formatted =
        Command::new("rustfmt").current_dir(root).args(["--edition", "2024"]).args(sources).status();
    if !formatted.is_ok_and(|status| status.success()) {
        eprintln!("warning: rustfmt did not run; `cargo fmt --package lightloom-{name}` formats the pass");
    }
    for path in &files {
        println!("made    {}", path.display());
    }
    println!("changed {CATALOG}");
    println!(
        "
Next:
  cargo test --package lightloom-{name}
      the pass multiplies radiance by a gain
  \"{name}\": Pass(kind: \"{name}\", in: {{ \"radiance\": \"direct\" }}, set: {{ \"gain\": 2.0 }}),
      a use of it in a pipeline; `lightloom passes {name}` prints its ports and settings
  passes/{name}/{name}.wgsl, tests/main.rs, README.md
      make it compute what you want; docs/first-pass.md explains how
  cargo xtask docs
      writes its ports and settings into its README, and its name into the table of interfaces
  cargo xtask tidy
      checks the rules for passes"
    );
    Ok(())
}

/// Makes `passes/NAME` and its line in the catalog; the files made, from the root. Nothing is written where the
/// name cannot be taken.
pub fn create(root: &Path, name: &str) -> Result<Vec<PathBuf>> {
    check_name(name)?;
    for folder in ["passes", "crates", "tools", "examples"].map(|folder| format!("{folder}/{name}")) {
        ensure!(!root.join(&folder).exists(), "there is {folder} already");
    }
    let workspace = read(&root.join("Cargo.toml"))?;
    let is_dependency = |line: &str| line.split_once('=').is_some_and(|(key, _)| key.trim() == name);
    ensure!(!workspace.lines().any(is_dependency), "`{name}` is the name of a dependency of the workspace");
    let catalog = with_line(&read(&root.join(CATALOG))?, name)?;

    let mut made = Vec::new();
    for from in files_below(&root.join(TEMPLATE))? {
        let below = from.strip_prefix(root.join(TEMPLATE)).unwrap_or(&from).to_string_lossy().into_owned();
        let path = Path::new("passes").join(name).join(renamed(&below, name));
        let to = root.join(&path);
        if let Some(folder) = to.parent() {
            fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
        }
        write(&to, &renamed(&read(&from)?, name))?;
        made.push(path);
    }
    write(&root.join(CATALOG), &catalog)?;
    Ok(made)
}

fn check_name(name: &str) -> Result<()> {
    let well_formed = name.split('-').all(|word| {
        !word.is_empty() && word.bytes().all(|byte| byte.is_ascii_lowercase() || byte.is_ascii_digit())
    });
    if !well_formed || !name.starts_with(|first: char| first.is_ascii_lowercase()) {
        bail!("`{name}` is no name of a pass: words of a-z and 0-9 joined by `-`, such as `cross-bilateral`");
    }
    ensure!(!RESERVED.split_whitespace().any(|word| word == name), "`{name}` cannot be the name of a crate");
    Ok(())
}

/// The catalog's manifest with one pass more, after all others.
fn with_line(catalog: &str, name: &str) -> Result<String> {
    let mut lines: Vec<&str> = catalog.lines().collect();
    let last = lines.iter().rposition(|line| line.contains("path = \"../../passes/"));
    let last = last.with_context(|| format!("{CATALOG} lists no pass to put this one after"))?;
    let line = catalog_line(name);
    lines.insert(last + 1, &line);
    Ok(lines.join("\n") + "\n")
}

/// The line by which the catalog depends on a pass.
pub(crate) fn catalog_line(name: &str) -> String {
    format!(
        "{name} = {{ path = \"../../passes/{name}\", package = \"lightloom-{name}\", version = \"{}\" }}",
        env!("CARGO_PKG_VERSION")
    )
}

/// A text of the template for a pass of that name; without what is said of the template as such.
fn renamed(text: &str, name: &str) -> String {
    let camel: String = name.split('-').map(|word| word[..1].to_uppercase() + &word[1..]).collect();
    let about_the_template = |line: &&str| line.contains("`cargo xtask new-pass`");
    let text: String = text.split_inclusive('\n').filter(|line| !about_the_template(line)).collect();
    let names = [
        (TEMPLATE, &*format!("passes/{name}")),
        ("new-pass", name),
        ("new_pass", &name.replace('-', "_")),
        ("NewPass", &camel),
    ];
    replaced(&text, &names)
}

/// With all of these replaced, and nothing in what has taken their place.
fn replaced(text: &str, names: &[(&str, &str)]) -> String {
    let Some(((from, to), rest)) = names.split_first() else { return text.to_owned() };
    text.split(from).map(|part| replaced(part, rest)).collect::<Vec<_>>().join(to)
}

fn files_below(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in folder.read_dir().with_context(|| format!("cannot read {}", folder.display()))? {
        let path = entry?.path();
        if path.is_dir() { files.extend(files_below(&path)?) } else { files.push(path) }
    }
    files.sort();
    Ok(files)
}

fn read(path: &Path) -> Result<String> {
    fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))
}

fn write(path: &Path, text: &str) -> Result<()> {
    fs::write(path, text).with_context(|| format!("cannot write {}", path.display()))
}
