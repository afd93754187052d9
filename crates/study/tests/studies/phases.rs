//! GPU time of groups of passes, and the mean of a picture.

use super::fake::{Fake, done, parse, plan, run, study, told};
use study::{RunOptions, Study};

const PHASES: &str = "phases: { \"visibility\": [\"gather\", \"rays\"], \"all\": [\"view\", \"rays/trace\"], \"rays\": [\"rays\"] }";

fn both(fields: &str) -> Study {
    let text = format!("Study(scenes: [\"box\"], pipelines: [\"fast\", \"exact\"], size: (8, 4), {fields})");
    parse(&text)
}

#[test]
fn phases_are_measures() {
    // Nothing but the phases asks for times.
    let (folder, ran) = done(&plan(both(&format!("measures: [\"memory\"], {PHASES}"))));
    // 64 lights: 2 ms for the view, 0.01 ms a light in `gather`, 0.1 ms in `rays/trace`.
    let expected = [[Some(0.64), Some(2.0), None], [Some(6.4), Some(8.4), Some(6.4)]];
    for (cell, expected) in ran.results.cells.iter().zip(expected) {
        for (name, expected) in ["visibility", "all", "rays"].into_iter().zip(expected) {
            let found = cell.measures[&format!("gpu-ms:{name}")];
            let near = found.zip(expected).is_some_and(|(a, b)| (a - b).abs() < 1e-12);
            assert!(near || found == expected, "{} {name}: {found:?}", cell.pipeline);
        }
    }
    let infos: Vec<(&str, &str, &str)> = ran
        .results
        .study
        .measures
        .iter()
        .map(|info| (info.key.as_str(), info.label.as_str(), info.unit.as_str()))
        .collect();
    assert_eq!(
        infos[1..],
        [
            ("gpu-ms:visibility", "visibility", "ms"),
            ("gpu-ms:all", "all", "ms"),
            ("gpu-ms:rays", "rays", "ms")
        ]
    );
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    assert!(read("cells.csv").contains("box,exact,0,gpu-ms:all,8.4,ms,done,,,"), "{}", read("cells.csv"));
    assert!(
        read("summary.csv").contains("box,fast,gpu-ms:rays,ms,0,,,paper and pencil\n"),
        "{}",
        read("summary.csv")
    );
    study::report(&ran.results, folder.path()).unwrap();
    assert!(read("tables/box.md").contains("| visibility \\[ms\\] | all \\[ms\\] | rays \\[ms\\] |"));
    assert!(read("tables/box.tex").contains("visibility [ms] & all [ms] & rays [ms]"));
}

/// Where frames accumulate until a time is spent, a phase is its part of all that was spent, as the whole is.
#[test]
fn a_budget_that_is_spent_over_frames_is_summed() {
    let folder = tempfile::tempdir().unwrap();
    let spent = study("measures: [\"gpu-ms\"], phases: { \"view\": [\"view\"] }, budget: Time(ms: 10.0)");
    let cell = run(&plan(spent), &mut Fake::default(), folder.path()).unwrap().results.cells.remove(0);
    // Frames of 2.64 ms until 10 ms are reached: 4.
    assert_eq!((cell.frames, cell.measures["gpu-ms:view"]), (4, Some(8.0)));
    assert!((cell.measures["gpu-ms"].unwrap() - 4.0 * 2.64).abs() < 1e-12);
}

#[test]
fn other_phases_are_measured_anew() {
    let folder = tempfile::tempdir().unwrap();
    let begin = |fields: &str| {
        let plan = plan(study(fields));
        told(&plan, &mut Fake::default(), folder.path(), &RunOptions::default()).remove(0)
    };
    let with = |phases: &str| format!("measures: [\"gpu-ms\"], phases: {{ {phases} }}");
    assert_eq!(begin("measures: [\"gpu-ms\"]"), "begin 1 0 0");
    assert_eq!(begin(&with("\"a\": [\"view\"]")), "begin 1 0 1");
    assert_eq!(begin(&with("\"a\": [\"gather\"]")), "begin 1 0 2");
    assert_eq!(begin(&with("\"b\": [\"gather\"]")), "begin 1 0 3");
    assert_eq!(begin(&with("\"a\": [\"view\"]")), "begin 1 1 3");
    assert_eq!(begin("measures: [\"gpu-ms\"]"), "begin 1 1 3");
}

/// Phases are more than errors: they are taken where the reference fails.
#[test]
fn phases_need_no_reference() {
    let folder = tempfile::tempdir().unwrap();
    let timed = study(
        "measures: [\"rmse\"], phases: { \"view\": [\"view\"] }, reference: Pipeline(pipeline: \"truth\")",
    );
    let mut lab = Fake { no_truth: true, ..Fake::default() };
    let cell = run(&plan(timed), &mut lab, folder.path()).unwrap().results.cells.remove(0);
    assert_eq!((cell.measures["rmse"], cell.measures["gpu-ms:view"]), (None, Some(2.0)));
}

#[test]
fn the_mean_needs_no_reference() {
    let still = study("vary: Grid({ \"lights\": [16, 64] }), budget: Frames(3), measures: [\"mean\"]");
    let (folder, ran) = done(&plan(still));
    // Seed 0: −0.5 / lights beside 2.
    let means: Vec<Option<f64>> = ran.results.cells.iter().map(|cell| cell.measures["mean"]).collect();
    assert_eq!(means, [Some(2.0 - 0.5 / 16.0), Some(2.0 - 0.5 / 64.0)]);
    study::report(&ran.results, folder.path()).unwrap();
    assert!(folder.path().join("figures/box-mean-over-lights.svg").is_file());
}
