//! `cargo xtask test`: the tests, with a summary.

use crate::cargo::{built, cargo, run as run_command};
use crate::packages::Consent;
use crate::test_programs::{Named, TestProgram, run_all, test_programs};
use crate::{gpu, optional};
use anyhow::{Result, bail};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

/// The program of tests that runs about as long as all others together: it begins first, beside the others.
const LONGEST: &str = "whole-program";

/// The packages and features that are built: all packages, with a window on X11 and without what else a desktop offers, which no test uses.
pub const BUILT: &[&str] =
    &["--locked", "--workspace", "--no-default-features", "--features", "lightloom/window"];

/// Where Mesa keeps shaders that it has compiled. By default that is in the home, and tests that give a program a home of its own, or have
/// none, would compile all of them again: half of the time of many tests.
const SHADER_CACHE: &str = "MESA_SHADER_CACHE_DIR";

/// Lets tests that pass say what they skipped, and what ran.
const TELLING: &str = "--show-output";

/// Runs the slow tests too, which are marked by `#[ignore]`; the measurements that are marked likewise are no tests.
const ALL: &[&str] = &["--include-ignored", "--skip", "measurement"];

/// Builds everything once, ensures that there are an adapter, a browser and an X server, and runs the tests; `all` of
/// them, or those that are not marked as slow.
pub fn run(root: &Path, consent: Consent, all: bool) -> Result<()> {
    let start = Instant::now();
    println!("Building Lightloom and its tests (some minutes the first time)");
    // What `cargo test` builds, and the program: one build, for which features are resolved once.
    run_command(cargo(root, "build").args(BUILT).args(["--bins", "--tests"]))?;
    let adapters = gpu::ensure(&built("lightloom")?, consent)?;
    check(&adapters, all)?;
    optional::ensure(consent);

    let mut programs = test_programs(root)?;
    programs.sort_by_key(|program| program.target != LONGEST);
    let on_cpu = gpu::on_cpu(&adapters) && std::env::var_os("RUST_TEST_THREADS").is_none();
    let named = |program: &TestProgram| {
        let mut command = program.command();
        command.arg(TELLING).args(if all { ALL } else { &[] });
        if on_cpu {
            command.env("RUST_TEST_THREADS", threads_on_cpu(&program.target));
        }
        let folder = program.folder.strip_prefix(root).unwrap_or(&program.folder);
        Named { name: format!("{} {}", folder.display(), program.target), command }
    };
    let mut commands: Vec<Named> = programs.iter().map(named).collect();
    let mut examples = cargo(root, "test");
    examples.args(BUILT).args(["--doc", "--no-fail-fast", "--quiet"]);
    commands.push(Named { name: "the examples of documentation".to_owned(), command: examples });
    for Named { command, .. } in &mut commands {
        quieten_mesa(command, std::env::var_os("XDG_RUNTIME_DIR").is_some());
        if std::env::var_os(SHADER_CACHE).is_none() {
            command.env(SHADER_CACHE, root.join("target/shader-cache"));
        }
    }
    let mut summary = Summary::default();
    for ended in run_all(commands, Summary::read)? {
        if !ended.status.success() && ended.read.failed.is_empty() {
            summary.failed.push(format!("{}: {}", ended.name, ended.status));
        }
        summary.add(ended.read);
    }

    println!("\n{summary}, in {} s", start.elapsed().as_secs());
    if summary.ignored > 0 && !all {
        println!("The ignored tests are slow; `cargo xtask test --all` runs them too");
    }
    if adapters.is_empty() {
        println!("There is no adapter: tests that need one did nothing and passed. {}", gpu::advice());
    } else {
        println!("On {}", adapters.join("; "));
    }
    if !summary.failed.is_empty() {
        bail!("not all tests pass");
    }
    Ok(())
}

/// Returns how many tests of a program run at once on a renderer on the CPU, where each of them takes all cores for a part of its time.
fn threads_on_cpu(target: &str) -> &'static str {
    if target == LONGEST { "2" } else { "1" }
}

/// Turns off the Vulkan layer of Mesa that asks Wayland which device to prefer: where there is no runtime folder it can ask
/// nothing, and prints an error in each process that opens a device.
fn quieten_mesa(command: &mut Command, has_runtime_folder: bool) {
    if !has_runtime_folder {
        command.env("NODEVICE_SELECT", "1");
    }
}

