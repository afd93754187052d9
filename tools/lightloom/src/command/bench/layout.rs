//! Prints measurements in columns, with the machine.

use super::Args;
use crate::output::stdout;
use renderer::Gpu;
use serde_json::{Value, json};

/// The machine of a measurement, and the number of runs.
pub(super) struct Machine {
    adapter: Option<String>,
    cores: usize,
    runs: u32,
    quick: bool,
}

/// Whether CPU times are those of a release.
const OPTIMISED: bool = !cfg!(debug_assertions);

impl Machine {
    pub(super) fn new(gpu: Option<&Gpu>, args: &Args) -> Machine {
        Machine {
            adapter: gpu.map(Gpu::describe),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            runs: args.runs,
            quick: args.quick,
        }
    }

    /// Returns machine and runs as a line.
    pub(super) fn line(&self) -> String {
        let adapter = self.adapter.as_deref().unwrap_or("no adapter was requested");
        let build = if OPTIMISED { "" } else { ", built without full optimisation" };
        let quick = if self.quick { "; a quick preview, to which the goals do not apply" } else { "" };
        format!(
            "Lightloom {}{build}; {adapter}, {} CPU cores. Medians (least–greatest); runs after the first: {}{quick}.",
            env!("CARGO_PKG_VERSION"),
            self.cores,
            self.runs,
        )
    }

    /// Returns the same as an object, with further members.
    pub(super) fn json_with<const N: usize>(&self, members: [(&str, Value); N]) -> Value {
        let mut object = json!({
            "version": env!("CARGO_PKG_VERSION"),
            "optimised": OPTIMISED,
            "adapter": self.adapter,
            "cores": self.cores,
            "runs": self.runs,
            "quick": self.quick,
        });
        members.into_iter().for_each(|(name, value)| object[name] = value);
        object
    }
}

/// Prints rows under their heads: in columns, or as a table of Markdown.
pub(super) fn print_columns<const N: usize>(
    heads: [&str; N],
    rows: impl Iterator<Item = [String; N]>,
    markdown: bool,
) {
    let rows: Vec<[String; N]> = std::iter::once(heads.map(str::to_owned)).chain(rows).collect();
    if markdown {
        for (i, cells) in rows.iter().enumerate() {
            stdout!("| {} |", cells.join(" | "));
            if i == 0 {
                stdout!("|{}", "---|".repeat(N));
            }
        }
        return;
    }
    let width = |column: usize| rows.iter().map(|cells| cells[column].chars().count()).max().unwrap_or(0);
    let widths: [usize; N] = std::array::from_fn(width);
    for cells in &rows {
        let line: Vec<String> =
            cells.iter().zip(widths).map(|(cell, width)| format!("{cell:<width$}")).collect();
        stdout!("{}", line.join("  ").trim_end());
    }
}

/// Formats a number with three significant digits.
pub(super) fn digits(value: f64) -> String {
    let before = if value == 0.0 { 0.0 } else { value.abs().log10().floor() };
    let behind = (2.0 - before).clamp(0.0, 6.0) as usize;
    format!("{value:.behind$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        let cases = [(0.0, "0.00"), (0.01234, "0.0123"), (1.0, "1.00"), (45.67, "45.7"), (14449.2, "14449")];
        cases.iter().for_each(|(value, text)| assert_eq!(digits(*value), *text));
    }
}
