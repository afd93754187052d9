//! The benchmark command: small, but whole.

use crate::adapter::{gpu, root};
use serde_json::Value;
use std::process::{Command, Output};

fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lightloom"));
    command.args(["--root", &root().to_string_lossy(), "bench"]).args(arguments);
    command
}

fn bench(arguments: &[&str]) -> Output {
    command(&["--quick", "--runs", "2"]).args(arguments).output().unwrap()
}

fn text(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

fn json(arguments: &[&str]) -> Value {
    let done = bench(&[arguments, &["--json"]].concat());
    assert!(done.status.success(), "{}", text(&done));
    serde_json::from_slice(&done.stdout).unwrap_or_else(|error| panic!("{error}: {}", text(&done)))
}

fn rows<'a>(json: &'a Value, figure: &str) -> Vec<&'a Value> {
    let rows = json["rows"].as_array().unwrap();
    rows.iter().filter(|row| row["figure"] == figure).collect()
}

/// Every figure is there, is a number, and lies within its spread.
#[test]
fn all_that_can_be_measured_is() {
    if gpu().is_none_or(|gpu| !gpu.has_timestamps()) {
        return;
    }
    let json = json(&[]);
    assert_eq!(json["adapter"], gpu().unwrap().describe());
    let figures = [
        "rays",
        "shadow-maps",
        "samplers",
        "points",
        "ism-frame",
        "compile",
        "encode",
        "memory",
        "value",
        "reload",
        "start",
    ];
    for figure in figures {
        assert!(!rows(&json, figure).is_empty(), "{figure}: {json}");
        assert!(json["notes"][figure].as_str().is_some_and(|note| !note.is_empty()), "{figure}");
    }
    for row in json["rows"].as_array().unwrap() {
        let [least, median, greatest] = ["least", "median", "greatest"].map(|key| row[key].as_f64().unwrap());
        assert!(least <= median && median <= greatest && greatest.is_finite(), "{row}");
        // A pass may take no step at all.
        assert!(least > 0.0 || row["figure"] == "ism-frame", "{row}");
        assert!(row["goal"].is_null() && row["met"].is_null(), "goals are for whole sizes: {row}");
    }
    // The frame is what its passes add up to, in one run; medians of two are means.
    let frame = rows(&json, "ism-frame");
    let sum: f64 = frame[1..].iter().map(|row| row["median"].as_f64().unwrap()).sum();
    assert!((sum / frame[0]["median"].as_f64().unwrap() - 1.0).abs() < 1e-6, "{frame:?}");
}

/// Both kinds of search find the same, and what is counted is what the scenes say.
#[test]
fn rays_are_counted() {
    if gpu().is_none_or(|gpu| !gpu.has_timestamps()) {
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

/// What is counted needs no adapter, and says which pipelines there are.
#[test]
fn memory_is_that_of_every_pipeline() {
    let json = json(&["--only", "memory"]);
    assert!(json["adapter"].is_null());
    let rows = rows(&json, "memory");
    let listed = Command::new(env!("CARGO_BIN_EXE_lightloom"))
        .args(["--root", &root().to_string_lossy(), "pipelines", "--json"])
        .output()
        .unwrap();
    let listed: Value = serde_json::from_slice(&listed.stdout).unwrap();
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

#[test]
fn tables_are_for_people_and_pages() {
    let done = bench(&["--only", "memory"]);
    let said = text(&done);
    assert!(done.status.success() && said.starts_with("what"), "{said}");
    assert!(said.contains("transients of ism, ") && said.contains("\nmemory: "), "{said}");
    let done = bench(&["--only", "memory", "--markdown"]);
    let said = text(&done);
    let table: Vec<&str> = said.lines().filter(|line| line.starts_with('|')).collect();
    assert!(done.status.success() && table.len() > 3, "{said}");
    assert_eq!(table[1], "|---|---|---|---|---|");
    assert!(table.iter().all(|line| line.matches('|').count() == 6), "{said}");
}

#[test]
fn mistakes_are_told() {
    let cases: [(&[&str], i32, &str); 4] = [
        (&["--only", "ray"], 2, "rays"),
        (&["--runs", "0"], 2, "1..=1000000"),
        (&["--markdown", "--json"], 2, "--json"),
        (&["--only", "ism-frame", "--scene", "atrum"], 1, "atrium"),
    ];
    let needs_gpu = |code| code == 1;
    for (arguments, code, word) in cases.iter().filter(|(_, code, _)| !needs_gpu(*code) || gpu().is_some()) {
        let done = command(arguments).output().unwrap();
        assert_told(&done, *code, word);
    }
    // The environment hides every adapter.
    let done = command(&["--only", "encode"]).env("WGPU_ADAPTER_NAME", "an adapter that nobody has").output();
    assert_told(&done.unwrap(), 1, "no graphics adapter");
}

fn assert_told(done: &Output, code: i32, word: &str) {
    assert_eq!(done.status.code(), Some(code), "{}", text(done));
    assert!(text(done).contains(word) && !text(done).contains("panicked"), "{}", text(done));
}
