//! The table of extremes: each case's scene loads, names are unique, and cases of settings follow what is declared.

use data_file::{Setting, Value, ValueType};
use frame_graph::resolve::Settable;
use metrics::Image;
use std::collections::HashSet;
use std::path::Path;
use std::time::Duration;
use stress::{
    Case, Cell, Ended, Expect, Options, Program, Ran, Subject, Verdict, cases, of_pairs, of_settings,
};
use study::{CellRun, Failure, Laboratory, Observed, Occluded, Results, RunOptions, RunRequest, Shard, Step};

/// No files but those on disk.
struct Nothing;

impl data_file::Files for Nothing {
    fn read(&self, _: &str) -> Option<std::sync::Arc<data_file::Source>> {
        None
    }

    fn list(&self) -> Vec<String> {
        Vec::new()
    }
}

impl scene::SceneFiles for Nothing {
    fn folder(&self) -> std::path::PathBuf {
        std::path::PathBuf::new()
    }
}

#[test]
fn names_are_unique_and_the_plain_scene_is_first() {
    let all = cases();
    let names: HashSet<&str> = all.iter().map(|case| case.name.as_str()).collect();
    assert_eq!(names.len(), all.len());
    assert_eq!((all[0].name.as_str(), all[0].expect), ("plain", Expect::Truth));
    assert!(all.len() > 40, "{}", all.len());
}

#[test]
fn the_scene_of_every_case_loads() {
    let folder = tempfile::tempdir().unwrap();
    // Gigabytes are for `lightloom stress`.
    for case in cases().into_iter().filter(|case| case.name != "triangles-1e7") {
        for (name, text) in &case.files {
            std::fs::write(folder.path().join(name), text).unwrap();
        }
        let path = folder.path().join(format!("{}.ron", case.name));
        std::fs::write(&path, &case.scene).unwrap();
        let loaded = scene::load(&path.display().to_string(), &Nothing);
        if case.expect == Expect::Refused {
            assert!(loaded.is_err(), "{} is not refused", case.name);
            continue;
        }
        let scene = loaded.unwrap_or_else(|error| panic!("{}: {error}", case.name));
        assert!(scene.about.len() > 10, "{}", case.name);
    }
}

fn settable(path: &str, ty: ValueType, value: Value, (min, max): (Option<f64>, Option<f64>)) -> Settable {
    let name = path.rsplit('.').next().unwrap_or(path).to_owned();
    let setting = Setting {
        name,
        ty,
        default: value.clone(),
        min,
        max,
        one_of: Vec::new(),
        unit: String::new(),
        doc: String::new(),
        declared: String::new(),
    };
    Settable { path: path.to_owned(), setting, value }
}

fn some() -> Vec<Settable> {
    let choices = ["wide", "narrow", "none"].map(|text| Value::Text(text.to_owned()));
    let mut choice = settable("filter.shape", ValueType::Text, choices[0].clone(), (None, None));
    choice.setting.one_of = choices.to_vec();
    vec![
        settable("lights", ValueType::U32, Value::U32(1), (Some(1.0), Some(4096.0))),
        settable("gather.clamp", ValueType::F32, Value::F32(0.5), (Some(0.0), None)),
        settable("gather.half", ValueType::Bool, Value::Bool(true), (None, None)),
        choice,
    ]
}

#[test]
fn settings_are_tried_at_the_ends_of_what_they_declare() {
    let cases = of_settings(&some());
    let names: Vec<&str> = cases.iter().map(|case| case.name.as_str()).collect();
    let wanted =
        ["lights=4096", "gather.clamp=0.0", "gather.half=false", "filter.shape=narrow", "filter.shape=none"];
    assert_eq!(names, wanted, "what a setting has already is not tried");
    assert_eq!(cases[0].set, [("lights".to_owned(), "4096".to_owned())]);
}

#[test]
fn pairs_are_of_two_settings_and_the_same_for_a_seed() {
    let pairs = of_pairs(&some(), 6, 1);
    assert_eq!(pairs, of_pairs(&some(), 6, 1));
    assert_ne!(pairs, of_pairs(&some(), 6, 2));
    assert_eq!(pairs.len(), 6);
    for pair in &pairs {
        assert_eq!(pair.set.len(), 2);
        assert_ne!(pair.set[0].0, pair.set[1].0, "{}", pair.name);
    }
}

