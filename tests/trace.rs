//! What `--trace` writes, read as a program that draws it does.

use crate::adapter::{gpu, root};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;
use std::process::{Command, Output};

fn lightloom(arguments: &[&str], trace: &Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lightloom"));
    command.args(arguments).arg("--trace").arg(trace).current_dir(root()).output().unwrap()
}

/// The spans of a trace, each as `outer/inner`, having checked that each ends where it began.
fn spans(trace: &Path) -> BTreeSet<String> {
    let text = std::fs::read_to_string(trace).unwrap();
    let events: Vec<Value> = serde_json::from_str(&text).unwrap();
    let mut spans = BTreeSet::new();
    let threads: BTreeSet<u64> = events.iter().map(|event| event["tid"].as_u64().unwrap()).collect();
    for thread in threads {
        let mut open: Vec<&str> = Vec::new();
        let mut time = 0.0;
        for event in events.iter().filter(|event| event["tid"] == thread && event["ph"] != "M") {
            let now = event["ts"].as_f64().unwrap();
            assert!(now >= time, "{event} after {time}");
            time = now;
            let name = event["name"].as_str().unwrap();
            match event["ph"].as_str().unwrap() {
                "B" => {
                    open.push(name);
                    spans.insert(open.join("/"));
                }
                "E" => assert_eq!(open.pop(), Some(name)),
                other => panic!("an event of type {other}"),
            }
        }
        assert!(open.is_empty(), "{open:?} do not end");
    }
    spans
}

#[test]
fn a_trace_without_a_gpu_has_the_phases() {
    let folder = tempfile::tempdir().unwrap();
    let trace = folder.path().join("graph.json");
    let done = lightloom(&["graph", "ism-invtm"], &trace);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let spans = spans(&trace);
    assert!(spans.contains("shaders validated and reflected"), "{spans:#?}");

    // Also where the command fails, and without spans.
    let done = lightloom(&["graph", "no-such-pipeline"], &trace);
    assert_eq!(done.status.code(), Some(1));
    assert!(serde_json::from_str::<Vec<Value>>(&std::fs::read_to_string(&trace).unwrap()).is_ok());
}

#[test]
fn a_trace_of_frames_names_their_passes() {
    if gpu().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let (trace, picture) = (folder.path().join("render.json"), folder.path().join("box.png"));
    let arguments = ["render", "ism-invtm", "cornell-box", "--frames", "2", "--size", "24x16", "-o"];
    let small = ["--set", "lights=32", "--set", "rsm.size=32"];
    let done = lightloom(&[&arguments[..], &[picture.to_str().unwrap()], &small].concat(), &trace);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let spans = spans(&trace);
    for span in ["pose and upload", "shadows/splat", "gather", "submit"] {
        let span = format!("frames/frame/{span}");
        assert!(spans.contains(&span), "{span} is missing: {spans:#?}");
    }
}

#[test]
fn a_trace_that_cannot_be_written_is_said_before_anything_is_done() {
    let trace = Path::new("no-such-folder/trace.json");
    let done = lightloom(&["scenes"], trace);
    assert_eq!(done.status.code(), Some(1));
    assert!(done.stdout.is_empty());
    let said = String::from_utf8_lossy(&done.stderr);
    assert!(said.contains("no-such-folder/trace.json cannot be written"), "{said}");
}
