//! Values frame by frame.

use super::fake::{Fake, done, parse, plan, run, study, told};
use std::fs;
use study::{FrameSeries, Plan, Results, RunOptions};

fn walk(frames: u32) -> Plan {
    let mut walk = study(&format!(
        "budget: Frames({frames}), warm_up: 2, first_frame: 3, seeds: [2], reference: Pipeline(pipeline: \"truth\"),
         measures: [\"rmse\", \"energy\", \"mean\", \"tid\", \"gpu-ms\", \"memory\", \"clamped-energy\", \"lights-moved\",
             \"lag\"], jump: 6,
         phases: {{ \"view\": [\"view\"], \"lit\": [\"gather\"] }}"
    ));
    walk.edit(&study::Edits { scenes: vec!["walk".to_owned()], ..Default::default() }).unwrap();
    plan(walk)
}

/// The picture of the fake grows by 1 from frame to frame, whatever a pipeline makes of it.
#[test]
fn the_reference_has_a_temporal_difference_of_its_own() {
    let mut walk = study(
        "budget: Frames(3), reference: Pipeline(pipeline: \"truth\"), measures: [\"tid\", \"tid-of-reference\"]",
    );
    walk.edit(&study::Edits { scenes: vec!["walk".to_owned()], ..Default::default() }).unwrap();
    let (_folder, ran) = done(&plan(walk));
    let cell = &ran.results.cells[0];
    let series = &cell.series.values["tid-of-reference"];
    assert_eq!(series[0], None, "the first frame has none before it");
    assert!(series[1..].iter().all(|tid| (tid.unwrap() - 1.0).abs() < 1e-6), "{series:?}");
    assert!((cell.measures["tid-of-reference"].unwrap() - 1.0).abs() < 1e-6);
}

#[test]
fn a_walk_keeps_every_frame() {
    let folder = tempfile::tempdir().unwrap();
    let ran = run(&walk(3), &mut Fake::default(), folder.path()).unwrap();
    let cell = &ran.results.cells[0];
    // Frames 5 to 7, lights of 7 to 9; seed 2 is −0.5 / 64 off, which f32 holds exactly.
    let error = 0.5 / 64.0;
    let series = &cell.series;
    assert_eq!(series.first, 5);
    let keys: Vec<&str> = series.values.keys().map(String::as_str).collect();
    // Memory and lag are no matters of a frame.
    assert_eq!(
        keys,
        [
            "clamped-energy",
            "energy",
            "gpu-ms",
            "gpu-ms:lit",
            "gpu-ms:view",
            "lights-moved",
            "mean",
            "rmse",
            "tid"
        ]
    );
    for (share, frame) in series.values["clamped-energy"].iter().zip([5.0, 6.0, 7.0]) {
        assert!((share.unwrap() - frame / (1.0 + frame)).abs() < 1e-6, "{series:?}");
    }
    assert_eq!(series.values["lights-moved"], [None, Some(0.5), Some(0.0)], "one of two in frame 6");
    assert_eq!(series.values["rmse"], [Some(error); 3]);
    assert_eq!(series.values["mean"], [7.0, 8.0, 9.0].map(|truth| Some(truth - error)));
    assert_eq!(series.values["tid"][0], None, "the first frame has none before it");
    assert!(series.values["tid"][1..].iter().all(|tid| (tid.unwrap() - 1.0).abs() < 1e-6), "{series:?}");
    assert_eq!(series.values["gpu-ms:view"], [Some(2.0); 3]);
    for (energy, truth) in series.values["energy"].iter().zip([7.0, 8.0, 9.0]) {
        assert!((energy.unwrap() - (1.0 - error / truth)).abs() < 1e-12);
    }
    assert_eq!(cell.measures["mean"], Some(8.0 - error), "of all frames");
    let table = fs::read_to_string(folder.path().join("frames.csv")).unwrap();
    let lines: Vec<&str> = table.lines().collect();
    assert_eq!(lines.len(), 1 + 3 * keys.len());
    assert_eq!(
        lines[..10],
        [
            "scene,pipeline,seed,frame,measure,value,unit",
            "walk,fast,2,5,rmse,0.0078125,W/(m² sr)",
            &format!("walk,fast,2,5,energy,{},", series.values["energy"][0].unwrap()),
            "walk,fast,2,5,mean,6.9921875,W/(m² sr)",
            "walk,fast,2,5,tid,,W/(m² sr)",
            "walk,fast,2,5,gpu-ms,2.64,ms",
            &format!("walk,fast,2,5,clamped-energy,{},", series.values["clamped-energy"][0].unwrap()),
            "walk,fast,2,5,lights-moved,,",
            "walk,fast,2,5,gpu-ms:view,2,ms",
            &format!("walk,fast,2,5,gpu-ms:lit,{},ms", series.values["gpu-ms:lit"][0].unwrap()),
        ]
    );
    assert!(lines[10].starts_with("walk,fast,2,6,rmse,"), "{}", lines[10]);
    assert_eq!(Results::read(folder.path()).unwrap(), ran.results);
    study::report(&ran.results, folder.path()).unwrap();
    assert!(folder.path().join("figures/walk-tid-frames.svg").is_file());
}

#[test]
fn what_stands_still_has_no_series() {
    let still = study("budget: Frames(3), measures: [\"mean\", \"gpu-ms\", \"tid\"]");
    let (folder, ran) = done(&plan(still));
    assert_eq!(ran.results.cells[0].series, FrameSeries::default());
    let table = fs::read_to_string(folder.path().join("frames.csv")).unwrap();
    assert_eq!(table, "scene,pipeline,seed,frame,measure,value,unit\n");
    study::report(&ran.results, folder.path()).unwrap();
    let page = fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(!page.contains("Frame by frame") && !page.contains("Claims"));
}

/// Frames after one with pixels that are no numbers are timed, and nothing more; the failed cell is in no figure.
#[test]
fn a_broken_frame_ends_what_is_measured_of_pixels() {
    let text = "Study(scenes: [\"walk\"], pipelines: [\"nan\"], size: (8, 4), budget: Frames(2),
        measures: [\"mean\", \"gpu-ms\"])";
    let plan = plan(parse(text));
    let (folder, ran) = done(&plan);
    let series = &ran.results.cells[0].series;
    assert_eq!(series.values.keys().collect::<Vec<_>>(), ["gpu-ms"]);
    assert_eq!(fs::read_to_string(folder.path().join("frames.csv")).unwrap().lines().count(), 1);
}

/// Records from before there were series and claims are read as having none.
#[test]
fn older_records_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let ran = run(&walk(3), &mut Fake::default(), folder.path()).unwrap();
    let cell = folder.path().join(format!("cells/{}.json", ran.results.cells[0].key));
    for (path, field) in [(&cell, "series"), (&folder.path().join("study.json"), "claims")] {
        let mut record: serde_json::Value = serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap();
        assert!(record.as_object_mut().unwrap().remove(field).is_some(), "{field} is kept");
        fs::write(path, record.to_string()).unwrap();
    }
    let read = Results::read(folder.path()).unwrap();
    assert_eq!((read.cells.len(), &read.cells[0].series), (1, &FrameSeries::default()));
    assert_eq!(read.cells[0].measures, ran.results.cells[0].measures);
    study::report(&read, folder.path()).unwrap();
    // The same cell is still finished.
    let lines = told(&walk(3), &mut Fake::default(), folder.path(), &RunOptions::default());
    assert_eq!(lines[0], "begin 1 1 0");
}
