//! The benchmark command: small, but whole.

use crate::adapter::{gpu, root};
use crate::program::{Done, command_of_tree, lightloom};
use serde_json::Value;
use std::process::Command;

fn command(arguments: &[&str]) -> Command {
    let mut command = command_of_tree(&root());
    command.arg("bench").args(arguments);
    command
}

fn bench(arguments: &[&str]) -> Done {
    Done::of(command(&["--quick", "--runs", "2"]).args(arguments)).success()
}

fn json(arguments: &[&str]) -> Value {
    bench(&[arguments, &["--json"]].concat()).json()
}

fn has_timestamps() -> bool {
    gpu().is_some_and(|gpu| gpu.has_timestamps())
}

/// Returns three numbers of a row that rise: its least, median and greatest value.
fn spread(row: &Value) -> [f64; 3] {
    let spread = ["least", "median", "greatest"].map(|key| row[key].as_f64().unwrap());
    assert!(spread.is_sorted() && spread[2].is_finite(), "{row}");
    spread
}

fn rows<'a>(json: &'a Value, figure: &str) -> Vec<&'a Value> {
    let rows = json["rows"].as_array().unwrap();
    rows.iter().filter(|row| row["figure"] == figure).collect()
}

/// Every figure is there, is a number, and lies within its spread.
#[test]
#[ignore = "slow"]
fn all_that_can_be_measured_is() {
    if !has_timestamps() {
        return;
    }
    let json = json(&[]);
    assert_eq!(json["adapter"], gpu().unwrap().describe());
    let of_gpu = ["rays", "shadow-maps", "samplers", "points", "ism-frame"];
    let of_cpu = ["compile", "encode", "memory", "value", "reload", "start"];
    for figure in of_gpu.into_iter().chain(of_cpu) {
        assert!(!rows(&json, figure).is_empty(), "{figure}: {json}");
        assert!(json["notes"][figure].as_str().is_some_and(|note| !note.is_empty()), "{figure}");
    }
    for row in json["rows"].as_array().unwrap() {
        // A pass may take no step at all.
        assert!(spread(row)[0] > 0.0 || row["figure"] == "ism-frame", "{row}");
        assert!(row["goal"].is_null() && row["met"].is_null(), "goals are for whole sizes: {row}");
    }
    // The frame is what its passes add up to, in one run, without and with that of stored points; medians of two are means.
    let frame = rows(&json, "ism-frame");
    let median = |row: &Value| row["median"].as_f64().unwrap();
    let sum: f64 = frame[2..].iter().map(|row| median(row)).sum();
    let points = frame.iter().find(|row| row["name"] == "ism: shadows/points").expect("points are stored");
    for (found, sum) in [(median(frame[0]), sum - median(points)), (median(frame[1]), sum)] {
        assert!((sum / found - 1.0).abs() < 1e-6, "{frame:?}");
    }
}

/// Both kinds of search find the same, and what is counted is what the scenes say.
#[test]
fn rays_are_counted() {
    if !has_timestamps() {
        return;
    }
    let json = json(&["--only", "rays", "--scene", "plane"]);
    let rows = rows(&json, "rays");
    let count = |name: &str, key: &str| -> u64 {
        let row = rows.iter().find(|row| row["name"] == name).unwrap_or_else(|| panic!("{name} in {rows:?}"));
        row["counts"][key].as_u64().unwrap()
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
    let json = json(&["--only", "memory"]);
    assert!(json["adapter"].is_null());
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
        assert_eq!(pair[0]["name"], format!("{name}, sort by sort"));
        let [shared, reachable, bound, unshared] = ["shared", "reachable_bound", "bound", "unshared"]
            .map(|key| pair[0]["counts"][key].as_u64().unwrap());
        assert!(0 < bound && bound <= reachable && reachable <= shared && shared <= unshared, "{pair:?}");
        for (row, bound) in pair.iter().zip([reachable, bound]) {
            // JSON is read to the last bit but one.
            let ratio = shared as f64 / bound as f64;
            assert!((row["median"].as_f64().unwrap() - ratio).abs() < 1e-12 * ratio, "{row}");
        }
    }
}