/// A program that says the same of every picture.
struct Says(&'static str);

impl Program for Says {
    fn run(&self, _: &[String], _: Duration) -> std::io::Result<Ran> {
        Ok(Ran { ended: Ended::Exit(1), output: String::new(), errors: self.0.to_owned() })
    }
}

/// What runs depend on: nothing.
struct Known;

impl Laboratory for Known {
    fn adapter(&self) -> String {
        "none".to_owned()
    }

    fn identity(&mut self, _: &RunRequest) -> Result<u128, Failure> {
        Ok(0)
    }

    fn run(
        &mut self,
        _: &RunRequest,
        _: &mut dyn FnMut(Observed) -> Result<(), Failure>,
        _: &mut dyn FnMut(Step),
    ) -> Result<CellRun, Failure> {
        unreachable!("processes render")
    }

    fn occluded(&mut self, _: &str, _: u32) -> Result<Occluded, Failure> {
        unreachable!("nothing asks for it")
    }
}

fn run(program: &dyn Program, cases: &[Case], folder: &Path) -> Vec<Cell> {
    run_part(program, cases, folder, None).1
}

fn run_part(
    program: &dyn Program,
    cases: &[Case],
    folder: &Path,
    shard: Option<Shard>,
) -> (Results, Vec<Cell>) {
    let name = "ism".to_owned();
    let subject = Subject { name, settable: Vec::new(), bounces: 1, sampled: false, cases: Vec::new() };
    let options = Options {
        folder: folder.to_owned(),
        size: (2, 2),
        set: Vec::new(),
        samples: 4,
        set_reference: Vec::new(),
        limit: Duration::from_secs(1),
        study: RunOptions { shard, ..RunOptions::default() },
    };
    stress::run((program, &mut Known), &[subject], cases, &options, &mut |_| {}).unwrap()
}

/// A full disk says nothing of a pipeline.
#[test]
fn pictures_that_cannot_be_written_are_no_refusals() {
    let said = |says| {
        let folder = tempfile::tempdir().unwrap();
        let cells = run(&Says(says), &cases()[..2], folder.path());
        (cells[1].verdict, cells[1].message.clone())
    };
    let full = "note: a repair\n{\n  \"errors\": [{\n \"message\": \"the picture a.exr was not written\", \
                \"help\": [\"a.exr: No space left on device\"]\n}]}\n";
    let (verdict, message) = said(full);
    assert_eq!(verdict, Verdict::Crashed);
    assert!(message.ends_with("a picture could not be written: a.exr: No space left on device"), "{message}");
    let refused = said("{\"warnings\": []}\n{\"errors\": [{\"message\": \"no {light}\"}]}\n");
    assert_eq!(refused, (Verdict::Refused, "no {light}".to_owned()));
    assert_eq!(said("thread 'main' panicked at error.rs").0, Verdict::Crashed);
}

/// A program that renders grey: the reference and the plain scene 1, and the case by seed. It counts its runs.
struct Grey(fn(u32) -> f32, Cell32);

type Cell32 = std::cell::Cell<u32>;

impl Program for Grey {
    fn run(&self, arguments: &[String], _: Duration) -> std::io::Result<Ran> {
        self.1.set(self.1.get() + 1);
        let after = |name: &str| {
            let at = arguments.iter().position(|argument| argument == name)?;
            arguments.get(at + 1)
        };
        let is_case = arguments.iter().any(|argument| argument.ends_with("frame-1x1.ron"));
        let grey = match after("--seed").map_or(0, |seed| seed.parse().unwrap()) {
            seed if is_case && arguments[2] != stress::REFERENCE => self.0(seed),
            _ => 1.0,
        };
        // Of 2×2 pixels 4 each, so of one pixel 16.
        if arguments[2] == stress::REFERENCE {
            let samples = if is_case { "samples=16" } else { "samples=4" };
            assert!(arguments.iter().any(|argument| argument == samples), "{arguments:?}");
        }
        let side = if is_case { 1 } else { 2 };
        let picture = Image::from_fn(side, side, |_, _| [grey, grey, grey, 1.0]).unwrap();
        let stem = after("-o").unwrap().trim_end_matches(".exr");
        for output in ["indirect", "image"] {
            picture.write(format!("{stem}-{output}.exr"), metrics::Display::default(), None).unwrap();
        }
        Ok(Ran { ended: Ended::Exit(0), output: String::new(), errors: String::new() })
    }
}

/// Only the mean over seeds tells a picture of few lights from one that is wrong.
#[test]
fn energy_that_is_off_is_judged_by_further_seeds() {
    let case: Vec<Case> = cases().into_iter().filter(|case| case.name == "frame-1x1").collect();
    let run = |grey| {
        let folder = tempfile::tempdir().unwrap();
        let cell = run(&Grey(grey, Cell32::new(0)), &case, folder.path()).swap_remove(0);
        let kept = Image::read(folder.path().join(cell.image.as_ref().unwrap())).unwrap().pixels()[0][0];
        (cell, kept)
    };
    let varies = |seed: u32| if seed.is_multiple_of(2) { 0.2 } else { 1.9 };
    let (cell, _) = run(varies);
    let seeds = cell.seeds.unwrap();
    assert_eq!(cell.verdict, Verdict::Held);
    assert!((seeds.mean - 1.05).abs() < 1e-6 && cell.energy == Some(seeds.mean), "{seeds:?}");
    assert!((cell.first.unwrap() - 0.2).abs() < 1e-6 && seeds.half.unwrap() > 0.3, "{cell:?}");

    let is_dark = |seed: u32| if seed.is_multiple_of(2) { 0.2 } else { 0.5 };
    let (cell, kept) = run(is_dark);
    assert_eq!((cell.verdict, kept), (Verdict::Off, 0.2), "the first picture is kept");
    assert!((cell.energy.unwrap() - 0.35).abs() < 1e-6, "{cell:?}");
    let tables = stress::tables(std::slice::from_ref(&cell), &cases());
    let texts: Vec<String> = tables.iter().map(report::Table::text).collect();
    assert!(texts[0].contains("0.35") && texts[1].contains(&cell.command), "{texts:?}");

    let breaks = |seed: u32| if seed == 7 { f32::NAN } else { 0.2 };
    let (cell, kept) = run(breaks);
    assert_eq!(cell.verdict, Verdict::NotFinite);
    assert!(kept.is_nan(), "the picture with the defect is kept");
    assert!(cell.command.contains("--seed 7"), "{}", cell.command);

    let (cell, _) = run(|seed| if seed == 0 { 1.5 } else { 0.0 });
    assert_eq!((cell.verdict, cell.seeds), (Verdict::Held, None), "what holds at once is not repeated");
}

/// A run that was stopped goes on, and its parts come to the same: what is finished does not run again.
#[test]
fn what_is_finished_does_not_run_again() {
    let folders = [(); 4].map(|()| tempfile::tempdir().unwrap());
    let [whole, first, second, merged] = folders.each_ref().map(|folder| folder.path());
    let grey = Grey(|_| 1.2, Cell32::new(0));
    let case: Vec<Case> = cases().into_iter().filter(|case| case.name == "frame-1x1").collect();
    let cells = run(&grey, &case, whole);
    let runs = grey.1.get();
    assert_eq!(runs, 4, "the plain scene and the case, each by the pipeline and the path tracer");
    assert_eq!(run(&grey, &case, whole), cells);
    assert_eq!(grey.1.get(), runs);

    for (folder, part) in [(first, 1), (second, 2)] {
        run_part(&grey, &case, folder, Some(Shard::Part { part, parts: 2 }));
    }
    study::merge(&[first.to_owned(), second.to_owned()], merged).unwrap();
    let runs = grey.1.get();
    let of_parts = run(&grey, &case, merged);
    assert_eq!(grey.1.get(), runs);
    assert_eq!((of_parts[0].verdict, of_parts[0].energy), (cells[0].verdict, cells[0].energy));
}

/// Verdicts, energies and faults of a run are details, measures and claims of its study; with them it goes on as without.
#[test]
fn what_is_said_of_cells_is_in_the_study() {
    let folder = tempfile::tempdir().unwrap();
    let case: Vec<Case> = cases().into_iter().filter(|case| case.name == "frame-1x1").collect();
    for (shade, verdict) in [(1.2, study::Verdict::Holds), (0.1, study::Verdict::Fails)] {
        let folder = folder.path().join(verdict_name(verdict));
        let program = Grey(if shade > 1.0 { |_| 1.2 } else { |_| 0.1 }, Cell32::new(0));
        let (mut results, cells) = run_part(&program, &case, &folder, None);
        stress::add(&mut results, &cells);
        study::keep(&results, &folder).unwrap();
        let read = Results::read(&folder).unwrap();
        let verdicts: Vec<_> = read.findings().iter().map(|finding| finding.verdict).collect();
        assert_eq!(verdicts, [Some(study::Verdict::Holds), Some(verdict)], "no faults, and the energy");
        let judged = read.cells.iter().find(|cell| cell.scene == "frame-1x1").unwrap();
        assert_eq!(judged.details["verdict"], serde_json::json!(cells[0].verdict));
        assert_eq!(run(&program, &case, &folder), cells, "what is finished is known");
    }
}

fn verdict_name(verdict: study::Verdict) -> String {
    format!("{verdict:?}")
}
