//! `cargo xtask mutate-shaders`: whether tests notice small changes of WGSL.

mod changes;

pub use changes::{Change, changes};

use crate::test_programs::{TestProgram, test_programs};
use crate::tree::{File, Tree, line_at};
use anyhow::{Context, Result, ensure};
use std::collections::{BTreeMap, BTreeSet};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// Which changes are tried.
#[derive(Clone, Debug)]
pub struct Options {
    /// Other seeds draw other changes.
    pub seed: u64,
    /// The number of changes.
    pub count: usize,
    /// The most packages whose tests run for a file that passes share.
    pub packages: usize,
    /// The most seconds that the tests of a package may take.
    pub limit: u64,
    /// Only files whose path contains this.
    pub filter: String,
}

/// Draws changes, makes each in its file, runs the tests of the packages that use the file until one fails, and prints a table of
/// what became of them. The file is as it was afterwards, also when it is interrupted.
pub fn run(root: &Path, options: &Options) -> Result<()> {
    let stopped = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stopped);
    ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed)).context("Ctrl-C cannot be taken")?;
    let tree = Tree::read(root)?;
    let drawn = draw(&tree, options);
    ensure!(
        !drawn.is_empty(),
        "no WGSL of passes/ or shaders/ is in a file whose path contains `{}`",
        options.filter
    );
    let users: BTreeMap<&str, Vec<String>> =
        drawn.iter().map(|(file, _)| (&*file.path, users(&tree, &file.path, options.packages))).collect();
    let tests = build(&tree, users.values().flatten())?;

    println!("| place | change | verdict |\n|---|---|---|");
    let mut counts = BTreeMap::new();
    for (file, change) in &drawn {
        let (at, old) = (change.at.start, &file.text[change.at.clone()]);
        let column = at - file.text[..at].rfind('\n').map_or(0, |newline| newline + 1) + 1;
        // A `|` would end the cell.
        let made = format!("`{old}` → `{}`", change.new).replace('|', "\\|");
        print!("| {}:{}:{column} | {made} | ", file.path, line_at(&file.text, at));
        std::io::stdout().flush()?;
        let verdict = {
            let _changed = Changed::new(root, file, change)?;
            let own: Vec<&Tests> =
                users[&*file.path].iter().filter_map(|package| tests.get(package)).collect();
            judge(&own, Duration::from_secs(options.limit))?
        };
        if stopped.load(Ordering::Relaxed) {
            println!("interrupted |");
            break;
        }
        println!("{verdict} |");
        *counts.entry(verdict.split(' ').next().unwrap_or_default().to_owned()).or_insert(0) += 1;
    }
    println!();
    for (verdict, count) in counts {
        println!("{count} {verdict}");
    }
    Ok(())
}

/// Returns the changes that the options choose, in the order in which they are tried.
pub fn draw<'a>(tree: &'a Tree, options: &Options) -> Vec<(&'a File, Change)> {
    let files = ["passes", "shaders"].into_iter().flat_map(|folder| tree.below(folder));
    let wanted = files.filter(|file| file.is("wgsl") && file.path.contains(&options.filter));
    let mut all: Vec<_> =
        wanted.flat_map(|file| changes(&file.text).into_iter().map(move |change| (file, change))).collect();
    // Fisher & Yates, with random numbers by splitmix64.
    let mut state = options.seed;
    let count = options.count.min(all.len());
    for i in 0..count {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        let rest = (all.len() - i) as u64;
        all.swap(i, i + ((mixed ^ (mixed >> 31)) % rest) as usize);
    }
    all.truncate(count);
    all
}

/// Returns the packages whose tests run for a WGSL file, at most `most`: that of the pass, and those whose tests name the file; for a
/// file that passes share also those that import it, directly before indirectly.
pub fn users(tree: &Tree, path: &str, most: usize) -> Vec<String> {
    let folder = |path: &str| path.split('/').take(2).collect::<Vec<_>>().join("/");
    let package = |path: &str| {
        let manifest = tree.manifests().iter().find(|manifest| manifest.folder() == folder(path));
        manifest.and_then(|manifest| manifest.package()).map(str::to_owned)
    };
    let mut found: Vec<String> = package(path).into_iter().collect();
    let mut add = |file: &File| found.extend(package(&file.path).filter(|package| !found.contains(package)));
    // A file of a pass is named by its path, as others have its name; shared ones are imported by their names.
    let name = |path: &str| path.rsplit('/').next().unwrap_or(path).to_owned();
    let is_shared = path.starts_with("shaders/");
    let mut names = BTreeSet::from([if is_shared { name(path) } else { path.to_owned() }]);
    let quoted = |file: &File, names: &BTreeSet<String>| {
        names.iter().any(|name| file.text.contains(&format!("{name}\"")))
    };
    let rust = || tree.files().iter().filter(|file| file.is("rs"));
    rust().filter(|file| file.path.contains("/tests/") && quoted(file, &names)).for_each(&mut add);
    let mut known = 0;
    while is_shared && known < names.len() {
        known = names.len();
        let importers = || tree.files().iter().filter(|file| file.is("wgsl") && quoted(file, &names));
        importers().filter(|file| file.path.starts_with("passes/")).for_each(&mut add);
        let imported: Vec<String> = importers().map(|file| name(&file.path)).collect();
        names.extend(imported);
    }
    // Modules that Rust names.
    let is_module = |file: &&File| is_shared && file.path.starts_with("passes/") && quoted(file, &names);
    rust().filter(is_module).for_each(&mut add);
    found.truncate(most);
    found
}

