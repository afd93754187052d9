//! `lightloom precision`: probes by the interpreter and on the GPU, files of one's own, and what is no probe.

use crate::adapter::{gpu, root};
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

fn precision(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_lightloom"))
        .args(["--json", "--root"])
        .arg(root())
        .args(["precision", "-o"])
        .arg(folder.join("out"))
        .args(["--magnitudes", "5", "--samples", "64"])
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|error| panic!("{error}: {}", String::from_utf8_lossy(&output.stderr)))
}

const LOST: &str = "// A difference that is lost.
struct Given { x: f32 }
fn given(magnitude: f32, u: vec4<f32>) -> Given { return Given(magnitude * (0.5 + 0.5 * u.x)); }
/// [magnitude: 1e-6 to 1e-2, x]
fn probe(given: Given) -> vec4<f32> { return vec4(1.0 - sqrt(1.0 - given.x), 0.0, 0.0, 0.0); }
";

#[test]
fn probes_by_name_are_measured_and_reported() {
    let folder = tempfile::tempdir().unwrap();
    let done = precision(folder.path(), &["spot-caps", "triangles", "--interpret"]);
    let record = json(&done);
    assert_eq!(done.status.code(), Some(0));
    assert_eq!(record["by"], "interpreter");
    let names: Vec<_> = record["probes"].as_array().unwrap().iter().map(|probe| &probe["probe"]).collect();
    assert_eq!(names, ["spot-caps", "triangles"]);
    let page = std::fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    assert!(page.contains("id=\"triangles\""));
    assert!(folder.path().join("out/probes.json").exists());
}

#[test]
fn what_is_lost_fails() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("own.wgsl"), LOST).unwrap();
    let done = precision(folder.path(), &["own.wgsl", "--interpret"]);
    assert_eq!(done.status.code(), Some(1));
    assert_eq!(json(&done)["probes"][0]["holds"], false);
    assert!(String::from_utf8_lossy(&done.stderr).contains("1 of 1 probes exceed their bound"));
}

#[test]
fn names_are_listed_and_misspelt_ones_told() {
    let folder = tempfile::tempdir().unwrap();
    let listed = json(&precision(folder.path(), &["--list"]));
    assert!(listed.as_array().unwrap().iter().any(|probe| probe["name"] == "spot-caps"));
    let misspelt = precision(folder.path(), &["spot-cap"]);
    assert_eq!(misspelt.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&misspelt.stderr).contains("did you mean `spot-caps`"));
    let absent = precision(folder.path(), &["absent.wgsl"]);
    assert!(String::from_utf8_lossy(&absent.stderr).contains("absent.wgsl"));
}

/// Additions and square roots are exact to half a unit everywhere: on the GPU and by the interpreter, the same is lost.
#[test]
fn the_gpu_computes_what_the_interpreter_does() {
    if gpu().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("own.wgsl"), LOST).unwrap();
    let [on_gpu, interpreted] = [&["own.wgsl"][..], &["own.wgsl", "--interpret"]].map(|arguments| {
        let record = json(&precision(folder.path(), arguments));
        let points = record["probes"][0]["points"].as_array().unwrap().clone();
        (
            record["by"].clone(),
            points.iter().map(|p| p["error"]["most"].as_f64().unwrap()).collect::<Vec<_>>(),
        )
    });
    assert_ne!(on_gpu.0, interpreted.0);
    for (a, b) in on_gpu.1.iter().zip(&interpreted.1) {
        // Square roots may be off by two units in the last place on a GPU. [WGSL §15.7.4]
        assert!(*a <= 8.0 * b + 1e-7 && *b <= 8.0 * a + 1e-7, "{a} on the GPU, {b} by the interpreter");
    }
}