/// Every ceiling is a rate, and each pass of each frame has what it must do, a bound, and the ceiling that sets it.
#[test]
fn passes_are_held_against_ceilings() {
    if !has_timestamps() {
        return;
    }
    let json = json(&["--roofline"]);
    assert_eq!(json["adapter"], gpu().unwrap().describe());
    assert!(json["note"].as_str().is_some_and(|note| note.contains("atrium")), "{json}");
    let ceilings = json["ceilings"].as_array().unwrap();
    let names = ["copy", "load", "store", "load-words", "atomics", "atomics-of-one", "threads", "barriers"];
    let more = ["multiplications", "dispatches", "load-texels", "store-texels", "fragments", "triangles"];
    for name in names.into_iter().chain(more) {
        assert!(ceilings.iter().any(|ceiling| ceiling["name"] == name), "{name}: {json}");
    }
    for ceiling in ceilings {
        assert!(spread(ceiling)[0] > 0.0, "{ceiling}");
    }
    let frames = json["frames"].as_array().unwrap();
    assert_eq!(frames.len(), 3);
    for frame in frames {
        for pass in frame["passes"].as_array().unwrap() {
            let at_least = pass["at_least"].as_f64().unwrap();
            assert!(0.0 < at_least && at_least.is_finite(), "{pass}");
            let bound_by = pass["bound_by"].as_str().unwrap();
            assert_eq!(pass["at_least_by_count"][bound_by].as_f64().unwrap(), at_least, "{pass}");
            let counts = pass["counts"].as_object().unwrap();
            let most = pass["at_least_by_count"].as_object().unwrap().values().filter_map(Value::as_f64);
            assert_eq!(most.fold(0.0, f64::max), at_least, "{pass}");
            assert!(counts.values().all(|count| count.as_u64().is_some_and(|count| count > 0)), "{pass}");
        }
        // What a frame takes beyond its bound is what the table shows; below it can only be noise, as where other tests
        // run while passes are timed. Single passes of microseconds are within that noise altogether.
        let [time, at_least] = ["median", "at_least"].map(|key| frame[key].as_f64().unwrap());
        assert!(0.0 < at_least && at_least <= NOISE * time, "{frame}");
    }
    // The settings of a quick run give eight maps of 32², of a quarter of a point for each texel of the disc.
    let count = |frame: usize, pass: &str, key: &str| -> u64 {
        let passes = frames[frame]["passes"].as_array().unwrap();
        let pass = passes.iter().find(|known| known["name"] == pass).unwrap_or_else(|| panic!("{pass}"));
        pass["counts"][key].as_u64().unwrap()
    };
    let points = 201 * 8;
    assert_eq!(count(1, "shadows/splat", "threads"), u64::next_multiple_of(points, 64) + 8 * 32 * 32 / 4);
    assert_eq!(count(1, "shadows/splat", "dispatches"), 2);
    assert!((1..=8 * 32 * 32).contains(&count(1, "shadows/splat", "atomics")));
    assert_eq!(count(1, "shadows/fill", "texel_stores"), 8 * 32 * 32);
    let triangles = count(2, "view", "triangles");
    assert_eq!(count(2, "shadows", "triangles"), 8 * triangles);
    // Each texel's depth and normal are read once, and what is lit is written: four, sixteen and eight bytes at least.
    assert!(count(0, "gather", "bytes") > 32 * 32 * (4 + 8 + 16));
}

/// A frame may seem this many times shorter than its bound where two cores do other work now and then.
const NOISE: f64 = 2.0;

#[test]
fn tables_are_for_people_and_pages() {
    let done = bench(&["--only", "memory"]).says(&["transients of ism, ", "\nmemory: "]);
    assert!(done.out.starts_with("what"), "{done}");
    let done = bench(&["--only", "memory", "--markdown"]);
    let table: Vec<&str> = done.out.lines().filter(|line| line.starts_with('|')).collect();
    assert!(table.len() > 3, "{done}");
    assert_eq!(table[1], "|---|---|---|---|---|");
    assert!(table.iter().all(|line| line.matches('|').count() == 6), "{done}");
}

/// The roofline has a table of ceilings and one for each frame, in columns and as Markdown.
#[test]
#[ignore = "slow"]
fn rooflines_are_for_people_and_pages() {
    if !has_timestamps() {
        return;
    }
    let words = ["\nism-classic, 8 maps of 32², ", "\nshadows/splat ", " atomics, "];
    let done = bench(&["--roofline"]).says(&words);
    assert!(done.out.starts_with("ceiling "), "{done}");
    let done = bench(&["--roofline", "--markdown"]);
    assert_eq!(done.out.lines().filter(|line| line.starts_with("|---")).count(), 4, "{done}");
}

#[test]
fn mistakes_are_reported() {
    let cases: [(&[&str], i32, &str); 5] = [
        (&["--only", "ray"], 2, "rays"),
        (&["--runs", "0"], 2, "1..=1000000"),
        (&["--markdown", "--json"], 2, "--json"),
        (&["--roofline", "--only", "rays"], 2, "--only"),
        (&["--only", "ism-frame", "--scene", "atrum"], 1, "atrium"),
    ];
    let needs_gpu = |code| code == 1;
    for (arguments, code, word) in cases.iter().filter(|(_, code, _)| !needs_gpu(*code) || gpu().is_some()) {
        Done::of(&mut command(arguments)).failure(*code, &[word]);
    }
    // The environment hides every adapter.
    let mut command = command(&["--only", "encode"]);
    command.env("WGPU_ADAPTER_NAME", "an adapter that nobody has");
    Done::of(&mut command).failure(1, &["no graphics adapter"]);
}
