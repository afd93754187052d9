//! Lines in the terminal that the window was opened from. It may be closed while the window is open: `println!` and
//! `eprintln!` would panic then.

use data_file::visible;
use std::fmt::Display;
use std::io::Write as _;

/// Prints a line on standard output, if that is there.
pub(crate) fn say(line: impl Display) {
    let _ = writeln!(std::io::stdout(), "{}", visible(&line.to_string()));
}

/// Prints a line on standard error, if that is there.
pub(crate) fn complain(line: impl Display) {
    let _ = writeln!(std::io::stderr(), "{}", visible(&line.to_string()));
}
