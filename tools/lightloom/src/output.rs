//! How results and failures are printed.

use indicatif::{ProgressBar, ProgressStyle};
use std::io::Write as _;

/// Prints an error with its causes, each said once.
pub(crate) fn failure(error: &anyhow::Error) {
    let text = error.to_string();
    // Diagnostics begin with their own word.
    if text.starts_with("error") {
        eprintln!("{}", text.trim_end());
    } else {
        eprintln!("error: {text}");
    }
    let mut said = text;
    for cause in error.chain().skip(1) {
        let cause = cause.to_string();
        if !said.contains(&cause) {
            eprintln!("  because: {cause}");
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

/// Prints a line on standard output. Where its reader has gone (`lightloom passes | head`), there is nothing
/// left to do.
pub(crate) fn line(text: std::fmt::Arguments<'_>) {
    if writeln!(std::io::stdout(), "{text}").is_err() {
        std::process::exit(0);
    }
}

/// As `println!`, by [`line()`].
macro_rules! say {
    ($($text:tt)*) => { $crate::output::line(format_args!($($text)*)) };
}
pub(crate) use say;

/// Prints JSON.
pub(crate) fn json(value: &serde_json::Value) {
    say!("{value:#}");
}
