//! `lightloom stress`: extremes hold, and what does not is told.

use crate::adapter::{gpu, root};
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

fn stress(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_lightloom"))
        .args(["--json", "--root"])
        .arg(root())
        .args(["stress", "-o"])
        .arg(folder.join("out"))
        .args(["--size", "24x24", "--samples", "32"])
        .args(["--set", "lights=64", "--set", "map=16", "--set", "rsm.size=32"])
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

fn cells(output: &Output) -> Vec<Value> {
    let json: Value = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|error| panic!("{error}: {}", String::from_utf8_lossy(&output.stderr)));
    json["cells"].as_array().unwrap().clone()
}

/// Of each kind of extreme those that were wrong once, and that take little time.
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
    if gpu().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let cases: Vec<&str> = CASES.iter().flat_map(|case| ["--case", case]).collect();
    let done = stress(folder.path(), &[&["--pipeline", "ism-invtm"], &*cases].concat());
    let cells = cells(&done);
    assert_eq!(cells.len(), CASES.len());
    for cell in &cells {
        assert_eq!(cell["verdict"], "held", "{cell:#}");
    }
    assert_eq!(done.status.code(), Some(0));
    let page = std::fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    assert!(CASES.iter().all(|case| page.contains(&format!(">{case}<"))), "{page}");
}

/// A bound on what lights give near them keeps to the room that lies far from a block, and to what many lights see.
#[test]
fn bounds_are_those_of_what_is_seen() {
    if gpu().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    for (pipeline, case) in [("instant-radiosity", "far-block"), ("ism-uniform", "lights-256")] {
        let cells = cells(&stress(folder.path(), &["--pipeline", pipeline, "--case", case]));
        let energy = cells[0]["energy"].as_f64().unwrap();
        assert!((energy - 1.0).abs() < 0.2, "{pipeline}, {case}: {:#}", cells[0]);
    }
}

/// What the program says of a refusal is the reason, not how it is written for programs.
#[test]
fn refusals_are_told_with_their_reason() {
    if gpu().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let cells = cells(&stress(folder.path(), &["--pipeline", "ism-invtm", "--case", "intensity-1e37"]));
    assert_eq!(cells[0]["verdict"], "refused", "{:#}", cells[0]);
    let message = cells[0]["message"].as_str().unwrap();
    assert!(message.contains("10³⁰") && !message.contains('{'), "{message}");
}

#[test]
fn what_does_not_hold_is_told_with_the_command_that_shows_it() {
    if gpu().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write(
        "nan.wgsl",
        "var picture: texture_2d<f32>;\n@fragment\nfn nan(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {\n    \
         let texel = textureLoad(picture, vec2<u32>(at.xy), 0);\n    \
         return vec4(bitcast<f32>(0x7fc00000u + u32(texel.a)));\n}\n",
    );
    write(
        "nan.ron",
        "Pipeline(extends: \"ism.ron\", patch: [Insert(name: \"nan\", pass: Pass(kind: \"fullscreen\", shader: \"nan.wgsl\", \
         out: { \"result\": Out(interface: \"Radiance\") }), between: (\"image.image\", \"out.image\"))])",
    );
    write("broken.ron", "Pipeline(");
    let done = stress(folder.path(), &["--pipeline", "nan.ron", "--case", "plain", "--case", "no-light"]);
    assert_eq!(done.status.code(), Some(1), "{}", String::from_utf8_lossy(&done.stderr));
    let cells = cells(&done);
    assert_eq!(cells[0]["verdict"], "not-finite", "{cells:#?}");
    let command = cells[0]["command"].as_str().unwrap();
    assert!(command.starts_with("lightloom render nan.ron ") && command.contains("plain.ron"), "{command}");
    let broken = stress(folder.path(), &["--pipeline", "broken.ron"]);
    assert_eq!(broken.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&broken.stderr).contains("broken.ron:1"));
    let misspelt = stress(folder.path(), &["--case", "no-lihgt"]);
    assert!(String::from_utf8_lossy(&misspelt.stderr).contains("did you mean `no-light`"));
}
