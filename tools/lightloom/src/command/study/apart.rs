//! Cells in processes of their own: a crash or a hang takes no other cell with it.

use super::external::end_with_this_program;
use std::path::Path;
use std::time::Duration;
use study::{Ended, Failure, run_program};

/// Runs cells of a study by this program.
pub(super) struct Apart {
    /// The command of the study, but for the cell.
    pub(super) command: Vec<String>,
    /// Number of all cells.
    pub(super) cells: usize,
    /// Time limit of a cell.
    pub(super) limit: Duration,
}

impl Apart {
    /// Runs a cell, which writes its record.
    pub(super) fn run(&self, cell: usize) -> Result<(), Failure> {
        end_with_this_program();
        let shard = format!("cells:{0}-{0}/{1}", cell + 1, self.cells);
        let words = [&self.command[..], &["--shard".to_owned(), shard]].concat();
        let Ended { status, output, .. } = run_program(&words, Path::new("."), self.limit)?;
        if status.success() {
            return Ok(());
        }
        let lines = || output.lines().map(str::trim).filter(|line| !line.is_empty());
        let why = lines().find(|line| line.contains("panicked") || line.starts_with("error"));
        let why = why.or_else(|| lines().next_back()).unwrap_or("it printed nothing");
        Err(Failure::Crashed(format!("it ended with {status}: {why}")))
    }
}
