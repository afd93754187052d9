//! The benchmark command: small, but whole.

use crate::adapter::{gpu, root};
use crate::program::{Done, command_of_tree, lightloom};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

fn command(out: &Path, arguments: &[&str]) -> Command {
    let mut command = command_of_tree(&root());
    command.args(["bench", "-o"]).arg(out).args(arguments);
    command
}

fn json(arguments: &[&str]) -> Value {
    json_and_notes(arguments).0
}

/// Returns what is printed as JSON, and the note on each figure by its name.
fn json_and_notes(arguments: &[&str]) -> (Value, BTreeMap<String, String>) {
    let folder = tempfile::tempdir().unwrap();
    let mut command = command(folder.path(), &["--quick", "--runs", "2", "--json"]);
    let json = Done::of(command.args(arguments)).success().json();
    let study = std::fs::read_to_string(folder.path().join("study.json")).unwrap();
    let study: Value = serde_json::from_str(&study).unwrap();
    let text = |value: &Value| value.as_str().unwrap().to_owned();
    let figures = study["scenes"].as_array().unwrap().iter();
    let notes = figures.map(|figure| (text(&figure["name"]), text(&figure["about"])));
    (json, notes.collect())
}

fn has_timestamps() -> bool {
    gpu().is_some_and(|gpu| gpu.has_timestamps())
}

/// Returns the value of a row.
fn median(row: &Value) -> f64 {
    row["measures"].as_object().unwrap().values().find_map(Value::as_f64).unwrap()
}

/// Returns three numbers of a row that rise: its least, median and greatest value.
fn spread(row: &Value) -> [f64; 3] {
    let [least, greatest] = ["least", "greatest"].map(|key| row["details"][key].as_f64().unwrap());
    let spread = [least, median(row), greatest];
    assert!(spread.is_sorted() && spread[2].is_finite(), "{row}");
    spread
}

fn rows<'a>(json: &'a Value, figure: &str) -> Vec<&'a Value> {
    let rows = json["records"].as_array().unwrap();
    rows.iter().filter(|row| row["scene"] == figure).collect()
}

/// Every figure is there, is a number, and lies within its spread.
#[test]
#[ignore = "slow"]
fn all_that_can_be_measured_is() {
    if !has_timestamps() {
        return;
    }
    let (json, notes) = json_and_notes(&[]);
    assert_eq!(json["adapter"], gpu().unwrap().describe());
    for figure in ["rays", "compile", "encode", "memory", "value", "reload", "start", "roofline"] {
        assert!(!rows(&json, figure).is_empty(), "{figure}: {json}");
        assert!(!notes[figure].is_empty(), "{figure}");
    }
    for row in json["records"].as_array().unwrap() {
        // A pass of the roofline may take no step at all.
        assert!(spread(row)[0] > 0.0 || row["scene"] == "roofline", "{row}");
    }
    let findings = json["findings"].as_array().unwrap();
    assert!(
        findings.iter().all(|finding| finding["scenes"][0] == "roofline"),
        "goals are for whole sizes: {json}"
    );
}

/// Both kinds of search find the same, and what is counted is what the scenes say.
#[test]
fn rays_are_counted() {
    if !has_timestamps() {
        return;
    }
    let json = json(&["rays", "--scene", "plane"]);
    let rows = rows(&json, "rays");
    let count = |name: &str, key: &str| -> u64 {
        let row =
            rows.iter().find(|row| row["pipeline"] == name).unwrap_or_else(|| panic!("{name} in {rows:?}"));
        row["details"]["counts"][key].as_u64().unwrap()
    };
    for scene in ["cornell-box", "atrium", "plane"] {
        let camera = format!("closest hit, camera rays, {scene}");
        let surface = format!("closest hit, diffuse rays, {scene}");
        assert_eq!(count(&camera, "rays"), 32 * 32, "one a pixel");
        assert_eq!(
            count(&surface, "rays"),
            count(&camera, "hits"),
            "{scene}: one from each surface that is seen"
        );
        for rays in ["camera", "diffuse"] {
            for key in ["rays", "hits"] {
                let [closest, any] =
                    ["closest", "any"].map(|what| count(&format!("{what} hit, {rays} rays, {scene}"), key));
                assert_eq!(closest, any, "{scene}: {key} of {rays} rays");
            }
        }
    }
    assert_eq!(count("closest hit, diffuse rays, plane", "hits"), 0, "nothing stands on the plane");
    let (rays, hits) = (
        count("closest hit, diffuse rays, cornell-box", "rays"),
        count("closest hit, diffuse rays, cornell-box", "hits"),
    );
    assert!(rays / 2 < hits && hits < rays, "most stay in the box, some leave it: {hits} of {rays}");
}

