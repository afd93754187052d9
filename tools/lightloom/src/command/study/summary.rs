//! What a study prints when it ends.

use crate::context::Context;
use crate::output::{self, stdout};
use anyhow::{Result, bail};
use serde_json::{Value, json};
use std::path::Path;
use study::{Cell, Finding, Outcome, Ran, Results, Verdict};

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

pub(crate) fn failures_json(failures: &[(String, &str)]) -> Value {
    failures.iter().map(|(cell, error)| json!({ "cell": cell, "error": error })).collect()
}

pub(crate) fn print_failures(failures: &[(String, &str)]) {
    for (cell, error) in failures {
        stdout!("failed  {cell}: {error}");
    }
}

/// Returns what commands that measure cells print as JSON: numbers of cells, the record of each, the cells that failed, and
/// the claims.
pub(crate) fn summary(results: &Results, page: &Path, run: Option<usize>) -> Value {
    let page = page.canonicalize().unwrap_or_else(|_| page.to_owned());
    let findings = results.findings();
    let [hold, fail, undecided, not_measured] = counted(&findings);
    let record = |cell: &Cell| {
        json!({
            "cell": study::name_of(cell), "key": cell.key, "scene": cell.scene, "pipeline": cell.pipeline, "axes": cell.axes,
            "seed": cell.seed, "measures": cell.measures, "details": cell.details, "images": cell.images,
        })
    };
    json!({
        "study": results.study.name,
        "adapter": results.study.adapter,
        "report": page,
        "cells": results.cells.len(),
        "missing": results.study.cell_count.saturating_sub(results.cells.len()),
        "run": run,
        "failed": failures_json(&failures(results)),
        "records": results.cells.iter().map(record).collect::<Vec<_>>(),
        "claims": { "hold": hold, "fail": fail, "undecided": undecided, "not_measured": not_measured },
        "findings": findings,
    })
}

/// Returns the numbers of claims that hold, that do not, that are not decided and that are not measured.
fn counted(findings: &[Finding<'_>]) -> [usize; 4] {
    let count = |verdict| findings.iter().filter(|finding| finding.verdict == verdict).count();
    [Some(Verdict::Holds), Some(Verdict::Fails), Some(Verdict::Undecided), None].map(count)
}

/// Prints the cells that failed, and fails if there are any.
pub(crate) fn fail_if_any(results: &Results, as_json: bool) -> Result<()> {
    let failures = failures(results);
    if !as_json {
        print_failures(&failures);
    }
    match failures.len() {
        0 => Ok(()),
        count => bail!("{}", failed(count)),
    }
}

/// Writes the report and prints a summary.
pub(super) fn report(context: &Context, results: &Results, folder: &Path, run: Option<usize>) -> Result<()> {
    let page = study::report(results, folder)?.swap_remove(0);
    if context.json {
        output::json(&summary(results, &page, run));
        return Ok(());
    }
    print_failures(&failures(results));
    let missing = results.study.cell_count.saturating_sub(results.cells.len());
    if missing > 0 {
        stdout!("{missing} of {} cells are not here", results.study.cell_count);
    }
    if let Some(table) = study::claims(results) {
        let findings = results.findings();
        let [hold, fail, undecided, not_measured] = counted(&findings);
        stdout!("{}", table.text());
        stdout!(
            "claims  {hold} of {} hold, {fail} do not, {undecided} are not decided, {not_measured} not measured",
            findings.len()
        );
    }
    stdout!("{}", page.canonicalize().unwrap_or(page).display());
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
