//! The file of `--trace`, read as a program that draws it does.

use crate::program::{Done, Folder, command};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;

fn lightloom(arguments: &[&str], trace: &Path) -> Done {
    Done::of(command(&crate::adapter::root()).args(arguments).arg("--trace").arg(trace))
}

/// Returns the spans of a trace, each as `outer/inner`, having checked that each ends where it began.
fn spans(folder: &Folder) -> BTreeSet<String> {
    let events: Vec<Value> = serde_json::from_str(&folder.read("trace.json")).unwrap();
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
    let folder = Folder::new(&[]);
    lightloom(&["graph", "ism-invtm"], &folder.at("trace.json")).success();
    let spans = spans(&folder);
    assert!(spans.contains("shaders validated and reflected"), "{spans:#?}");

    // Also where the command fails, and without spans.
    lightloom(&["graph", "no-such-pipeline"], &folder.at("trace.json")).failure(1, &[]);
    assert!(serde_json::from_str::<Vec<Value>>(&folder.read("trace.json")).is_ok());
}

#[test]
fn a_trace_of_frames_names_their_passes() {
    let Some(folder) = Folder::with_gpu(&[]) else { return };
    let arguments = ["render", "ism-invtm", "cornell-box", "--frames", "2", "--size", "24x16", "-o"];
    let small = ["--set", "lights=32", "--set", "rsm.size=32"];
    let picture = folder.name("box.png");
    let arguments = [&arguments[..], &[&picture], &small].concat();
    lightloom(&arguments, &folder.at("trace.json")).success();
    let spans = spans(&folder);
    for span in ["pose and upload", "shadows/splat", "gather", "submit"] {
        let span = format!("frames/frame/{span}");
        assert!(spans.contains(&span), "{span} is missing: {spans:#?}");
    }
}

#[test]
fn a_trace_that_cannot_be_written_is_reported_before_anything_is_done() {
    let done = lightloom(&["scenes"], Path::new("no-such-folder/trace.json"));
    let done = done.failure(1, &["no-such-folder/trace.json cannot be written"]);
    assert!(done.out.is_empty());
}
