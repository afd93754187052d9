//! Reports about files by commands that need no GPU, to users and to programs.

use crate::adapter::root;
use crate::program::{Folder, command, lightloom, run_in};
use serde_json::Value;
use std::process::Stdio;

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

const REMOVED: &str = "Pipeline(extends: \"ism.ron\", patch: [Remove(\"filter\")])";

#[test]
fn the_losses_by_a_removed_pass_are_reported() {
    let mine = Folder::new(&[("rm.ron", REMOVED)]);
    let words =
        ["warning[W001]", "`image` is left without its input `indirect`", "the output `irradiance` is lost"];
    run_in(&mine, &["check", "rm.ron", "--scene", "cornell-box"]).success().says(&words);
    run_in(&mine, &["diff", "ism", "rm.ron"]).says(&["- link image.indirect", "- output irradiance"]);
    let shown = run_in(&mine, &["pipelines", "rm.ron"]).out;
    let outputs = shown.lines().find(|line| line.starts_with("outputs:")).unwrap_or_default();
    assert!(outputs.contains("indirect") && !outputs.contains("irradiance"), "{shown}");
}

#[test]
fn a_study_is_checked_with_the_values_of_its_cells() {
    let study = |more: &str| {
        format!(
            "Study(about: \"x\", scenes: [\"cornell-box\"], pipelines: [\"mine\"], output: \"display\", size: (8, 8), \
             budget: Frames(1), measures: [\"gpu-ms\"], {more})"
        )
    };
    let effect = "#option WRONG 0 one_of [0, 1]\nvar picture: texture_2d<f32>;\n@fragment\n\
                  fn shade(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {\n#if WRONG == 1\n\
                  return nosuch;\n#else\nreturn textureLoad(picture, vec2<u32>(at.xy), 0);\n#endif\n}\n";
    let mine = "Pipeline(extends: \"ism.ron\", patch: [Insert(name: \"shade\", pass: Pass(kind: \"fullscreen\", \
                shader: \"effect.wgsl\", out: { \"result\": Out(interface: \"Display\") }), \
                between: (\"image.display\", \"out.display\"))])";
    let (good, bad) = (study(""), study("vary: Grid({ \"shade.wrong\": [0, 1] })"));
    let files = [("mine.ron", mine), ("effect.wgsl", effect), ("good.ron", &good), ("bad.ron", &bad)];
    let here = Folder::new(&files);
    run_in(&here, &["check", "good.ron"]).success().says(&["study of 1 cells, 1 pipelines compiled"]);
    run_in(&here, &["check", "bad.ron"]).failure(1, &["nosuch"]);
}

#[test]
fn settings_are_given_to_both_pipelines_or_to_the_second() {
    lightloom(&["diff", "ism", "ism", "--set", "lights=64"]).says(&["no difference"]);
    let difference = lightloom(&["diff", "ism", "ism", "--set-second", "lights=64", "--json"]).json();
    let lights = &difference["differences"][0];
    assert_eq!(
        (&lights["kind"], &lights["path"], &lights["before"], &lights["after"]),
        (&"parameter".into(), &"lights".into(), &"1024".into(), &"64".into())
    );
    // A parameter that has no value of its own has that of the setting.
    let inherited = lightloom(&["diff", "ism-invtm", "ism"]).out;
    assert!(inherited.lines().all(|line| !line.trim_end().ends_with(['→', ':'])), "{inherited}");
}

#[test]
fn programs_get_errors_with_code_and_place() {
    let broken = "Pipeline(\n    extends: \"ism.ron\",\n    patch: [Set(\"gather.clmp\", 0.1)],\n)";
    let mine = Folder::new(&[("broken.ron", broken)]);
    let checked = run_in(&mine, &["check", "broken.ron", "--scene", "cornell-box", "--json"]).json();
    let row = &checked["checked"][0];
    assert_eq!(row["ok"], false);
    let error = &row["errors"][0];
    assert_eq!((&error["severity"], &error["file"]), (&"error".into(), &"broken.ron".into()));
    assert_eq!((&error["code"], &error["line"]), (&"E022".into(), &3.into()), "{error}");
    assert!(error["help"].as_array().is_some_and(|help| !help.is_empty()), "{error}");
    let failed = json(&run_in(&mine, &["graph", "broken.ron", "--json"]).err);
    assert_eq!(failed["errors"][0], *error);
    let resolved = lightloom(&["resolve", "ism-invtm", "--json"]).json();
    let view = resolved["passes"].as_array().and_then(|passes| passes.first()).expect("passes");
    assert_eq!((&view["name"], &view["kind"]), (&"view".into(), &"gbuffer".into()));
    assert_eq!(view["origin"]["file"], "pipelines/parts/deferred.ron");
}

