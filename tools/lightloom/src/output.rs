//! How results and failures are printed.

use anyhow::{Context as _, Result};
use data_file::codes::SHADOWED;
use frame_graph::{Diagnostic, Diagnostics, Severity};
use indicatif::{ProgressBar, ProgressStyle};
use renderer::RenderError;
use scene::SceneError;
use serde_json::{Value, json};
use std::io::{ErrorKind, Write as _};
use std::path::Path;

/// Prints a line on standard output. Where its reader has gone (`lightloom check | head`), nobody is left to be told, and
/// the exit code is still that of what was done. Where it cannot be written for another reason, such as a full disk, the
/// program has failed.
pub(crate) fn line(text: std::fmt::Arguments<'_>) {
    match writeln!(std::io::stdout(), "{text}") {
        Ok(()) => {}
        Err(error) if error.kind() == ErrorKind::BrokenPipe => {}
        Err(error) => {
            failure(&anyhow::Error::new(error).context("standard output cannot be written"), false);
            std::process::exit(1);
        }
    }
}

/// Prints a line on standard error. Where that cannot be written, nobody is left to be told.
pub(crate) fn error_line(text: std::fmt::Arguments<'_>) {
    let _ = writeln!(std::io::stderr(), "{text}");
}

/// As `eprintln!`, by [`error_line()`].
macro_rules! tell {
    ($($text:tt)*) => { $crate::output::error_line(format_args!($($text)*)) };
}
pub(crate) use tell;

/// As `println!`, by [`line()`].
macro_rules! say {
    ($($text:tt)*) => { $crate::output::line(format_args!($($text)*)) };
}
pub(crate) use say;

/// Prints what is no error of a pipeline that is run, on standard error: warnings, and names that could mean two files; as
/// JSON, `{ "warnings": [ … ] }`. That an input which may be left out was left out is for `check` to tell.
pub(crate) fn warn(of: &Diagnostics, as_json: bool) {
    let is_told = |told: &&Diagnostic| told.severity > Severity::Note || told.code == SHADOWED.code;
    let told: Vec<Diagnostic> = of.0.iter().filter(is_told).cloned().collect();
    match Diagnostics(told) {
        told if told.0.is_empty() => {}
        told if as_json => tell!("{:#}", json!({ "warnings": told.to_json() })),
        told => tell!("{told}"),
    }
}

/// Prints an error with its causes, each said once; as JSON, `{ "errors": [ … ] }` on standard error.
pub(crate) fn failure(error: &anyhow::Error, as_json: bool) {
    if as_json {
        tell!("{:#}", json!({ "errors": errors(error) }));
        return;
    }
    let text = error.to_string();
    // Diagnostics begin with their own word.
    if text.starts_with("error") {
        tell!("{}", text.trim_end());
    } else {
        tell!("error: {text}");
    }
    let mut said = text;
    for cause in error.chain().skip(1) {
        let cause = cause.to_string();
        if !said.contains(&cause) {
            tell!("  because: {cause}");
        }
        said = cause;
    }
}

/// Returns an error for programs, as a list: what is wrong with files has a code and places, all else a message and its
/// causes.
pub(crate) fn errors(error: &anyhow::Error) -> Value {
    if let Some(diagnostics) = error.chain().find_map(diagnostics) {
        return diagnostics.to_json();
    }
    let mut causes: Vec<String> = error.chain().skip(1).map(ToString::to_string).collect();
    causes.dedup();
    json!([{
        "code": null,
        "severity": "error",
        "message": error.to_string(),
        "file": null,
        "line": null,
        "column": null,
        "labels": [],
        "help": causes,
    }])
}

/// What is wrong with files, where an error is that.
fn diagnostics<'e>(error: &'e (dyn std::error::Error + 'static)) -> Option<&'e Diagnostics> {
    let of_scene = |error: &'e SceneError| match error {
        SceneError::Description(diagnostics) => Some(diagnostics),
        _ => None,
    };
    if let Some(error) = error.downcast_ref::<RenderError>() {
        return match error {
            RenderError::Pipeline(diagnostics) => Some(diagnostics),
            RenderError::Scene(error) => of_scene(error),
            _ => None,
        };
    }
    error.downcast_ref::<SceneError>().and_then(of_scene).or_else(|| error.downcast_ref())
}

/// A bar for work of this many parts, on a terminal; for one part, none.
pub(crate) fn progress(parts: u64, what: &str) -> ProgressBar {
    if parts <= 1 {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len}, {eta} left");
    ProgressBar::new(parts)
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        .with_message(what.to_owned())
}

/// Writes a file, whole or not at all.
pub(crate) fn write(path: &Path, text: &str) -> Result<()> {
    whole_file::write(path, text).with_context(|| format!("{} was not written", path.display()))
}

/// Prints JSON.
pub(crate) fn json(value: &serde_json::Value) {
    say!("{value:#}");
}