/// The programs of the tests of a package.
struct Tests(Vec<TestProgram>);

/// Builds all tests, once, since they read shaders when they run, and as `cargo xtask test` does, which has mostly built them; returns
/// those of these packages.
fn build<'a>(tree: &Tree, packages: impl Iterator<Item = &'a String>) -> Result<BTreeMap<String, Tests>> {
    let mut programs = test_programs(tree.root())?;
    let mut of = |package: &String| {
        let folder = tree.root().join(tree.package(package)?.folder());
        Some((package.clone(), Tests(programs.extract_if(.., |program| program.folder == folder).collect())))
    };
    Ok(packages.collect::<BTreeSet<_>>().into_iter().filter_map(&mut of).collect())
}

/// A file while it is changed; dropped, it is as it was.
struct Changed<'a> {
    path: PathBuf,
    text: &'a str,
}

impl<'a> Changed<'a> {
    fn new(root: &Path, file: &'a File, change: &Change) -> Result<Changed<'a>> {
        let changed = Changed { path: root.join(&file.path), text: &file.text };
        let mut text = file.text.clone();
        text.replace_range(change.at.clone(), &change.new);
        std::fs::write(&changed.path, text).with_context(|| format!("cannot write {}", file.path))?;
        Ok(changed)
    }
}

impl Drop for Changed<'_> {
    fn drop(&mut self) {
        if let Err(error) = std::fs::write(&self.path, self.text) {
            eprintln!("error: {} stays changed: {error}", self.path.display());
        }
    }
}

/// The test that fails where a change is no valid WGSL (`pass_test::shaders_are_valid!`).
const VALIDITY: &str = "every_variant_of_the_shaders_is_valid";

/// Says what becomes of the change that is made now, by the tests of these packages.
fn judge(packages: &[&Tests], limit: Duration) -> Result<String> {
    for tests in packages {
        if tests.run(Some(VALIDITY), limit)?.is_some() {
            return Ok("invalid".into());
        }
    }
    for tests in packages {
        if let Some(test) = tests.run(None, limit)? {
            return Ok(format!("killed by {test}"));
        }
    }
    Ok(if packages.is_empty() { "untested" } else { "survives" }.into())
}

impl Tests {
    /// Returns the first test that fails, of those whose names contain the filter, and its package.
    fn run(&self, filter: Option<&str>, limit: Duration) -> Result<Option<String>> {
        for program in &self.0 {
            let mut command = program.command();
            command.args(filter).env("INSTA_UPDATE", "no").stdout(Stdio::piped()).stderr(Stdio::null());
            let mut child = command.spawn().with_context(|| format!("cannot run {command:?}"))?;
            let failed = first_failure(&mut child, Instant::now() + limit);
            if failed.is_some() {
                // It may have ended by itself.
                drop(child.kill());
            }
            let status = child.wait()?;
            if failed.is_some() || !status.success() {
                let failed = failed.unwrap_or_else(|| format!("an end by {status}"));
                let package = program.folder.file_name().unwrap_or_default().to_string_lossy();
                return Ok(Some(format!("{failed} of {package}")));
            }
        }
        Ok(None)
    }
}

/// Reads the lines of libtest up to the first failure, the end or the deadline.
fn first_failure(child: &mut Child, deadline: Instant) -> Option<String> {
    let (send, lines) = channel();
    let output = child.stdout.take()?;
    std::thread::spawn(move || {
        BufReader::new(output).lines().map_while(Result::ok).try_for_each(|line| send.send(line))
    });
    loop {
        match lines.recv_timeout(deadline.saturating_duration_since(Instant::now())) {
            Ok(line) => {
                if let Some(name) =
                    line.strip_prefix("test ").and_then(|line| line.strip_suffix(" ... FAILED"))
                {
                    return Some(name.to_owned());
                }
            }
            Err(RecvTimeoutError::Timeout) => return Some("the time limit".into()),
            Err(RecvTimeoutError::Disconnected) => return None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_changed_only_as_long_as_it_is_judged() {
        let folder = tempfile::tempdir().unwrap();
        let file = File { path: "a.wgsl".into(), text: "1 + 2\n".into() };
        let path = folder.path().join("a.wgsl");
        let changed = Changed::new(folder.path(), &file, &Change { at: 2..3, new: "-".into() }).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "1 - 2\n");
        drop(changed);
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "1 + 2\n");
    }
}
