//! How results and failures are printed.

use indicatif::{ProgressBar, ProgressStyle};
use std::io::{ErrorKind, Write as _};

/// Prints a line on standard output. Where its reader has gone (`lightloom passes | head`), there is nothing
/// left to do. Where it cannot be written for another reason, such as a full disk, the program has failed.
pub(crate) fn line(text: std::fmt::Arguments<'_>) {
    match writeln!(std::io::stdout(), "{text}") {
        Ok(()) => {}
        Err(error) if error.kind() == ErrorKind::BrokenPipe => std::process::exit(0),
        Err(error) => {
            failure(&anyhow::Error::new(error).context("standard output cannot be written"));
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

/// Prints an error with its causes, each said once.
pub(crate) fn failure(error: &anyhow::Error) {
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

/// Prints JSON.
pub(crate) fn json(value: &serde_json::Value) {
    say!("{value:#}");
}
