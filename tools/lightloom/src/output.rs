//! Prints results and failures.

use anyhow::{Context as _, Result};
use data_file::codes::SHADOWED;
use data_file::visible;
use frame_graph::codes::LEFT_OUT;
use frame_graph::{Diagnostic, Diagnostics, Severity};
use indicatif::{ProgressBar, ProgressStyle};
use renderer::RenderError;
use scene::SceneError;
use serde_json::{Value, json};
use std::io::{ErrorKind, Write as _};
use std::path::Path;
use std::time::Duration;

/// Prints a line on standard output, with control characters [written out](visible). If its reader has gone (`lightloom check | head`), the line is dropped, and the exit
/// code stays that of the command. If it cannot be written for another reason, such as a full disk, the program fails.
pub(crate) fn line(text: std::fmt::Arguments<'_>) {
    match writeln!(std::io::stdout(), "{}", visible(&text.to_string())) {
        Ok(()) => {}
        Err(error) if error.kind() == ErrorKind::BrokenPipe => {}
        Err(error) => {
            failure(&anyhow::Error::new(error).context("standard output cannot be written"), false);
            std::process::exit(1);
        }
    }
}

/// Prints a line on standard error, with control characters [written out](visible); drops it if that cannot be written.
pub(crate) fn error_line(text: std::fmt::Arguments<'_>) {
    let _ = writeln!(std::io::stderr(), "{}", visible(&text.to_string()));
}

/// As `eprintln!`, by [`error_line()`].
macro_rules! stderr {
    ($($text:tt)*) => { $crate::output::error_line(format_args!($($text)*)) };
}
pub(crate) use stderr;

/// As `println!`, by [`line()`].
macro_rules! stdout {
    ($($text:tt)*) => { $crate::output::line(format_args!($($text)*)) };
}
pub(crate) use stdout;

/// Prints the warnings of a pipeline that is run, names that could mean two files, and light that is left out, on standard
/// error; as JSON, `{ "warnings": [ … ] }`. Other notes are printed by `check` alone.
pub(crate) fn warn(of: &Diagnostics, as_json: bool) {
    let is_printed = |one: &&Diagnostic| {
        one.severity > Severity::Note || [SHADOWED.code, LEFT_OUT.code].contains(&one.code)
    };
    match Diagnostics(of.0.iter().filter(is_printed).cloned().collect()) {
        none if none.0.is_empty() => {}
        warnings if as_json => stderr!("{:#}", json!({ "warnings": warnings.to_json() })),
        warnings => stderr!("{warnings}"),
    }
}

/// Prints an error with its causes, each once; as JSON, `{ "errors": [ … ], "text": … }` on standard error.
pub(crate) fn failure(error: &anyhow::Error, as_json: bool) {
    if as_json {
        stderr!("{:#}", json!({ "errors": errors(error), "text": text(error) }));
        return;
    }
    stderr!("{}", text(error));
}

/// Returns an error with its causes, each once, as a terminal shows it.
pub fn text(error: &anyhow::Error) -> String {
    let mut said = error.to_string();
    // Diagnostics begin with their own word.
    let mut lines = match said.starts_with("error") {
        true => said.trim_end().to_owned(),
        false => format!("error: {said}"),
    };
    for cause in error.chain().skip(1) {
        let cause = cause.to_string();
        if !said.contains(&cause) {
            lines += &format!("\n  because: {cause}");
        }
        said = cause;
    }
    lines
}

/// Returns an error as a list for programs: errors in files have a code and places, others a message and its causes.
pub fn errors(error: &anyhow::Error) -> Value {
    if let Some(diagnostics) = error.chain().find_map(diagnostics) {
        return diagnostics.to_json();
    }
    let file = error.chain().find_map(|error| match error.downcast_ref::<SceneError>()? {
        SceneError::Gltf { file: path, .. } | SceneError::Unreadable { path, .. } => {
            Some(path.display().to_string())
        }
        SceneError::Empty { file, .. } | SceneError::TooLarge { file, .. } => Some(file.clone()),
        _ => None,
    });
    let mut causes: Vec<String> = error.chain().skip(1).map(ToString::to_string).collect();
    causes.dedup();
    json!([{
        "code": null,
        "severity": "error",
        "message": error.to_string(),
        "file": file,
        "line": null,
        "column": null,
        "labels": [],
        "help": causes,
    }])
}

/// Returns the errors in files, if an error is about files.
pub(crate) fn diagnostics<'e>(error: &'e (dyn std::error::Error + 'static)) -> Option<&'e Diagnostics> {
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

/// Shows on a terminal that work of this many parts goes on, and for how long; elsewhere nothing.
pub(crate) fn progress(parts: u64, what: &str) -> ProgressBar {
    let bar = ProgressBar::new_spinner().with_message(what.to_owned());
    set_parts(&bar, parts);
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}

/// Sets the number of parts; of one, the time alone is shown.
pub(crate) fn set_parts(bar: &ProgressBar, parts: u64) {
    if bar.length() == Some(parts) {
        return;
    }
    let template = match parts {
        0 | 1 => "{msg}, {elapsed}",
        _ => "{msg} {wide_bar} {pos}/{len} after {elapsed}, {eta} left",
    };
    bar.set_style(ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar.set_length(parts);
}

/// Writes a file, which is complete or absent.
pub(crate) fn write(path: &Path, text: &str) -> Result<()> {
    whole_file::write(path, text).with_context(|| format!("{} was not written", path.display()))
}

/// Prints JSON.
pub(crate) fn json(value: &serde_json::Value) {
    stdout!("{value:#}");
}
