//! What a study prints when it ends.

use crate::context::Context;
use crate::output::{self, stdout};
use anyhow::Result;
use serde_json::json;
use std::path::Path;
use study::{Outcome, Ran, Results, Verdict};

/// Returns the message at the end of a run with failed cells.
pub(super) fn failed(count: usize) -> String {
    match count {
        1 => "1 cell failed; the same command tries it again".to_owned(),
        count => format!("{count} cells failed; the same command tries them again"),
    }
}

/// Prints the summary of a shard. Its failed cells are rows too: they are in the report of the whole, and fail no batch job.
pub(super) fn shard_report(context: &Context, ran: &Ran) {
    let study = &ran.results.study;
    let missing = study.cell_count.saturating_sub(ran.results.cells.len());
    let failures = failures(&ran.results);
    if context.json {
        output::json(&json!({
            "study": study.name,
            "cells": ran.results.cells.len(),
            "missing": missing,
            "run": ran.run,
            "failed": failures_json(&failures),
        }));
        return;
    }
    print_failures(&failures);
    stdout!(
        "{} of {} cells are of this shard; {} ran now",
        ran.results.cells.len(),
        study.cell_count,
        ran.run
    );
}

/// Returns the cells that failed, each with the first line of its error.
pub(crate) fn failures(results: &Results) -> Vec<(String, &str)> {
    let failures = results.cells.iter().filter_map(|cell| match &cell.outcome {
        Outcome::Done => None,
        Outcome::Failed { error } => Some((study::name_of(cell), error.lines().next().unwrap_or_default())),
    });
    failures.collect()
}

pub(crate) fn failures_json(failures: &[(String, &str)]) -> serde_json::Value {
    failures.iter().map(|(cell, error)| json!({ "cell": cell, "error": error })).collect()
}

pub(crate) fn print_failures(failures: &[(String, &str)]) {
    for (cell, error) in failures {
        stdout!("failed  {cell}: {error}");
    }
}

/// Writes the report and prints a summary.
pub(super) fn report(context: &Context, results: &Results, folder: &Path, run: Option<usize>) -> Result<()> {
    let files = study::report(results, folder)?;
    let page = files.first().map(|page| page.canonicalize().unwrap_or_else(|_| page.clone()));
    let failures = failures(results);
    let missing = results.study.cell_count.saturating_sub(results.cells.len());
    let findings = results.findings();
    let claims = |verdict| findings.iter().filter(|finding| finding.verdict == verdict).count();
    let [hold, fail, undecided, not_measured] =
        [Some(Verdict::Holds), Some(Verdict::Fails), Some(Verdict::Undecided), None].map(claims);
    if context.json {
        let pictures: Vec<_> = results
            .cells
            .iter()
            .map(|cell| json!({ "cell": study::name_of(cell), "key": cell.key, "images": cell.images }))
            .collect();
        output::json(&json!({
            "study": results.study.name,
            "report": page,
            "cells": results.cells.len(),
            "missing": missing,
            "run": run,
            "failed": failures_json(&failures),
            "pictures": pictures,
            "claims": { "hold": hold, "fail": fail, "undecided": undecided, "not_measured": not_measured },
            "findings": findings,
        }));
        return Ok(());
    }
    print_failures(&failures);
    if missing > 0 {
        stdout!("{missing} of {} cells are not here", results.study.cell_count);
    }
    if let Some(table) = study::claims(results) {
        stdout!("{}", table.text());
        stdout!(
            "claims  {hold} of {} hold, {fail} do not, {undecided} are not decided, {not_measured} not measured",
            findings.len()
        );
    }
    if let Some(page) = page {
        stdout!("{}", page.display());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::failed;

    #[test]
    fn one_cell_is_one_cell() {
        assert_eq!(failed(1), "1 cell failed; the same command tries it again");
        assert_eq!(failed(2), "2 cells failed; the same command tries them again");
    }
}
