//! Figures over the number of the frame.

use std::collections::BTreeMap;
use std::path::Path;

use study::{AxisValue, FrameSeries, Results};

use super::sample::{self, PIPELINES};

/// The sample's first scene as a walk of this many frames from number 10: `flip` is the number of the pipeline, counted
/// from 1, with a wave; the second pipeline has no value in the third frame.
fn walk(frames: u32) -> Results {
    let mut results = sample::results();
    results.cells.truncate(results.cells.len() / 2);
    results.study.scenes.truncate(1);
    for cell in &mut results.cells {
        let pipeline = PIPELINES.iter().position(|name| *name == cell.pipeline).expect("a pipeline");
        let value = |frame: u32| {
            let AxisValue::Number(lights) = cell.axes["lights"] else { unreachable!("a number") };
            let wave = 0.2 * f64::sin(f64::from(frame) * 0.35 + 0.01 * lights);
            let seeds = 0.02 * f64::from(cell.seed);
            (pipeline != 1 || frame != 2).then_some((pipeline + 1) as f64 + wave + seeds)
        };
        let values = BTreeMap::from([
            ("flip".to_owned(), (0..frames).map(value).collect()),
            ("tid".to_owned(), (0..frames).map(|frame| (frame > 0).then_some(0.5)).collect()),
        ]);
        cell.series = FrameSeries { first: 10, values };
    }
    results
}

fn figure(folder: &Path, name: &str) -> String {
    std::fs::read_to_string(folder.join("figures").join(name)).expect("a figure")
}

/// Curves of a figure: the paths of its series before their marks.
fn curves(figure: &str) -> usize {
    let lines = |series: &str| {
        let end = series.find("class=\"mark\"").into_iter().chain(series.find("</g>")).min();
        series[..end.unwrap_or(series.len())].matches("<path").count()
    };
    figure.split("class=\"series ").skip(1).map(lines).sum()
}

#[test]
fn a_curve_for_each_pipeline_and_combination() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut results = walk(12);
    // Without the filter, three combinations: told apart by dashes in one figure.
    results.cells.retain(|cell| cell.axes["gather.filter"] == AxisValue::Bool(false));
    study::report(&results, folder.path()).expect("a report");
    let tid = figure(folder.path(), "cornell-box-tid-frames.svg");
    assert_eq!(curves(&tid), 9);
    assert_eq!(tid.matches("class=\"mark\"").count(), 9 * 11, "the first frame has none");
    // A curve is broken where a frame has no value.
    assert_eq!(curves(&figure(folder.path(), "cornell-box-flip-frames.svg")), 9 + 3);
    for name in ["lights = 64", "lights = 256", "lights = 1024", ">frame<", ">12<"] {
        assert!(tid.contains(name), "{name}");
    }
    // Means over the three seeds: 0.02 (1 + 2 + 3) / 3 beside 1 and the wave.
    let flip = figure(folder.path(), "cornell-box-flip-frames.svg");
    let mean = 1.04 + 0.2 * f64::sin(0.64);
    assert!(
        flip.contains(&format!("frame 10: imperfect maps, lights = 64\nꟻLIP: {mean:.3} ± 0.050")),
        "{flip}"
    );
    let page = std::fs::read_to_string(folder.path().join("report.html")).expect("a page");
    let label = flip.split("aria-label=").nth(1).and_then(|rest| rest.split('>').next()).expect("a label");
    assert!(page.contains("<a href=\"#frames\">Frame by frame</a>") && page.contains(label));
    assert!(!folder.path().join("figures/cornell-box-flip-frames-2.svg").exists());
}

#[test]
fn combinations_that_dashes_cannot_tell_apart_are_split() {
    let folder = tempfile::tempdir().expect("a folder");
    study::report(&walk(3), folder.path()).expect("a report");
    // Six combinations of three pipelines: four and two.
    let [first, second] = ["cornell-box-tid-frames.svg", "cornell-box-tid-frames-2.svg"]
        .map(|name| figure(folder.path(), name));
    assert_eq!((curves(&first), curves(&second)), (12, 6));
    let page = std::fs::read_to_string(folder.path().join("report.html")).expect("a page");
    assert!(page.contains("1 to 4 of 6") && page.contains("5 to 6 of 6"));
}

#[test]
fn values_of_one_pipeline_have_colors() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut results = walk(3);
    results.cells.retain(|cell| cell.pipeline == PIPELINES[0]);
    study::report(&results, folder.path()).expect("a report");
    let tid = figure(folder.path(), "cornell-box-tid-frames.svg");
    assert_eq!((tid.matches("class=\"series ").count(), curves(&tid)), (6, 6));
    assert!(tid.contains(">lights = 64, gather.filter = true<"), "{tid}");
}

#[test]
fn long_walks_have_small_marks_or_none() {
    let folder = tempfile::tempdir().expect("a folder");
    for (frames, marks) in [(256, 2 * 255), (258, 0)] {
        let mut results = walk(frames);
        results.cells.truncate(6);
        study::report(&results, folder.path()).expect("a report");
        let tid = figure(folder.path(), "cornell-box-tid-frames.svg");
        assert_eq!(tid.matches("class=\"mark\"").count(), marks, "{frames}");
        assert_eq!(curves(&tid), 2);
    }
}
