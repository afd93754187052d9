//! What the commands that need no GPU tell of files, to users and to programs.

use crate::adapter::root;
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn lightloom(folder: &Path, arguments: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_lightloom");
    Command::new(program).args(arguments).current_dir(folder).output().expect("it starts")
}

fn out(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn err(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

/// A folder with these files.
fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).expect("a file");
    }
    folder
}

const REMOVED: &str = "Pipeline(extends: \"ism.ron\", patch: [Remove(\"filter\")])";

#[test]
fn what_a_removed_pass_leaves_is_told() {
    let mine = folder(&[("rm.ron", REMOVED)]);
    let checked = lightloom(mine.path(), &["check", "rm.ron", "--scene", "cornell-box"]);
    assert!(checked.status.success(), "{}", err(&checked));
    let told = out(&checked);
    for part in
        ["warning[W001]", "`image` is left without its input `indirect`", "the output `irradiance` is lost"]
    {
        assert!(told.contains(part), "no `{part}` in\n{told}");
    }
    let differences = out(&lightloom(mine.path(), &["diff", "ism", "rm.ron"]));
    assert!(
        differences.contains("- link image.indirect") && differences.contains("- output irradiance"),
        "{differences}"
    );
    let shown = out(&lightloom(mine.path(), &["pipelines", "rm.ron"]));
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
    let here = folder(&files);
    let checked = lightloom(here.path(), &["check", "good.ron"]);
    assert!(checked.status.success(), "{}{}", out(&checked), err(&checked));
    assert!(out(&checked).contains("study of 1 cells, 1 pipelines compiled"), "{}", out(&checked));
    let checked = lightloom(here.path(), &["check", "bad.ron"]);
    assert!(!checked.status.success() && out(&checked).contains("nosuch"), "{}", out(&checked));
}

#[test]
fn settings_are_given_to_both_pipelines_or_to_the_second() {
    let root = root();
    let both = lightloom(&root, &["diff", "ism", "ism", "--set", "lights=64"]);
    assert!(out(&both).contains("no difference"), "{}{}", out(&both), err(&both));
    let second = lightloom(&root, &["diff", "ism", "ism", "--set-second", "lights=64", "--json"]);
    let told = json(&out(&second));
    let lights = &told["differences"][0];
    assert_eq!(
        (&lights["kind"], &lights["path"], &lights["before"], &lights["after"]),
        (&"parameter".into(), &"lights".into(), &"1024".into(), &"64".into())
    );
    // A parameter that has no value of its own has that of the setting.
    let inherited = out(&lightloom(&root, &["diff", "ism-invtm", "ism"]));
    assert!(inherited.lines().all(|line| !line.trim_end().ends_with(['→', ':'])), "{inherited}");
}

#[test]
fn programs_are_told_errors_with_code_and_place() {
    let broken = "Pipeline(\n    extends: \"ism.ron\",\n    patch: [Set(\"gather.clmp\", 0.1)],\n)";
    let mine = folder(&[("broken.ron", broken)]);
    let checked = lightloom(mine.path(), &["check", "broken.ron", "--scene", "cornell-box", "--json"]);
    let row = &json(&out(&checked))["checked"][0];
    assert_eq!(row["ok"], false);
    let error = &row["errors"][0];
    assert_eq!((&error["severity"], &error["file"]), (&"error".into(), &"broken.ron".into()));
    assert_eq!((&error["code"], &error["line"]), (&"E022".into(), &3.into()), "{error}");
    assert!(error["help"].as_array().is_some_and(|help| !help.is_empty()), "{error}");
    let failed = json(&err(&lightloom(mine.path(), &["graph", "broken.ron", "--json"])));
    assert_eq!(failed["errors"][0], *error);
    let resolved = json(&out(&lightloom(&root(), &["resolve", "ism-invtm", "--json"])));
    let view = resolved["passes"].as_array().and_then(|passes| passes.first()).expect("passes");
    assert_eq!((&view["name"], &view["kind"]), (&"view".into(), &"gbuffer".into()));
    assert_eq!(view["origin"]["file"], "pipelines/ism.ron");
}

#[test]
fn names_that_are_nothing_are_told_in_a_line() {
    let root = root();
    for name in ["ims", "imsl"] {
        let told = err(&lightloom(&root, &["resolve", name]));
        assert!(told.contains("did you mean `ism`?") && !told.contains("pipeline:1:1"), "{told}");
    }
    let told = out(&lightloom(&root, &["check", "studies", "nosuch.txt"]));
    assert!(
        told.contains("`studies` is a folder") && told.contains("no pipeline, scene or study `nosuch.txt`"),
        "{told}"
    );
    assert!(!out(&lightloom(&root, &["pipelines"])).contains("parts/"));
    let parts = out(&lightloom(&root, &["pipelines", "--parts"]));
    assert!(
        parts.lines().all(|line| line.starts_with("parts/")) && parts.contains("parts/clusters "),
        "{parts}"
    );
}

