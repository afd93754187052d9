//! `lightloom stress`: extremes hold, and failures are reported.

use crate::program::{Done, Folder, command_of_tree};
use serde_json::Value;

fn stress(folder: &Folder, arguments: &[&str]) -> Done {
    let settings = ["--set", "lights=64", "--set", "map=16", "--set", "rsm.size=32"];
    let mut command = command_of_tree(folder);
    command.args(["stress", "--json", "-o", "out", "--size", "24x24", "--samples", "32"]).args(settings);
    Done::of(command.args(arguments))
}

/// Returns what is said of the cells that have a verdict.
fn cells(done: &Done) -> Vec<Value> {
    let json = done.json();
    let details = json["records"].as_array().unwrap().iter().map(|record| record["details"].clone());
    details.filter(|details| details["verdict"].is_string()).collect()
}

/// Quick cases of each type of extreme, all of which were wrong once.
const CASES: &[&str] = &[
    "scale-1e6",
    "far-1e6",
    "intensity-1e9",
    "intensity-1e-30",
    "no-light",
    "light-away",
    "cone-90",
    "cone-0.01",
    "near-1e-7",
    "no-triangle",
    "degenerate",
    "frame-1x1",
    "frame-2x2",
    "step-0",
];

#[test]
fn extremes_hold() {
    let Some(folder) = Folder::with_gpu(&[]) else { return };
    let done = stress(&folder, &[&["--pipeline", "ism-invtm"], CASES].concat());
    let cells = cells(&done.success());
    assert_eq!(cells.len(), CASES.len());
    for cell in &cells {
        assert_eq!(cell["verdict"], "held", "{cell:#}");
    }
    let page = folder.read("out/report.html");
    assert!(CASES.iter().all(|case| page.contains(&format!(">{case}<"))), "{page}");
}

/// A bound on what lights give near them keeps to the room that lies far from a block, and to what many lights see.
#[test]
fn bounds_are_those_of_what_is_seen() {
    let Some(folder) = Folder::with_gpu(&[]) else { return };
    for (pipeline, case) in [("instant-radiosity", "far-block"), ("ism-uniform", "lights-256")] {
        let cells = cells(&stress(&folder, &["--pipeline", pipeline, case]));
        let energy = cells[0]["energy"].as_f64().unwrap();
        assert!((energy - 1.0).abs() < 0.2, "{pipeline}, {case}: {:#}", cells[0]);
    }
}

/// The message of a refusal is its reason, not its JSON.
#[test]
fn refusals_are_reported_with_their_reason() {
    let Some(folder) = Folder::with_gpu(&[]) else { return };
    let cells = cells(&stress(&folder, &["--pipeline", "ism-invtm", "intensity-1e37"]));
    assert_eq!(cells[0]["verdict"], "refused", "{:#}", cells[0]);
    let message = cells[0]["message"].as_str().unwrap();
    assert!(message.contains("10³⁰") && !message.contains('{'), "{message}");
}

#[test]
fn failures_are_reported_with_the_command_that_shows_them() {
    let shader = "var picture: texture_2d<f32>;\n@fragment\nfn nan(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {\n    \
         let texel = textureLoad(picture, vec2<u32>(at.xy), 0);\n    \
         return vec4(bitcast<f32>(0x7fc00000u + u32(texel.a)));\n}\n";
    let pipeline = "Pipeline(extends: \"ism.ron\", patch: [Insert(name: \"nan\", pass: Pass(kind: \"fullscreen\", shader: \"nan.wgsl\", \
         out: { \"result\": Out(interface: \"Radiance\") }), between: (\"image.image\", \"out.image\"))])";
    let files = [("nan.wgsl", shader), ("nan.ron", pipeline), ("broken.ron", "Pipeline(")];
    let Some(folder) = Folder::with_gpu(&files) else { return };
    let done = stress(&folder, &["--pipeline", "nan.ron", "plain", "no-light"]);
    let cells = cells(&done.failure(1, &[]));
    assert_eq!(cells[0]["verdict"], "not-finite", "{cells:#?}");
    let command = cells[0]["command"].as_str().unwrap();
    assert!(command.starts_with("lightloom render nan.ron ") && command.contains("plain.ron"), "{command}");
    stress(&folder, &["--pipeline", "broken.ron"]).failure(1, &["broken.ron:1"]);
    stress(&folder, &["no-lihgt"]).says(&["did you mean `no-light`"]);
}
