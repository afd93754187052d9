//! The program that renders, as a process of its own.

use serde::Deserialize;
use serde_json::Value;
use std::io;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Interval at which a process is polled.
const ASK: Duration = Duration::from_millis(10);

/// How a program ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// With an exit code.
    Exit(i32),
    /// By a signal; 0 if the system does not report its number.
    Signal(i32),
    /// It took too long, and was killed.
    TimedOut,
}

/// The result of a program.
#[derive(Clone, Debug)]
pub struct Ran {
    /// How it ended.
    pub ended: Ended,
    /// Its standard output: JSON.
    pub output: String,
    /// Its standard error.
    pub errors: String,
}

/// The errors that the program writes to standard error with `--json`.
#[derive(Deserialize)]
struct Reported {
    #[serde(default)]
    errors: Vec<ReportedError>,
}

#[derive(Deserialize)]
struct ReportedError {
    message: String,
    #[serde(default)]
    help: Vec<String>,
}

impl Ran {
    /// Returns the first error that the program wrote as JSON, which may be among lines of text.
    fn reported_error(&self) -> Option<ReportedError> {
        let objects = self.errors.match_indices('{').filter(|(at, _)| {
            let before = self.errors[..*at].chars().next_back();
            before.is_none_or(|c| c == '\n')
        });
        let reported = objects.filter_map(|(at, _)| {
            serde_json::Deserializer::from_str(&self.errors[at..]).into_iter::<Reported>().next()?.ok()
        });
        reported.flat_map(|reported| reported.errors).next()
    }

    /// Returns the line that states the error; empty if there is none.
    pub(crate) fn message(&self) -> String {
        if let Some(error) = self.reported_error() {
            return error.message;
        }
        let lines = || self.errors.lines().map(str::trim).filter(|line| !line.is_empty());
        let line = lines().find(|line| line.contains("error") || line.contains("panicked"));
        line.or_else(|| lines().next().filter(|_| self.ended != Ended::Exit(0)))
            .unwrap_or_default()
            .to_owned()
    }

    /// Returns the reason why a picture could not be written, if that is the error.
    pub(crate) fn unwritten(&self) -> Option<String> {
        let error = self.reported_error().filter(|_| self.ended == Ended::Exit(1))?;
        let reason = error.help.into_iter().next().unwrap_or_else(|| error.message.clone());
        error.message.ends_with("was not written").then_some(reason)
    }

    /// Returns the guards that acted: repairs of the scene, light that clamping removed, and counters that are below the
    /// requested number of lights.
    pub(crate) fn guards(&self) -> Vec<String> {
        let notes = self.errors.lines().filter_map(|line| line.strip_prefix("note: "));
        let mut guards: Vec<String> = notes.map(|note| format!("note: {note}")).collect();
        let Ok(output) = serde_json::from_str::<Value>(&self.output) else { return guards };
        if let Some(share) = output["clamped_energy"].as_f64().filter(|share| *share > 0.0) {
            guards.push(format!("clamping: removed {:.2} %", share * 100.0));
        }
        for figures in output["figures"].as_array().into_iter().flatten() {
            let number = |name: &str| figures[name].as_f64();
            if let (Some(produced), Some(requested)) = (number("produced"), number("requested"))
                && produced < requested
            {
                let of = figures["of"].as_str().unwrap_or_default();
                guards.push(format!("produced: {produced} of {requested} in {of}"));
            }
        }
        guards
    }
}

/// Runs the commands of Lightloom.
pub trait Program {
    /// Runs a command; kills it at the time limit.
    ///
    /// # Errors
    /// Fails if it cannot be started.
    fn run(&self, arguments: &[String], limit: Duration) -> io::Result<Ran>;
}

/// Lightloom as a process of its own.
#[derive(Clone, Debug)]
pub struct Child {
    /// The program.
    pub path: PathBuf,
    /// Arguments before all others, such as `--root DIR`.
    pub before: Vec<String>,
}

impl Program for Child {
    fn run(&self, arguments: &[String], limit: Duration) -> io::Result<Ran> {
        // Files, not pipes: a process that writes much must not wait for a reader.
        let (output, errors) = (tempfile::NamedTempFile::new()?, tempfile::NamedTempFile::new()?);
        let begun = Instant::now();
        let mut child = Command::new(&self.path)
            .args(&self.before)
            .args(arguments)
            .stdin(Stdio::null())
            .stdout(output.reopen()?)
            .stderr(errors.reopen()?)
            .spawn()?;
        let status = loop {
            match child.try_wait()? {
                Some(status) => break Some(status),
                None if begun.elapsed() > limit => {
                    child.kill()?;
                    child.wait()?;
                    break None;
                }
                None => std::thread::sleep(ASK),
            }
        };
        let read = |file: &tempfile::NamedTempFile| {
            Ok::<_, io::Error>(String::from_utf8_lossy(&std::fs::read(file.path())?).into_owned())
        };
        Ok(Ran {
            ended: match status {
                None => Ended::TimedOut,
                Some(status) => status.code().map_or_else(|| Ended::Signal(signal(status)), Ended::Exit),
            },
            output: read(&output)?,
            errors: read(&errors)?,
        })
    }
}

#[cfg(unix)]
fn signal(status: std::process::ExitStatus) -> i32 {
    std::os::unix::process::ExitStatusExt::signal(&status).unwrap_or_default()
}

#[cfg(not(unix))]
fn signal(_: std::process::ExitStatus) -> i32 {
    0
}