#[test]
fn the_exit_code_does_not_depend_on_who_reads() {
    let mine = folder(&[("bad.ron", "Pipeline(extends: \"nosuch.ron\")")]);
    for (arguments, code) in [(&["check", "bad.ron"][..], 1), (&["pipelines"], 0)] {
        let program = env!("CARGO_BIN_EXE_lightloom");
        let mut child = Command::new(program)
            .args(arguments)
            .current_dir(mine.path())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("it starts");
        drop((child.stdout.take(), child.stderr.take()));
        assert_eq!(child.wait().expect("it ends").code(), Some(code), "{arguments:?}");
    }
}

#[test]
fn warnings_of_a_graph_stay_out_of_what_programs_read() {
    let mine = folder(&[("rm.ron", REMOVED)]);
    let drawn = lightloom(mine.path(), &["graph", "rm.ron"]);
    assert!(drawn.status.success() && out(&drawn).starts_with("plan "), "{}", out(&drawn));
    assert_eq!(err(&drawn).matches("warning[W001]").count(), 1, "{}", err(&drawn));
    let drawn = lightloom(mine.path(), &["graph", "rm.ron", "--json"]);
    assert!(json(&out(&drawn))["passes"].is_array(), "{}", out(&drawn));
    assert_eq!(json(&err(&drawn))["warnings"][0]["code"], "W001", "{}", err(&drawn));
    // That a pipeline of the tree leaves out shadows is meant.
    let drawn = lightloom(mine.path(), &["graph", "exhaustive-unshadowed"]);
    assert!(drawn.status.success() && err(&drawn).is_empty(), "{}", err(&drawn));
}

#[test]
fn a_study_tells_names_that_could_mean_another_file() {
    let study = "Study(about: \"x\", scenes: [\"cornell-box\"], pipelines: [\"ism\", \"tcas\"], output: \"display\", \
                 size: (8, 8), budget: Frames(1), measures: [\"gpu-ms\"])";
    let mine = folder(&[("s.ron", study), ("ism.ron", "Pipeline(extends: \"ism.ron\", about: \"mine\")")]);
    let told = out(&lightloom(mine.path(), &["check", "s.ron"]));
    assert!(
        told.contains("note[W002]: `ism` means `ism.ron`, and there is `pipelines/ism.ron` too"),
        "{told}"
    );
    assert_eq!(told.matches("W002").count(), 1, "{told}");
}

#[test]
fn advised_numbers_of_lights_are_taken() {
    let told = err(&lightloom(&root(), &["graph", "ism-invtm", "--set", "lights=2000000"]));
    let advice = "at most 65535 virtual lights, since `shadows/fill` takes no more";
    assert!(told.contains("E025") && told.contains(advice), "{told}");
    let taken = lightloom(&root(), &["graph", "ism-invtm", "--set", "lights=65535"]);
    assert!(taken.status.success(), "{}", err(&taken));
    // The pass that refuses has a history buffer, whose size is not known yet when it does.
    let told = err(&lightloom(&root(), &["graph", "smc-ir", "--set", "lights=2000000"]));
    assert!(told.contains("E025") && told.contains("virtual lights") && !told.contains("E051"), "{told}");
}

/// The examples are whole folders: nothing in them is found by where the tree is.
#[test]
fn the_examples_work_where_they_are_copied() {
    let copy = tempfile::tempdir().expect("a folder");
    for entry in std::fs::read_dir(root().join("docs/examples")).expect("the examples").flatten() {
        std::fs::copy(entry.path(), copy.path().join(entry.file_name())).expect("a copy");
    }
    let pipelines =
        ["vignette", "block-means", "a-trous", "one-bounce-clamped"].map(|name| format!("{name}.ron"));
    let mut arguments = vec!["check", "--scene", "cornell-box"];
    arguments.extend(pipelines.iter().map(String::as_str));
    let checked = lightloom(copy.path(), &arguments);
    assert!(checked.status.success(), "{}{}", out(&checked), err(&checked));
    let study = lightloom(copy.path(), &["check", "one-bounce-study.ron"]);
    assert!(study.status.success(), "{}{}", out(&study), err(&study));
}
