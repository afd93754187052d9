//! Running, going on, parts.

use super::fake::{Fake, done, parse, plan, run, study, told};
use frame_graph::Source;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::SystemTime;
use study::{AxisValue, Interval, Outcome, Results, RunOptions, Shard, Verdict};

const SWEEP: &str = "vary: Grid({ \"lights\": [16, 64, 256] }), seeds: 2, budget: Frames(3),
    measures: [\"rmse\", \"energy\", \"bias2\", \"variance\", \"gpu-ms\", \"memory\"], reference: Pipeline(pipeline: \"truth\")";

fn close(found: Option<f64>, expected: f64) {
    let found = found.expect("a value");
    assert!((found - expected).abs() < 1e-6 * expected.abs().max(1.0), "{found} is not {expected}");
}

#[test]
fn measures_are_those_of_the_closed_forms() {
    let (folder, ran) = done(&plan(study(SWEEP)));
    assert_eq!((ran.run, ran.failed, ran.results.cells.len()), (6, 0, 6));
    for cell in &ran.results.cells {
        let lights = cell.axes["lights"].to_string().parse::<f64>().unwrap();
        let error: f64 = if cell.seed == 1 { 1.5 / lights } else { -0.5 / lights };
        close(cell.measures["rmse"], error.abs());
        close(cell.measures["energy"], 1.0 + error / 2.0);
        close(cell.measures["gpu-ms"], 2.0 + 0.01 * lights);
        close(cell.measures["memory"], 3.0);
        assert_eq!((cell.frames, cell.passes.len()), (3, 2));
        // Of e₁ = 1.5 and e₂ = −0.5 over the lights: variance Σ (e − 0.5)² / 1 = 2, bias² = 0.25 − 2 / 2. Of two
        // seeds none can be left out, and both have the estimate.
        close(cell.measures["variance"], 2.0 / (lights * lights));
        close(cell.measures["bias2"], -0.75 / (lights * lights));
        for image in [&cell.images.image, &cell.images.flip, &cell.images.reference] {
            assert!(folder.path().join(image.as_ref().unwrap()).is_file());
        }
    }
    let reference = &ran.results.study.references[0];
    assert_eq!((reference.noise, reference.from.as_str()), (Some(1e-6), "pipeline truth"));
    assert_eq!(Results::read(folder.path()).unwrap(), ran.results);
}

/// What makes the machine slow for a while is in one seed of many cells, not in all seeds of one.
#[test]
fn cells_run_seed_by_seed() {
    let folder = tempfile::tempdir().unwrap();
    let mut lab = Fake::default();
    let fields = "vary: Grid({ \"lights\": [16, 64] }), seeds: [3, 1], measures: [\"gpu-ms\"]";
    let ran = run(&plan(study(fields)), &mut lab, folder.path()).unwrap();
    let seeds: Vec<u32> = lab.ran.iter().map(|request| request.seed).collect();
    assert_eq!(seeds, [3, 3, 1, 1]);
    let seeds: Vec<u32> = ran.results.cells.iter().map(|cell| cell.seed).collect();
    assert_eq!(seeds, [3, 1, 3, 1], "results keep the order of the study");
}

/// Each seed has its pseudo-value, and their mean is the estimate over all.
#[test]
fn bias_and_variance_have_intervals() {
    let folder = tempfile::tempdir().unwrap();
    let fields = "vary: Grid({ \"lights\": [1, 4] }), seeds: 4, measures: [\"bias2\", \"variance\"],
        reference: Pipeline(pipeline: \"truth\"),
        claims: [
            Order(measure: \"variance\", rising: [At(\"fast\", { \"lights\": 4 }), At(\"fast\", { \"lights\": 1 })]),
            Order(measure: \"bias2\", rising: [At(\"fast\", { \"lights\": 1 }), At(\"fast\", { \"lights\": 4 })]),
        ]";
    let results = run(&plan(study(fields)), &mut Fake::default(), folder.path()).unwrap().results;
    // Errors 1.5, −0.5, 1.5, −0.5: variance 4/3, bias² 1/4 − 1/3. Without a seed of 1.5 the products of pairs are
    // −0.75 twice and 0.25, whose mean is −5/12; without the other −0.75 twice and 2.25, whose mean is 1/4.
    let of_one_light = results.cells.iter().filter(|cell| cell.axes["lights"] == AxisValue::Number(1.0));
    let of_one_light: Vec<_> = of_one_light.collect();
    let [bias, variance] = ["bias2", "variance"]
        .map(|key| -> Vec<f64> { of_one_light.iter().map(|cell| cell.measures[key].unwrap()).collect() });
    for (found, left_out) in bias.iter().zip([-5.0 / 12.0, 0.25, -5.0 / 12.0, 0.25]) {
        close(Some(*found), 4.0 * (-1.0 / 12.0) - 3.0 * left_out);
    }
    let [bias, variance] = [bias, variance].map(|values| Interval::of(&values).unwrap());
    close(Some(bias.mean), -1.0 / 12.0);
    close(Some(variance.mean), 4.0 / 3.0);
    // Pseudo-values 11/12 and −13/12: a deviation of 2 / √3, and t = 3.182.
    close(bias.half.map(|half| (half * 1e3).round()), 1837.0);
    // All errors are 1 from their mean, so that no seed says anything else of the variance.
    assert!(variance.half.unwrap_or_default() < 1e-5, "{variance:?}");
    let verdicts: Vec<Option<Verdict>> = results.findings().iter().map(|finding| finding.verdict).collect();
    assert_eq!(verdicts, [Some(Verdict::Holds), Some(Verdict::Undecided)], "not by their means alone");
}

/// Every file of a folder with the time of its last change.
fn times(folder: &Path) -> BTreeMap<String, SystemTime> {
    let entry = |entry: fs::DirEntry| {
        (entry.file_name().to_string_lossy().into_owned(), entry.metadata().unwrap().modified().unwrap())
    };
    fs::read_dir(folder).unwrap().flatten().map(entry).collect()
}

fn without_times(mut results: Results) -> Results {
    results.study.started.clear();
    results.study.references.iter_mut().for_each(|reference| reference.seconds = 0.0);
    for cell in &mut results.cells {
        cell.seconds = 0.0;
        cell.node.clock.clear();
    }
    results
}

#[test]
fn a_study_goes_on_where_it_was_killed() {
    let plan = plan(study(SWEEP));
    let whole = tempfile::tempdir().unwrap();
    let expected = run(&plan, &mut Fake::default(), whole.path()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    // One run for the reference, three for cells, then the end.
    let killed = std::panic::catch_unwind(|| {
        run(&plan, &mut Fake { dies_after: Some(4), ..Fake::default() }, folder.path()).map(|_| ())
    });
    assert!(killed.is_err());
    // What another machine left is taken away once it is old.
    let rest = folder.path().join("cells/.lightloom-x.part");
    fs::write(&rest, "half").unwrap();
    let yesterday = SystemTime::now() - std::time::Duration::from_secs(2 * 24 * 60 * 60);
    fs::File::options().write(true).open(&rest).unwrap().set_modified(yesterday).unwrap();
    let before = times(&folder.path().join("cells"));
    assert_eq!(before.len(), 4, "three cells and a rest: {before:?}");
    let mut lab = Fake::default();
    let ran = run(&plan, &mut lab, folder.path()).unwrap();
    assert_eq!((ran.run, lab.ran.len()), (3, 3), "neither cells nor the reference are run again");
    let after = times(&folder.path().join("cells"));
    assert_eq!(after.len(), 6);
    for (name, time) in before.iter().filter(|(name, _)| name.ends_with(".json")) {
        assert_eq!(after[name], *time, "{name} was written again");
    }
    assert_eq!(without_times(ran.results), without_times(expected.results));
}

#[test]
fn an_edit_runs_what_it_touches() {
    let folder = tempfile::tempdir().unwrap();
    run(&plan(study(SWEEP)), &mut Fake::default(), folder.path()).unwrap();
    // Another value: two new cells, of two seeds; two are of this study no more.
    let edited = plan(study(&SWEEP.replace("256", "128")));
    let lines = told(&edited, &mut Fake::default(), folder.path(), &RunOptions::default());
    assert_eq!(lines[0], "begin 6 4 2");
    assert_eq!(Results::read(folder.path()).unwrap().cells.len(), 6);
    // A shader of the pipeline: all cells, but not the reference.
    let mut lab = Fake { shaders: BTreeMap::from([("fast".to_owned(), 1)]), ..Fake::default() };
    let lines = told(&edited, &mut lab, folder.path(), &RunOptions::default());
    assert_eq!(lines[0], "begin 6 0 8");
    assert!(lab.ran.iter().all(|request| request.pipeline == "fast"), "{:?}", lab.ran);
    // Of the reference: the cells that it judges.
    let mut lab = Fake { shaders: BTreeMap::from([("truth".to_owned(), 1)]), ..Fake::default() };
    assert_eq!(told(&edited, &mut lab, folder.path(), &RunOptions::default())[0], "begin 6 0 14");
}

#[test]
fn parts_join_to_the_whole() {
    let plan = plan(study(SWEEP));
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let whole = run(&plan, &mut Fake::default(), &at("whole")).unwrap();
    let shared = at("shared");
    let mut references = 0;
    for part in 1..=2 {
        let options = RunOptions {
            shard: Some(Shard::Part { part, parts: 2 }),
            references: Some(shared.clone()),
            ..RunOptions::default()
        };
        let mut lab = Fake::default();
        let lines = told(&plan, &mut lab, &at(&format!("part-{part}")), &options);
        assert_eq!(lines[0], "begin 3 0 0");
        references += lab.ran.iter().filter(|request| request.pipeline == "truth").count();
    }
    assert_eq!(references, 1, "the second part takes the reference of the first");
    let merged = study::merge(&[at("part-1"), at("part-2")], &at("merged")).unwrap();
    assert_eq!(without_times(merged.results), without_times(whole.results));
    for table in ["cells.csv", "summary.csv"] {
        let read = |name: &str| fs::read_to_string(at(name).join(table)).unwrap();
        assert_eq!(read("merged"), read("whole"));
    }
    // Into one of the parts too.
    assert_eq!(study::merge(&[at("part-1"), at("part-2")], &at("part-1")).unwrap().results.cells.len(), 6);
}

#[test]
fn a_reference_that_failed_in_one_part_is_taken_from_another() {
    let plan = plan(study(SWEEP));
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    for (part, no_truth) in [(1, true), (2, false)] {
        let options = RunOptions { shard: Some(Shard::Part { part, parts: 2 }), ..RunOptions::default() };
        told(&plan, &mut Fake { no_truth, ..Fake::default() }, &at(&format!("part-{part}")), &options);
    }
    for (first, second) in [("part-1", "part-2"), ("part-2", "part-1")] {
        let merged = study::merge(&[at(first), at(second)], &at(&format!("{first}-first"))).unwrap().results;
        let [reference] = &merged.study.references[..] else { panic!("one: {:?}", merged.study.references) };
        assert!(reference.image.is_some() && reference.error.is_empty(), "{first} first: {reference:?}");
    }
}

#[test]
fn what_does_not_belong_together_is_not_joined() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    run(&plan(study(SWEEP)), &mut Fake::default(), &at("a")).unwrap();
    run(&plan(study(&SWEEP.replace("256", "128"))), &mut Fake::default(), &at("b")).unwrap();
    let error = study::merge(&[at("a"), at("b")], &at("c")).unwrap_err().to_string();
    assert!(error.contains("4 of its 6 cells") && error.contains("b: not a part"), "{error}");
    let text = fs::read_to_string(at("a/study.json")).unwrap();
    let own = format!("\"version\": \"{}\"", env!("CARGO_PKG_VERSION"));
    fs::write(at("b/study.json"), text.replace(&own, "\"version\": \"0.0.1\"")).unwrap();
    let error = study::merge(&[at("a"), at("b")], &at("c")).unwrap_err().to_string();
    assert!(error.contains("b: not a part") && error.contains("the version is 0.0.1, not "), "{error}");
    let error = study::merge(&[at("a"), at("nowhere")], &at("c")).unwrap_err().to_string();
    assert!(error.contains("there is no study here"), "{error}");
}

/// The folder of a shard may have rows from before an edit, of another version, and files that are no rows.
#[test]
fn rows_of_other_plans_and_versions_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    run(&plan(study(&SWEEP.replace("256", "128"))), &mut Fake::default(), &at("a")).unwrap();
    let expected = run(&plan(study(SWEEP)), &mut Fake::default(), &at("a")).unwrap();
    let other = at(&format!("a/cells/{}-1.json", "0".repeat(32)));
    fs::write(&other, "{").unwrap();
    // One of the rows from before the edit, as an earlier version would have written it.
    let index = fs::read_to_string(at("a/index.json")).unwrap();
    let rows = fs::read_dir(at("a/cells")).unwrap().flatten().map(|entry| entry.path());
    let is_stale = |path: &std::path::PathBuf| {
        !index.contains(path.file_stem().unwrap().to_str().unwrap().split('-').next().unwrap())
    };
    let stale = rows.filter(is_stale).find(|path| *path != other).unwrap();
    let text = fs::read_to_string(&stale).unwrap();
    let own = format!("\"version\": \"{}\"", env!("CARGO_PKG_VERSION"));
    assert!(text.contains(&own), "{text}");
    fs::write(&stale, text.replace(&own, "\"version\": \"0.0.1\"")).unwrap();
    for into in ["b", "a"] {
        let merged = study::merge(&[at("a")], &at(into)).unwrap();
        assert_eq!(merged.results.cells, expected.results.cells);
        let refused = merged.refused.join("\n");
        assert_eq!(merged.refused.len(), 3, "{refused}");
        let name = stale.file_name().unwrap().to_str().unwrap();
        let version = merged.refused.iter().find(|why| why.contains(name)).unwrap();
        assert!(version.contains("fast on box, lights = 128, seed"), "{refused}");
        assert!(version.contains("its version is 0.0.1, not "), "{refused}");
        assert!(
            refused.contains("it is of another plan") && refused.contains("0-1.json: cannot be read"),
            "{refused}"
        );
    }
    assert_eq!(fs::read_dir(at("b/cells")).unwrap().count(), 6, "they were not copied");
}

/// Two processes in one folder: a batch system took one for dead, and started the other.
#[test]
fn a_cell_that_ran_twice_leaves_one_row() {
    let folder = tempfile::tempdir().unwrap();
    let plan = plan(study(SWEEP));
    let options = RunOptions { shard: Some(Shard::Part { part: 1, parts: 1 }), ..RunOptions::default() };
    let (mut one, mut other) = (Fake::default(), Fake::default());
    let mut begun = false;
    let ran = study::run(&plan, &mut one, folder.path(), &options, &mut |event| {
        // In the middle of the first cell, the other process runs all.
        if matches!(event, study::Event::Cell { .. }) && !begun {
            begun = true;
            study::run(&plan, &mut other, folder.path(), &options, &mut |_| {}).unwrap();
        }
    });
    assert_eq!(ran.unwrap().run, 1, "the others were finished by then");
    assert_eq!(fs::read_dir(folder.path().join("cells")).unwrap().count(), 6);
    let whole = tempfile::tempdir().unwrap();
    let expected = run(&plan, &mut Fake::default(), whole.path()).unwrap();
    let found = Results::read(folder.path()).unwrap();
    assert_eq!(without_times(found), without_times(expected.results));
}

/// Shards take no lock, and a whole run does.
#[test]
fn a_shard_works_beside_others() {
    let folder = tempfile::tempdir().unwrap();
    let plan = plan(study(SWEEP));
    let options = RunOptions { shard: Some(Shard::Part { part: 1, parts: 2 }), ..RunOptions::default() };
    let mut tries = Vec::new();
    let ran = study::run(&plan, &mut Fake::default(), folder.path(), &RunOptions::default(), &mut |event| {
        if matches!(event, study::Event::Begin { .. }) {
            let mut lab = Fake::default();
            tries.push(study::run(&plan, &mut lab, folder.path(), &options, &mut |_| {}).map(|ran| ran.run));
            tries.push(run(&plan, &mut lab, folder.path()).map(|ran| ran.run));
        }
    });
    assert_eq!(ran.unwrap().results.cells.len(), 6);
    assert!(matches!(tries[..], [Ok(3), Err(study::StudyError::Locked { .. })]), "{tries:?}");
}

/// Adapters share a study: each cell has one row, which carries its machine.
#[test]
fn shards_of_several_adapters_are_joined() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let plan = plan(study(SWEEP));
    let mut labs = [Fake::default(), Fake { adapter: Some(("abacus", 3.0)), ..Fake::default() }];
    for (part, lab) in (1..).zip(&mut labs) {
        let options = RunOptions {
            shard: Some(Shard::Part { part, parts: 2 }),
            references: Some(at("shared")),
            ..RunOptions::default()
        };
        study::run(&plan, lab, &at("all"), &options, &mut |_| {}).unwrap();
    }
    assert!(labs[1].ran.iter().all(|request| request.pipeline != "truth"), "the reference is shared");
    let merged = study::merge(&[at("all")], &at("all")).unwrap();
    assert_eq!((merged.results.cells.len(), merged.refused.len()), (6, 0));
    assert_eq!(merged.results.adapters(), ["paper and pencil", "abacus"]);
    for cell in &merged.results.cells {
        assert!(!cell.node.host.is_empty() && !cell.node.clock.is_empty(), "{:?}", cell.node);
    }
    // Another run by one of them runs what the other ran, and takes its own rows.
    let ran = run(&plan, &mut labs[1], &at("all")).unwrap();
    assert_eq!((ran.run, ran.results.adapters()), (3, vec!["abacus"]));
    assert_eq!(fs::read_dir(at("all/cells")).unwrap().count(), 9);
}

/// Records of a run say what cells cost, and shards are alike by that, not by their number of cells.
#[test]
fn shards_are_cut_by_cost() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let text = "Study(scenes: [\"box\"], pipelines: [\"fast\", \"exact\"], size: (8, 4), seeds: 4, measures: [\"rmse\"],
        vary: Grid({ \"lights\": [16, 64, 256] }), reference: Pipeline(pipeline: \"truth\"))";
    // A run of one seed, with the ends of the axis.
    let mut timing = parse(text);
    timing.edit(&study::Edits { timing: true, ..Default::default() }).unwrap();
    run(&plan(timing), &mut Fake::default(), &at("timing")).unwrap();
    let mut rows = 0;
    for entry in fs::read_dir(at("timing/cells")).unwrap().flatten() {
        // The cells of `exact` took nine times as long.
        let mut row: serde_json::Value = serde_json::from_slice(&fs::read(entry.path()).unwrap()).unwrap();
        row["seconds"] = (if row["pipeline"] == "exact" { 90.0 } else { 10.0 }).into();
        fs::write(entry.path(), row.to_string()).unwrap();
        rows += 1;
    }
    assert_eq!(rows, 4, "two pipelines at both ends");
    let costs = study::Costs::read(&at("timing")).unwrap();
    assert_eq!(costs.cell_count(), 4);
    let plan = plan(parse(text));
    // 12 cells of 10 seconds and 12 of 90: 20 minutes are one shard.
    assert_eq!(costs.of_cells(&plan).iter().sum::<f64>(), 1200.0);
    assert_eq!(plan.shards(&costs, study::SHARD_MINUTES).len(), 1);
    assert_eq!(plan.shards(&costs, 10.0), [0..17, 17..24]);
    let mut counts = Vec::new();
    for part in 1..=2 {
        let options = RunOptions {
            shard: Some(Shard::Part { part, parts: 2 }),
            costs: costs.clone(),
            ..RunOptions::default()
        };
        let mut lab = Fake::default();
        counts.push(study::run(&plan, &mut lab, &at("all"), &options, &mut |_| {}).unwrap().run);
    }
    assert_eq!(counts, [17, 7], "12 · 10 + 5 · 90 = 570 s, and 7 · 90 = 630 s");
    assert_eq!(study::merge(&[at("all")], &at("all")).unwrap().results.cells.len(), 24);
    assert!(study::Costs::read(&at("nowhere")).unwrap_err().to_string().contains("there is no study here"));
}

/// What a Snakefile has: references by one job, cells by others.
#[test]
fn references_are_rendered_apart() {
    let folder = tempfile::tempdir().unwrap();
    let sizes = "vary: Grid({ \"size\": [(8, 4), (4, 4)] }), seeds: 2, measures: [\"rmse\"],
        reference: Pipeline(pipeline: \"truth\")";
    let plan = plan(study(sizes));
    let run = |shard: &str| {
        let mut lab = Fake::default();
        let options = RunOptions { shard: Some(shard.parse().unwrap()), ..RunOptions::default() };
        study::run(&plan, &mut lab, folder.path(), &options, &mut |_| {}).map(|ran| {
            let references = lab.ran.iter().filter(|request| request.pipeline == "truth").count();
            (references, ran.run)
        })
    };
    assert_eq!(run("references:2-2/2").unwrap(), (1, 0));
    assert_eq!(run("references").unwrap(), (1, 0), "the other was rendered");
    assert_eq!(run("cells:2-4/4").unwrap(), (0, 3));
    assert_eq!(run("cells:1-1/4").unwrap(), (0, 1));
    let error = run("cells:1-6/6").unwrap_err().to_string();
    assert!(error.contains("with 6 cells, and this one has 4"), "{error}");
    let results = study::merge(&[folder.path().to_owned()], folder.path()).unwrap().results;
    assert_eq!((results.cells.len(), results.study.references.len()), (4, 2));
}

/// The seeds of a combination share the lights that meet a time, and so one shard searches for them.
#[test]
fn seeds_that_share_a_value_are_not_cut() {
    let fields = "vary: Grid({ \"map\": [32, 64] }), seeds: 3, measures: [\"gpu-ms\"], budget: Time(ms: 3.0, by: \"lights\")";
    let plan = plan(study(fields));
    let folder = tempfile::tempdir().unwrap();
    for part in 1..=6 {
        let options = RunOptions { shard: Some(Shard::Part { part, parts: 6 }), ..RunOptions::default() };
        let ran = study::run(&plan, &mut Fake::default(), folder.path(), &options, &mut |_| {}).unwrap();
        assert!([0, 3].contains(&ran.run), "{part}: {}", ran.run);
    }
}

#[test]
fn a_walk_is_judged_frame_by_frame() {
    let folder = tempfile::tempdir().unwrap();
    let mut walk = study(
        "budget: Frames(4), warm_up: 2, first_frame: 3, jump: 6, seeds: [2], reference: Pipeline(pipeline: \"truth\"),
         measures: [\"rmse\", \"normalised-rmse\", \"e\", \"e-prime\", \"tone-error\", \"tone-change\", \"tid\",
                    \"lag\", \"static-deviation\"]",
    );
    walk.edit(&study::Edits { scenes: vec!["walk".to_owned()], ..Default::default() }).unwrap();
    let mut lab = Fake::default();
    let ran = run(&plan(walk), &mut lab, folder.path()).unwrap();
    // A reference each of the frames 5 to 8, at a time that stands still.
    let frames: Vec<u32> =
        lab.ran.iter().filter(|request| request.until_done).map(|request| request.first_frame).collect();
    assert_eq!(frames, [5, 6, 7, 8]);
    let cell = &ran.results.cells[0];
    // Seed 2: an error of −0.5 / 64 beside 7, 8, 9, 10.
    let error = 0.5 / 64.0;
    close(cell.measures["rmse"], error);
    close(cell.measures["normalised-rmse"], error * (1.0 / 7.0 + 1.0 / 8.0 + 1.0 / 9.0 + 1.0 / 10.0) / 4.0);
    let shown = |x: f64| x / (1.0 + x);
    let errors: Vec<f64> = (7..=10).map(|n| shown(f64::from(n) - error) - shown(f64::from(n))).collect();
    let mean_error = errors.iter().map(|e| e.abs()).sum::<f64>() / 4.0;
    // All pixels are alike, and so are the tracked ones.
    for key in ["e", "tone-error"] {
        assert!((cell.measures[key].unwrap() / mean_error - 1.0).abs() < 1e-2, "{:?}", cell.measures);
        let series = &cell.series.values[key];
        assert!(
            series.iter().zip(&errors).all(|(found, e)| (found.unwrap() / e.abs() - 1.0).abs() < 1e-2),
            "{series:?}"
        );
    }
    let change = errors.windows(2).map(|pair| (pair[1] - pair[0]).abs() / 0.5).sum::<f64>() / 3.0;
    for key in ["e-prime", "tone-change"] {
        assert!((cell.measures[key].unwrap() / change - 1.0).abs() < 2e-2, "{:?}", cell.measures);
        assert_eq!(cell.series.values[key][0], None, "the first frame has none before it");
    }
    // Every pixel grows by 1 a frame.
    close(cell.measures["tid"], 1.0);
    assert_eq!(cell.measures["static-deviation"], None, "nothing stands still");
    assert_eq!(cell.images.reference.as_deref().map(|name| name.ends_with("-0008.exr")), Some(true));
}

#[test]
fn a_reference_follows_what_it_is_told_to() {
    let folder = tempfile::tempdir().unwrap();
    let follows = "vary: Grid({ \"lights\": [16, 64] }), seeds: 2, measures: [\"rmse\"],
        reference: Pipeline(pipeline: \"exact\", follow: [\"lights\", \"seed\"])";
    let mut lab = Fake::default();
    let ran = run(&plan(study(follows)), &mut lab, folder.path()).unwrap();
    assert_eq!(ran.results.study.references.len(), 4);
    assert!(lab.ran.iter().filter(|request| request.pipeline == "exact").all(|request| request.frames == 1));
    // Lights and seed are those of the reference, and so is the error.
    for cell in &ran.results.cells {
        assert_eq!((cell.outcome.clone(), cell.measures["rmse"]), (Outcome::Done, Some(0.0)));
    }
}

#[test]
fn pipelines_that_are_alike_have_cells_of_their_own() {
    let text = "Study(scenes: [\"box\"], pipelines: [\"fast\", Variant(name: \"same\", pipeline: \"fast\")], size: (8, 4),
        measures: [\"gpu-ms\"])";
    let plan = plan(parse(text));
    let (_folder, ran) = done(&plan);
    let names: Vec<&str> = ran.results.cells.iter().map(|cell| cell.pipeline.as_str()).collect();
    assert_eq!(names, ["fast", "same"]);
    assert!(ran.results.study.differences[0].lines.is_empty());
}

/// Parts of a study whose frames vary in size keep the reference of each.
#[test]
fn references_of_every_size_are_joined() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let sizes = "vary: Grid({ \"size\": [(8, 4), (4, 4)] }), measures: [\"rmse\"], reference: Pipeline(pipeline: \"truth\")";
    for part in 1..=2 {
        let options = RunOptions { shard: Some(Shard::Part { part, parts: 2 }), ..RunOptions::default() };
        told(&plan(study(sizes)), &mut Fake::default(), &at(&part.to_string()), &options);
    }
    let merged = study::merge(&[at("1"), at("2")], &at("all")).unwrap().results;
    let from: Vec<&str> = merged.study.references.iter().map(|reference| reference.from.as_str()).collect();
    assert_eq!(from, ["pipeline truth, 8x4", "pipeline truth, 4x4"]);
}

#[test]
fn figures_of_passes_are_means_over_frames() {
    let text = "Study(scenes: [\"walk\"], pipelines: [\"exact\", \"fast\"], size: (8, 4), budget: Frames(4),
        measures: [\"mean\"], figures: { \"hits\": \"rays/trace.counters.hits\" })";
    let study =
        study::parse(Source::new("studies/test.ron", text)).unwrap_or_else(|errors| panic!("{errors}"));
    let (_folder, ran) = done(&plan(study));
    for cell in &ran.results.cells {
        // The fake tells the number of the frame: 1 to 4, after one to warm up.
        let expected = (cell.pipeline == "exact").then_some(2.5);
        assert_eq!(cell.measures["figure:hits"], expected, "{}", cell.pipeline);
        let series = cell.series.values.get("figure:hits").map(Vec::len);
        assert_eq!(series, expected.map(|_| 4), "{}", cell.pipeline);
    }
}

#[test]
fn a_reference_tells_how_far_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let plan = plan(study("measures: [\"rmse\"], reference: Pipeline(pipeline: \"truth\")"));
    let lines = told(&plan, &mut Fake::default(), folder.path(), &RunOptions::default());
    assert_eq!(
        lines[1..4],
        ["reference box at 8x4", "step box at 8x4 1/1 8/16 None", "step box at 8x4 1/1 16/16 Some(1e-6)"]
    );
    assert!(!lines[4..].iter().any(|line| line.starts_with("step")), "cells do not: {lines:?}");
}

#[test]
fn crops_are_recorded_and_run_nothing_again() {
    let folder = tempfile::tempdir().unwrap();
    let with = |crops: &str| plan(study(&format!("measures: [\"gpu-ms\"]{crops}")));
    assert_eq!(run(&with(""), &mut Fake::default(), folder.path()).unwrap().run, 1);
    let ran = run(&with(", crops: [(0.25, 0, 0.5, 1)]"), &mut Fake::default(), folder.path()).unwrap();
    assert_eq!((ran.run, ran.results.study.crops), (0, vec![[0.25, 0.0, 0.5, 1.0]]));
}