/// Counts of tests, the names of those that failed, and what the others skipped or ran. One reads the output of one program.
#[derive(Debug, Default)]
struct Summary {
    passed: u32,
    ignored: u32,
    failed: Vec<String>,
    /// Lines such as `skipped: there is no Slurm`, with the number of tests that print them.
    said: BTreeMap<String, u32>,
    /// Whether the lines are of what tests that passed print.
    of_passed: bool,
}

impl Summary {
    /// Adds what the output of another program said.
    fn add(&mut self, other: Summary) {
        self.passed += other.passed;
        self.ignored += other.ignored;
        self.failed.extend(other.failed);
        for (line, tests) in other.said {
            *self.said.entry(line).or_default() += tests;
        }
    }

    /// Reads one line of libtest's output; returns whether it is printed: what tests that passed print is not.
    fn read(&mut self, line: &str) -> bool {
        if line == "successes:" {
            self.of_passed = true;
        } else if line == "failures:" || line.starts_with("test result: ") {
            self.of_passed = false;
        }
        if self.of_passed && (line.starts_with("skipped: ") || line.starts_with("ran: ")) {
            *self.said.entry(line.to_owned()).or_default() += 1;
        }
        if let Some(counts) = line.strip_prefix("test result: ") {
            let count = |what: &str| {
                let words: Vec<&str> = counts.split([' ', ';']).collect();
                words
                    .windows(2)
                    .find(|pair| pair[1] == what)
                    .and_then(|pair| pair[0].parse().ok())
                    .unwrap_or(0)
            };
            self.passed += count("passed");
            self.ignored += count("ignored");
        } else if let Some(name) =
            line.strip_prefix("test ").and_then(|line| line.strip_suffix(" ... FAILED"))
        {
            self.failed.push(name.to_owned());
        }
        !self.of_passed
    }
}

impl std::fmt::Display for Summary {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for name in &self.failed {
            writeln!(f, "failed: {name}")?;
        }
        for (line, tests) in &self.said {
            let times = if *tests > 1 { format!(" ({tests} tests)") } else { String::new() };
            writeln!(f, "{line}{times}")?;
        }
        write!(f, "{} passed, {} failed, {} ignored", self.passed, self.failed.len(), self.ignored)
    }
}

/// Fails where all tests are to run and there is no adapter: those that need one would do nothing and pass.
fn check(adapters: &[String], all: bool) -> Result<()> {
    if all && adapters.is_empty() {
        bail!("there is no adapter, and without one not all tests run. {}", gpu::advice());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_tests_need_an_adapter() {
        let some = ["llvmpipe".to_owned()];
        let found = [(&some[..], true), (&some, false), (&[], false), (&[], true)];
        assert_eq!(found.map(|(adapters, all)| check(adapters, all).is_ok()), [true, true, true, false]);
    }

    #[test]
    fn mesa_asks_no_wayland_where_there_is_none() {
        for (has_runtime_folder, expected) in [(false, Some("1")), (true, None)] {
            let mut command = Command::new("cargo");
            quieten_mesa(&mut command, has_runtime_folder);
            let set = command.get_envs().find(|(name, _)| *name == "NODEVICE_SELECT");
            assert_eq!(set.and_then(|(_, value)| value?.to_str()), expected);
        }
    }

    #[test]
    fn the_summary_adds_up_over_binaries() {
        let mut summary = Summary::default();
        let output = "running 4 tests
test a ... ok
test b::c ... FAILED
test d ... ignored
test e ... ok

successes:

---- a stdout ----
error: noise
skipped: there is no Slurm

---- e stdout ----
skipped: there is no Slurm
ran: Snakemake on this machine

successes:
    a
    e

failures:

---- b::c stdout ----
expected 1

failures:
    b::c

test result: FAILED. 2 passed; 1 failed; 1 ignored; 0 measured; 0 filtered out; finished in 0.00s
test result: ok. 12 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 1.20s";
        let printed: Vec<&str> = output.lines().filter(|line| summary.read(line)).collect();
        let expected = "failed: b::c\nran: Snakemake on this machine\nskipped: there is no Slurm (2 tests)\n\
                        14 passed, 1 failed, 1 ignored";
        assert_eq!(summary.to_string(), expected);
        assert!(printed.contains(&"expected 1") && !printed.contains(&"error: noise"), "{printed:?}");
    }
}
