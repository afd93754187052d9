//! Cells of several adapters in one report.

use super::fake::{Fake, plan, study};
use std::fs;
use study::{Results, RunOptions, Shard, Verdict};

const SWEEP: &str = "vary: Grid({ \"lights\": [16, 64, 256] }), seeds: 4, budget: Frames(3),
    measures: [\"rmse\", \"gpu-ms\"], reference: Pipeline(pipeline: \"truth\"),
    claims: [
        Bound(measure: \"gpu-ms\", of: \"fast\", at_most: 5.0),
        Order(measure: \"rmse\", rising: [At(\"fast\", { \"lights\": 64 }), At(\"fast\", { \"lights\": 16 })]),
    ]";

/// Runs two of four seeds of each combination by another adapter, which is three times as slow.
fn mixed(fields: &str) -> (tempfile::TempDir, Results) {
    let folder = tempfile::tempdir().unwrap();
    let plan = plan(study(fields));
    let mut labs = [Fake::default(), Fake { adapter: Some(("abacus (wood)", 3.0)), ..Fake::default() }];
    for first in (0..12).step_by(2) {
        let shard = Some(Shard::Cells { places: first..first + 2, of: 12 });
        let options = RunOptions { shard, ..RunOptions::default() };
        study::run(&plan, &mut labs[first / 2 % 2], folder.path(), &options, &mut |_| {}).unwrap();
    }
    let results = study::merge(&[folder.path().to_owned()], folder.path()).unwrap().results;
    (folder, results)
}

fn page(folder: &tempfile::TempDir, results: &Results) -> String {
    study::report(results, folder.path()).unwrap();
    fs::read_to_string(folder.path().join("report.html")).unwrap()
}

#[test]
fn no_curve_has_times_of_two_adapters() {
    let (folder, results) = mixed(SWEEP);
    let page = page(&folder, &results);
    assert!(page.contains("paper and pencil; abacus (wood)"), "the head names both");
    let host = &results.cells[0].node.host;
    assert!(page.contains(&format!("<dd>{host} (12 cells)</dd>")), "and the machines");
    let chart = fs::read_to_string(folder.path().join("figures/box-gpu-ms-over-lights.svg")).unwrap();
    // 16, 64 and 256 lights take 2.16, 2.64 and 4.56 ms here, thrice that there, and no mean of the two anywhere.
    for (own, ms) in [("paper and pencil", [2.16, 2.64, 4.56]), ("abacus", [6.48, 7.92, 13.68])] {
        assert!(chart.contains(&format!("fast · {own}")), "{chart}");
        for ms in ms {
            assert!(chart.contains(&format!("GPU time: {ms}")), "{ms} in {chart}");
        }
    }
    for mean in [4.32, 5.28, 9.12] {
        assert!(!chart.contains(&format!("{mean}")), "{mean}");
    }
    let errors = fs::read_to_string(folder.path().join("figures/box-rmse-over-lights.svg")).unwrap();
    assert!(errors.contains(">fast</text>") && !errors.contains(">fast · "), "one curve: {errors}");
    assert_eq!(errors.matches("4 seeds").count(), 3, "of the cells of both: {errors}");
    let time = fs::read_to_string(folder.path().join("figures/box-rmse-time.svg")).unwrap();
    assert!(time.contains("fast · abacus") && !time.contains("Pareto"), "{time}");
    let summary = fs::read_to_string(folder.path().join("summary.csv")).unwrap();
    let row = |start: &str, end: &str| {
        let is = |line: &&str| line.starts_with(start) && line.ends_with(end);
        summary.lines().find(is).unwrap_or_else(|| panic!("{start} {end}: {summary}")).to_owned()
    };
    assert!(row("box,fast,16,gpu-ms,", "abacus (wood)").contains(",2,6.4"), "{summary}");
    // Errors are over the seeds of both: 1.5 / 16 and 0.5 / 16, twice each.
    assert!(row("box,fast,16,rmse,", "abacus (wood)").contains(",4,0.0625"), "{summary}");
}

#[test]
fn a_claim_about_times_is_decided_for_each_adapter() {
    let (_folder, results) = mixed(SWEEP);
    let findings = results.findings();
    let found: Vec<_> = findings.iter().map(|finding| (finding.adapter, finding.verdict)).collect();
    assert_eq!(found.len(), 3, "{found:?}");
    assert_eq!(found[0], (Some("paper and pencil"), Some(Verdict::Holds)));
    assert_eq!(found[1], (Some("abacus (wood)"), Some(Verdict::Fails)));
    assert_eq!(found[2].0, None, "errors are of both");
    assert_eq!(findings[2].means[0].map(|mean| mean.seeds), Some(4));
}

/// With a budget of time, another adapter has other frames or lights, and so other errors.
#[test]
fn errors_of_a_budget_of_time_are_of_its_adapter() {
    let timed = SWEEP.replace("Frames(3)", "Time(ms: 30.0, frames: 64)");
    let (folder, results) = mixed(&timed);
    assert_eq!(results.findings().len(), 4);
    let page = page(&folder, &results);
    assert!(page.contains("so are errors, since the budget is one of time"));
    let summary = fs::read_to_string(folder.path().join("summary.csv")).unwrap();
    let rows = summary.lines().filter(|line| line.starts_with("box,fast,16,rmse,"));
    assert!(rows.clone().count() == 2 && rows.clone().all(|row| row.contains(",2,")), "{summary}");
}