/// Counts need no adapter, and name all pipelines.
#[test]
fn memory_is_that_of_every_pipeline() {
    let json = json(&["memory"]);
    assert_eq!(json["adapter"], "");
    let rows = rows(&json, "memory");
    let listed = lightloom(&["pipelines", "--json"]).json();
    let names: Vec<String> = listed
        .as_array()
        .unwrap()
        .iter()
        .map(|pipeline| format!("transients of {}", pipeline["name"].as_str().unwrap()))
        .collect();
    // A row against each of two bounds.
    assert_eq!(rows.len(), 2 * names.len());
    for (pair, name) in rows.chunks(2).zip(names) {
        assert_eq!(pair[0]["pipeline"], format!("{name}, sort by sort"));
        let [shared, reachable, bound, unshared] = ["shared", "reachable_bound", "bound", "unshared"]
            .map(|key| pair[0]["details"]["counts"][key].as_u64().unwrap());
        assert!(0 < bound && bound <= reachable && reachable <= shared && shared <= unshared, "{pair:?}");
        for (row, bound) in pair.iter().zip([reachable, bound]) {
            assert_eq!(Some(median(row)), Some(shared as f64 / bound as f64), "{row}");
        }
    }
}

/// Every ceiling is a rate, and each pass of each frame has what it must do, a bound, and what sets it.
#[test]
fn passes_are_held_against_ceilings() {
    if !has_timestamps() {
        return;
    }
    let (json, notes) = json_and_notes(&["roofline"]);
    assert_eq!(json["adapter"], gpu().unwrap().describe());
    assert!(notes["roofline"].contains("atrium"), "{notes:?}");
    let rows = rows(&json, "roofline");
    let name = |row: &Value| row["pipeline"].as_str().unwrap().to_owned();
    let frames = rows.iter().position(|row| row["details"]["from"] == "all passes").expect("a frame");
    let (ceilings, frames) = rows.split_at(frames);
    for what in [
        "copy of a buffer",
        "buffer load in order",
        "buffer store in order",
        "loads of 4 B anywhere",
        "atomic minima anywhere",
        "atomic minima of one word",
        "threads that do nothing",
        "threads at a barrier",
        "multiplications with additions",
        "dispatches of one workgroup",
        "texels loaded",
        "texels stored",
        "fragments",
        "triangles of a third",
    ] {
        assert!(ceilings.iter().any(|ceiling| name(ceiling).starts_with(what)), "{what}: {json}");
    }
    for ceiling in ceilings {
        assert!(spread(ceiling)[0] > 0.0, "{ceiling}");
    }
    let wholes: Vec<&Value> =
        frames.iter().copied().filter(|row| row["details"]["from"] == "all passes").collect();
    assert_eq!(wholes.len(), 3);
    for row in frames {
        let at_least = at_least(&json, &name(row));
        assert!(0.0 < at_least && at_least.is_finite(), "{row}");
        let counts = row["details"]["counts"].as_object().unwrap();
        assert!(counts.values().all(|count| count.as_u64().is_some_and(|count| count > 0)), "{row}");
        assert!(
            row["details"]["from"] == "all passes"
                || counts.contains_key(row["details"]["from"].as_str().unwrap()),
            "{row}"
        );
    }
    for whole in &wholes {
        // What a frame takes beyond its bound is what the table shows; below it can only be noise, as where other tests
        // run while passes are timed. Single passes of microseconds are within that noise altogether.
        let (time, at_least) = (median(whole), at_least(&json, &name(whole)));
        assert!(at_least <= NOISE * time, "{whole}");
    }
    // The settings of a quick run give eight maps of 32², of a quarter of a point for each texel of the disc.
    let count = |frame: usize, pass: &str, key: &str| -> u64 {
        let pass = format!("{}: {pass}", name(wholes[frame]));
        let row = frames.iter().find(|row| name(row) == pass).unwrap_or_else(|| panic!("{pass}"));
        row["details"]["counts"][key].as_u64().unwrap()
    };
    let points = 201 * 8;
    assert_eq!(count(1, "shadows/splat", "threads"), u64::next_multiple_of(points, 64) + 8 * 32 * 32 / 4);
    assert_eq!(count(1, "shadows/splat", "dispatches"), 2);
    assert!((1..=8 * 32 * 32).contains(&count(1, "shadows/splat", "atomics")));
    assert_eq!(count(1, "shadows/fill", "texels stored"), 8 * 32 * 32);
    let triangles = count(2, "view", "triangles");
    assert_eq!(count(2, "shadows", "triangles"), 8 * triangles);
    // Each texel's depth and normal are read once, and what is lit is written: four, sixteen and eight bytes at least.
    assert!(count(0, "gather", "bytes moved") > 32 * 32 * (4 + 8 + 16));
}