#[test]
fn unknown_names_are_reported_in_a_line() {
    for name in ["ims", "imsl"] {
        let done = lightloom(&["resolve", name]).says(&["did you mean `ism`?"]);
        assert!(!done.err.contains("pipeline:1:1"), "{done}");
    }
    let words = ["`studies` is a folder", "no pipeline, scene or study `nosuch.txt`"];
    lightloom(&["check", "studies", "nosuch.txt"]).says(&words);
    assert!(!lightloom(&["pipelines"]).out.contains("parts/"));
    let parts = lightloom(&["pipelines", "--parts"]).says(&["parts/clusters "]).out;
    assert!(parts.lines().all(|line| line.starts_with("parts/")), "{parts}");
}

#[test]
fn the_exit_code_does_not_depend_on_who_reads() {
    let mine = Folder::new(&[("bad.ron", "Pipeline(extends: \"nosuch.ron\")")]);
    for (arguments, code) in [(&["check", "bad.ron"][..], 1), (&["pipelines"], 0)] {
        let mut command = command(&mine);
        let mut child =
            command.args(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
        drop((child.stdout.take(), child.stderr.take()));
        assert_eq!(child.wait().expect("it ends").code(), Some(code), "{arguments:?}");
    }
}

#[test]
fn warnings_of_a_graph_stay_out_of_what_programs_read() {
    let mine = Folder::new(&[("rm.ron", REMOVED)]);
    let drawn = run_in(&mine, &["graph", "rm.ron"]).success();
    assert!(drawn.out.starts_with("plan "), "{drawn}");
    assert_eq!(drawn.err.matches("warning[W001]").count(), 1, "{drawn}");
    let drawn = run_in(&mine, &["graph", "rm.ron", "--json"]);
    assert!(drawn.json()["passes"].is_array(), "{drawn}");
    assert_eq!(json(&drawn.err)["warnings"][0]["code"], "W001", "{drawn}");
    // That a pipeline of the tree leaves out shadows is meant.
    let drawn = lightloom(&["graph", "exhaustive-unshadowed"]).success();
    assert!(drawn.err.is_empty(), "{drawn}");
}

#[test]
fn a_study_reports_names_that_could_mean_another_file() {
    let study = "Study(about: \"x\", scenes: [\"cornell-box\"], pipelines: [\"ism\", \"tcas\"], output: \"display\", \
                 size: (8, 8), budget: Frames(1), measures: [\"gpu-ms\"])";
    let mine =
        Folder::new(&[("s.ron", study), ("ism.ron", "Pipeline(extends: \"ism.ron\", about: \"mine\")")]);
    let words = "note[W002]: `ism` means `ism.ron`, and there is `pipelines/ism.ron` too";
    let checked = run_in(&mine, &["check", "s.ron"]).says(&[words]);
    assert_eq!(checked.out.matches("W002").count(), 1, "{checked}");
}

#[test]
fn advised_numbers_of_lights_are_taken() {
    let advice = "at most 65535 virtual lights, since `shadows/fill` takes no more";
    lightloom(&["graph", "ism-invtm", "--set", "lights=2000000"]).failure(1, &["E025", advice]);
    lightloom(&["graph", "ism-invtm", "--set", "lights=65535"]).success();
    // The pass that refuses has a history buffer, whose size is not known yet when it does.
    let refused = lightloom(&["graph", "smc-ir-2016", "--set", "lights=2000000"]);
    assert!(!refused.failure(1, &["E025", "virtual lights"]).err.contains("E051"));
}

/// The examples are whole folders: nothing in them is found by where the tree is.
#[test]
fn the_examples_work_where_they_are_copied() {
    let copy = Folder::new(&[]);
    for entry in std::fs::read_dir(root().join("docs/examples")).expect("the examples").flatten() {
        std::fs::copy(entry.path(), copy.join(entry.file_name())).expect("a copy");
    }
    let pipelines = ["vignette.ron", "block-means.ron", "a-trous.ron", "one-bounce-clamped.ron"];
    run_in(&copy, &[&["check", "--scene", "cornell-box"][..], &pipelines].concat()).success();
    run_in(&copy, &["check", "one-bounce-study.ron"]).success();
}
