//! The programs of tests, two of which run at once: many tests take one core for much of their time.

use crate::cargo::cargo;
use crate::test::BUILT;
use anyhow::{Context, Result, anyhow, ensure};
use serde_json::Value;
use std::collections::VecDeque;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::sync::{Mutex, PoisonError};

/// Commands that run at once.
const LANES: usize = 2;

/// A program of tests that Cargo has built.
#[derive(Debug, PartialEq)]
pub struct TestProgram {
    /// The folder of its package, in which it runs.
    pub folder: PathBuf,
    /// The name of its target.
    pub target: String,
    path: PathBuf,
}

impl TestProgram {
    /// Reads a message of Cargo: the program that it reports, if it does.
    fn from_message(message: &str) -> Option<TestProgram> {
        let message: Value = serde_json::from_str(message).ok()?;
        let is_test = message["reason"] == "compiler-artifact" && message["profile"]["test"] == true;
        Some(TestProgram {
            folder: Path::new(message["manifest_path"].as_str()?).parent()?.to_owned(),
            target: message["target"]["name"].as_str()?.to_owned(),
            path: message["executable"].as_str().filter(|_| is_test)?.into(),
        })
    }

    /// Returns a command that runs it as `cargo test` does.
    pub fn command(&self) -> Command {
        let mut command = Command::new(&self.path);
        command.current_dir(&self.folder).env("CARGO_MANIFEST_DIR", &self.folder);
        command
    }
}

/// Builds the programs of all tests, as `cargo xtask test` does, and returns them.
pub fn test_programs(root: &Path) -> Result<Vec<TestProgram>> {
    let mut command = cargo(root, "test");
    command.args(BUILT).args(["--quiet", "--no-run", "--message-format", "json-render-diagnostics"]);
    let done =
        command.stderr(Stdio::inherit()).output().with_context(|| format!("cannot run {command:?}"))?;
    ensure!(done.status.success(), "{command:?} failed: {}", done.status);
    let messages = String::from_utf8_lossy(&done.stdout);
    let programs: Vec<_> = messages.lines().filter_map(TestProgram::from_message).collect();
    ensure!(!programs.is_empty(), "{command:?} built no tests");
    Ok(programs)
}

/// A command to be run, and what it is called.
pub struct Named {
    /// What it is called in what is printed.
    pub name: String,
    /// The command.
    pub command: Command,
}

/// What came of a command.
#[derive(Debug)]
pub struct Ended<R> {
    /// What it is called.
    pub name: String,
    /// How it ended.
    pub status: ExitStatus,
    /// What its output was read into.
    pub read: R,
}

/// Runs commands, which begin in their order, to their ends; returns what came of each. Each line of its output is read into a value,
/// and `read` says whether it is printed: the result of a test at once, and all else when the command has ended.
pub fn run_all<R: Default + Send>(
    commands: Vec<Named>,
    read: impl Fn(&mut R, &str) -> bool + Sync,
) -> Result<Vec<Ended<R>>> {
    let waiting = Mutex::new(VecDeque::from(commands));
    let next = || waiting.lock().unwrap_or_else(PoisonError::into_inner).pop_front();
    let lane = || {
        let mut ended = Vec::new();
        while let Some(command) = next() {
            ended.push(run(command, &read)?);
        }
        Ok(ended)
    };
    std::thread::scope(|scope| {
        let lanes: Vec<_> = (0..LANES).map(|_| scope.spawn(lane)).collect();
        let mut all = Vec::new();
        for lane in lanes {
            let ended: Result<Vec<Ended<R>>> =
                lane.join().map_err(|_| anyhow!("a thread that runs tests panicked"))?;
            all.extend(ended?);
        }
        Ok(all)
    })
}

/// Runs a command to its end: see [`run_all`].
fn run<R: Default>(command: Named, read: impl Fn(&mut R, &str) -> bool) -> Result<Ended<R>> {
    let Named { name, mut command } = command;
    let mut child =
        command.stdout(Stdio::piped()).spawn().with_context(|| format!("cannot run {command:?}"))?;
    let (mut value, mut held) = (R::default(), format!("{name}:"));
    for line in BufReader::new(child.stdout.take().context("the output of the tests")?).lines() {
        let line = line?;
        if !read(&mut value, &line) || line.is_empty() {
            continue;
        }
        if line.starts_with("test ") && !line.starts_with("test result: ") {
            println!("{line}");
        } else {
            held.extend(["\n", &line]);
        }
    }
    let status = child.wait()?;
    println!("{held}");
    Ok(Ended { name, status, read: value })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn programs_are_those_that_cargo_reports() {
        let message = |reason: &str, test: bool, executable: &str| {
            format!(
                r#"{{"reason": "{reason}", "manifest_path": "/tree/passes/halve/Cargo.toml", "target": {{"name": "main"}},
                    "profile": {{"test": {test}}}, "executable": {executable}}}"#
            )
        };
        let program = TestProgram::from_message(&message("compiler-artifact", true, r#""/target/main-1""#));
        let expected = TestProgram {
            folder: "/tree/passes/halve".into(),
            target: "main".into(),
            path: "/target/main-1".into(),
        };
        assert_eq!(program, Some(expected));
        let others = [
            message("compiler-artifact", false, r#""/target/halve""#),
            message("compiler-artifact", true, "null"),
            message("build-finished", true, r#""/target/main-1""#),
            "not JSON".to_owned(),
        ];
        assert!(others.iter().all(|message| TestProgram::from_message(message).is_none()));
    }

    #[cfg(unix)]
    #[test]
    fn commands_run_beside_each_other_and_all_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let script = |name: &str, text: &str| {
            let mut command = Command::new("sh");
            command.current_dir(folder.path()).args(["-c", text]);
            Named { name: name.to_owned(), command }
        };
        // Each of the first two waits for the other, up to a minute.
        let meets = "touch $0; for i in $(seq 600); do [ -e $1 ] && echo met && exit; sleep 0.1; done";
        let commands = vec![
            script("a", &meets.replace("$0", "one").replace("$1", "two")),
            script("b", &meets.replace("$0", "two").replace("$1", "one")),
            script("c", "echo failed; exit 3"),
        ];
        let read = |lines: &mut Vec<String>, line: &str| {
            lines.push(line.to_owned());
            true
        };
        let mut ended = run_all(commands, read).unwrap();
        ended.sort_by(|a, b| a.name.cmp(&b.name));
        let seen: Vec<_> = ended.iter().map(|ended| (ended.status.code(), ended.read.join(","))).collect();
        let met = (Some(0), "met".to_owned());
        assert_eq!(seen, [met.clone(), met, (Some(3), "failed".to_owned())]);
    }
}