/// Returns what a row can take at least.
fn at_least(json: &Value, row: &str) -> f64 {
    let bounds =
        json["findings"].as_array().unwrap().iter().map(|finding| &finding["claim"]["relation"]["bound"]);
    let bound = bounds.clone().find(|bound| bound["of"]["pipeline"] == row);
    bound.unwrap_or_else(|| panic!("{row}: {json}"))["at_least"].as_f64().unwrap()
}

/// A frame may seem this many times shorter than its bound where two cores do other work now and then.
const NOISE: f64 = 2.0;

#[test]
fn tables_are_for_people_and_pages() {
    let folder = tempfile::tempdir().unwrap();
    let done = Done::of(command(folder.path(), &["memory", "--quick"]).args(["--runs", "2"])).success();
    let done = done.says(&["transients of ism, ", "\n- `memory`: ", "report.html"]);
    assert!(done.out.starts_with("what"), "{done}");
    let read = |file: &str| std::fs::read_to_string(folder.path().join(file)).unwrap();
    let table = read("tables/Figures.md");
    let table: Vec<&str> = table.lines().filter(|line| line.starts_with('|')).collect();
    assert!(table.len() > 3, "{done}");
    assert_eq!(table[1], "| --- | --- | --- | --- | --- | --- |");
    assert!(table.iter().all(|line| line.matches('|').count() == 7), "{done}");
    assert!(read("report.html").contains("<h3>Figures</h3>"));
    assert!(read("cells.csv").contains("memory,\"transients of ism, sort by sort\""));
}

#[test]
fn mistakes_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let command = |arguments: &[&str]| command(folder.path(), arguments);
    let cases: [(&[&str], i32, &str); 3] = [
        (&["ray"], 1, "rays"),
        (&["--runs", "0"], 2, "1..=1000000"),
        (&["rays", "--scene", "atrum"], 1, "atrium"),
    ];
    let needs_gpu = |code| code == 1;
    for (arguments, code, word) in cases.iter().filter(|(_, code, _)| !needs_gpu(*code) || gpu().is_some()) {
        Done::of(&mut command(arguments)).failure(*code, &[word]);
    }
    // The environment hides every adapter.
    let mut command = command(&["encode"]);
    command.env("WGPU_ADAPTER_NAME", "an adapter that nobody has");
    Done::of(&mut command).failure(1, &["no graphics adapter"]);
}
