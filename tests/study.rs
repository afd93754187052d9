//! Studies as a user runs them: the tree's own in miniature, a kill, two runs, a full disk, parts, pages.

use crate::adapter::{gpu, root};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant, SystemTime};

const SMALL: &str = r#"Study(
    about: "Small",
    scenes: ["cornell-box"],
    pipelines: ["ism", "ism-uniform"],
    size: (16, 12),
    set: { "rsm.size": 32, "map": 32, "shadows.points": Optional(4096) },
    vary: Grid({ "lights": [8, 16, 32, 64] }),
    budget: Frames(2),
    seeds: 2,
    measures: ["rel-mse", "energy", "gpu-ms", "memory"],
    reference: Pipeline(pipeline: "reference", set: { "samples": 8 }),
)"#;

fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lightloom"));
    command.args(["--root", &root().to_string_lossy(), "study"]).args(arguments).current_dir(folder);
    command
}

fn study(folder: &Path, arguments: &[&str]) -> Output {
    command(folder, arguments).output().unwrap()
}

fn text(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

/// A folder with the small study in it.
fn folder() -> Option<tempfile::TempDir> {
    gpu()?;
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("small.ron"), SMALL).unwrap();
    Some(folder)
}

fn files(folder: &Path) -> BTreeMap<PathBuf, SystemTime> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let whole = entries.filter(|entry| entry.path().extension().is_some_and(|extension| extension == "json"));
    whole.map(|entry| (entry.path(), entry.metadata().unwrap().modified().unwrap())).collect()
}

/// The table without what is timed.
fn table(folder: &Path) -> String {
    let text = fs::read_to_string(folder.join("cells.csv")).unwrap();
    text.lines().filter(|line| !line.contains("gpu-ms")).collect::<Vec<_>>().join("\n")
}

/// Waits until `ready`, or the process ends.
fn wait(child: &mut Child, ready: impl Fn() -> bool) {
    let start = Instant::now();
    while !ready() && child.try_wait().unwrap().is_none() {
        assert!(start.elapsed() < Duration::from_secs(120), "nothing happens");
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_killed_study_goes_on_and_comes_to_the_same() {
    let Some(folder) = folder() else { return };
    let at = |name: &str| folder.path().join(name);
    let mut child = command(folder.path(), &["small.ron", "-o", "killed"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let cells = at("killed/cells");
    wait(&mut child, || !files(&cells).is_empty());
    // A second run while the first is at work is refused, and harms nothing.
    let second = study(folder.path(), &["small.ron", "-o", "killed"]);
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(second.status.code(), Some(1), "{}", text(&second));
    assert!(text(&second).contains(&format!("process {}", child.id())), "{}", text(&second));
    let before = files(&cells);
    assert!((1..16).contains(&before.len()), "{} cells before the kill", before.len());
    let again = study(folder.path(), &["small.ron", "-o", "killed"]);
    assert!(again.status.success(), "{}", text(&again));
    assert!(
        text(&again).contains(&format!("{} of 16 cells are finished already", before.len())),
        "{}",
        text(&again)
    );
    let after = files(&cells);
    assert_eq!(after.len(), 16);
    for (path, time) in before {
        assert_eq!(after[&path], time, "{} was written again", path.display());
    }
    assert!(study(folder.path(), &["small.ron", "-o", "whole"]).status.success());
    assert_eq!(table(&at("killed")), table(&at("whole")));
    assert!(at("whole/report.html").is_file());
}

#[test]
fn parts_join_and_results_go_into_a_page() {
    let Some(folder) = folder() else { return };
    let at = |name: &str| folder.path().join(name);
    for part in ["1", "2"] {
        let shard = format!("{part}/2");
        let done = study(
            folder.path(),
            &["small.ron", "-o", part, "--shard", &shard, "--references", "shared", "--seeds", "1", "--json"],
        );
        let json: serde_json::Value =
            serde_json::from_slice(&done.stdout).unwrap_or_else(|_| panic!("{}", text(&done)));
        assert_eq!((&json["cells"], &json["missing"]), (&4.into(), &4.into()), "{json}");
    }
    let merged = study(folder.path(), &["merge", "1", "2", "-o", "all"]);
    assert!(merged.status.success(), "{}", text(&merged));
    assert_eq!(files(&at("all/cells")).len(), 8);
    fs::write(at("page.md"), "# Results\n\nBy hand.\n").unwrap();
    for _ in 0..2 {
        let done = study(folder.path(), &["publish", "all", "--page", "page.md"]);
        assert!(done.status.success(), "{}", text(&done));
    }
    let page = fs::read_to_string(at("page.md")).unwrap();
    assert!(page.starts_with("# Results\n\nBy hand.\n\n<!-- study: small -->"), "{page}");
    assert_eq!(page.matches("<!-- study").count(), 1);
    assert!(
        page.contains("lightloom study small.ron --seeds 1 -o DIR") && page.contains("| ism-uniform |"),
        "{page}"
    );
    let report = study(folder.path(), &["report", "all"]);
    assert!(text(&report).contains("report.html"), "{}", text(&report));
    let nothing = study(folder.path(), &["report", "nowhere"]);
    assert!(nothing.status.code() == Some(1) && text(&nothing).contains("there is no study here"));
}

/// Files may not grow beyond some blocks, as on a disk that is full: the file is named, finished cells are kept.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_told_and_keeps_what_is_finished() {
    let Some(folder) = folder() else { return };
    let growing = r#"Study(
        scenes: ["cornell-box"], pipelines: ["ism-uniform"], set: { "rsm.size": 32, "lights": 8 },
        vary: Grid({ "size": [(16, 12), (160, 120)] }), budget: Frames(1), measures: ["gpu-ms"],
    )"#;
    fs::write(folder.path().join("growing.ron"), growing).unwrap();
    let run = |limit: &str| {
        let line = format!("trap '' XFSZ; ulimit -f {limit}; exec \"$0\" \"$@\"");
        Command::new("sh")
            .args([
                "-c",
                &line,
                env!("CARGO_BIN_EXE_lightloom"),
                "--root",
                &root().to_string_lossy(),
                "study",
            ])
            .args(["growing.ron", "-o", "out"])
            .env("MESA_SHADER_CACHE_DISABLE", "true")
            .current_dir(folder.path())
            .output()
            .unwrap()
    };
    // The first cell takes some 10 KB a file, the picture of the second more than 100.
    let full = run("64");
    let said = text(&full);
    assert_eq!(full.status.code(), Some(1), "{said}");
    for word in ["what is finished is kept", "images/", "File too large"] {
        assert!(said.contains(word), "{word} is not in {said}");
    }
    assert_eq!(files(&folder.path().join("out/cells")).len(), 1);
    let again = run("unlimited");
    assert!(
        again.status.success() && text(&again).contains("1 of 2 cells are finished already"),
        "{}",
        text(&again)
    );
}

/// A pipeline that cannot be made, and a picture that is no picture, fail alone.
#[test]
fn cells_that_fail_leave_the_others() {
    let Some(folder) = folder() else { return };
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    // It resolves, and then everything reads a pass that is not there.
    write("unlinked.ron", "Pipeline(extends: \"ism.ron\", patch: [Remove(\"view\")])");
    write(
        "nan.ron",
        "Pipeline(
            extends: \"ism.ron\",
            passes: { \"nan\": Pass(kind: \"fullscreen\", shader: \"nan.wgsl\", out: { \"result\": Out(interface: \"Radiance\") }) },
            outputs: { \"indirect\": \"nan\" },
        )",
    );
    write(
        "nan.wgsl",
        "// Not a number, by its bits.
        @fragment
        fn nan(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
            return vec4(bitcast<f32>(0x7fc00000u + u32(at.x) % 2u));
        }",
    );
    let failing =
        SMALL.replace("\"ism-uniform\"", "\"unlinked.ron\", \"nan.ron\"").replace("16, 32, 64", "16");
    write("failing.ron", &failing);
    let done = study(folder.path(), &["failing.ron", "-o", "out", "--seeds", "1", "--json"]);
    assert_eq!(done.status.code(), Some(1), "{}", text(&done));
    let json: serde_json::Value =
        serde_json::from_slice(&done.stdout).unwrap_or_else(|_| panic!("{}", text(&done)));
    let failed: Vec<&str> =
        json["failed"].as_array().unwrap().iter().map(|cell| cell["error"].as_str().unwrap()).collect();
    assert_eq!((failed.len(), &json["cells"]), (4, &6.into()), "{json}");
    assert!(
        failed[0].contains("E039") && failed[2] == "192 of 192 pixels of frame 1 are NaN or infinite",
        "{json}"
    );
    let pictures = json["pictures"].as_array().unwrap();
    assert_eq!(pictures.len(), 6, "{json}");
    for picture in pictures {
        if let Some(image) = picture["images"]["image"].as_str() {
            assert_eq!(image, format!("images/{}.exr", picture["key"].as_str().unwrap()));
            assert!(folder.path().join("out").join(image).is_file(), "{image}");
        }
    }
    assert!(text(&done).contains("4 cells failed; the same command tries them again"), "{}", text(&done));
    let table = fs::read_to_string(folder.path().join("out/cells.csv")).unwrap();
    let timed = table.lines().filter(|line| line.contains("nan") && line.contains(",gpu-ms,")).count();
    assert_eq!(timed, 2, "what is not a matter of pixels is measured: {table}");
}

#[test]
fn mistakes_are_told_before_anything_runs() {
    let folder = tempfile::tempdir().unwrap();
    let wrong = SMALL.replace("\"lights\": [", "\"ligths\": [").replace("cornell-box", "cornel-box");
    fs::write(folder.path().join("wrong.ron"), wrong).unwrap();
    let done = study(folder.path(), &["wrong.ron", "-o", "out"]);
    assert_eq!(done.status.code(), Some(1));
    let said = text(&done);
    for word in ["T001", "T003", "did you mean `cornell-box`?", "did you mean `lights`?", "wrong.ron:3:14"] {
        assert!(said.contains(word), "{word} is not in {said}");
    }
    assert!(!folder.path().join("out").exists());
    let check = |name: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_lightloom"));
        command.args(["--root", &root().to_string_lossy(), "check", name]).current_dir(folder.path());
        command.env("VK_DRIVER_FILES", "/nonexistent").output().unwrap()
    };
    let checked = check("wrong.ron");
    assert!(checked.status.code() == Some(1) && text(&checked).contains("T003"), "{}", text(&checked));
    let checked = check("ism-tab-1");
    assert!(text(&checked).contains("ok      ism-tab-1: study of 18 cells"), "{}", text(&checked));
    let unknown = study(folder.path(), &["ism-fig4", "-o", "out"]);
    assert!(text(&unknown).contains("did you mean `ism-fig-4`?"), "{}", text(&unknown));
    for usage in [&["small.ron"][..], &["small.ron", "-o", "x", "--shard", "3/2"], &[]] {
        assert_eq!(study(folder.path(), usage).status.code(), Some(2), "{usage:?}");
    }
}

/// Every study of the tree, whole but for its sizes.
#[test]
fn the_trees_studies_run_in_miniature() {
    if gpu().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let studies = fs::read_dir(root().join("studies")).unwrap().flatten().map(|entry| entry.path());
    let names: Vec<String> = studies
        .filter(|path| path.extension().is_some_and(|extension| extension == "ron"))
        .map(|path| path.file_stem().unwrap().to_string_lossy().into_owned())
        .collect();
    assert!(names.len() >= 3, "{names:?}");
    for name in names {
        let mut arguments = vec![
            name.as_str(),
            "-o",
            &name,
            "--quick",
            "--size",
            "16x12",
            "--frames",
            "2",
            "--scene",
            "cornell-box",
            "--json",
        ];
        for set in ["rsm.size=32", "map=32", "lights=16"] {
            arguments.extend(["--set", set]);
        }
        // Rays, exact maps and what casts no shadow need no points.
        let pointless = ["approximations", "near-field", "acrsm-fig-3-10", "acrsm-fig-6-1"];
        if !pointless.contains(&&*name) && !name.contains("smc-ir") {
            arguments.extend(["--set", "shadows.points_per_map=256"]);
        }
        // Others make points on the fly.
        if name.starts_with("ism") || ["imperfect-maps", "tcas-tab-3"].contains(&&*name) {
            arguments.extend(["--set", "shadows.points=4096"]);
        }
        let reference: &[&str] = match name.as_str() {
            "ism-fig-4" => &["map=32", "rsm.size=32"],
            "filters" | "tcas-fig-6" | "tcas-weights" | "imperfect-maps" | "acrsm-fig-3-10"
            | "acrsm-fig-6-1" | "acrsm-fig-6-2" | "approximations" => &["lights=64", "rsm.size=32"],
            "approximations-smc-ir-frame" => &["lights=16"],
            _ => &["samples=4", "bounces=1"],
        };
        for set in reference {
            arguments.extend(["--set-reference", set]);
        }
        let done = study(folder.path(), &arguments);
        assert!(done.status.success(), "{name}: {}", text(&done));
        let json: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
        assert!(json["cells"].as_u64().unwrap() > 0 && json["missing"] == 0, "{json}");
    }
}

/// Every measure on a scene where camera, light and geometry move; each has a value that it may have.
#[test]
fn every_measure_is_taken_of_a_walk() {
    let Some(folder) = folder() else { return };
    let keys: Vec<&str> = ::study::Measure::all().map(::study::Measure::key).collect();
    let walk = format!(
        r#"Study(
            scenes: ["cornell-box-moving"], pipelines: ["ism-uniform"], size: (24, 16), first_frame: 4, jump: 7,
            set: {{ "rsm.size": 32, "lights": 32, "map": 32 }}, budget: Frames(6), seeds: 2,
            measures: {keys:?}, reference: Pipeline(pipeline: "reference", set: {{ "samples": 16, "filter": "centre" }}),
        )"#
    );
    fs::write(folder.path().join("walk.ron"), &walk).unwrap();
    // Nothing flickers where nothing moves: sequences are the same in every frame.
    let still = walk.replace("-moving", "").replace("jump: 7,", "").replace("\"lag\", ", "");
    fs::write(folder.path().join("still.ron"), still).unwrap();
    let figures = |name: &str| -> BTreeMap<String, Option<f64>> {
        let done = study(folder.path(), &[&format!("{name}.ron"), "-o", name]);
        assert!(done.status.success(), "{}", text(&done));
        let results = ::study::Results::read(&folder.path().join(name)).unwrap();
        results.cells[0].measures.clone()
    };
    let moving = figures("walk");
    for key in &keys {
        let absent = *key == "static-deviation";
        assert_eq!(moving[*key].is_none(), absent, "{key}: {:?}", moving[*key]);
    }
    let of = |figures: &BTreeMap<String, Option<f64>>, key: &str| figures[key].unwrap();
    assert!(of(&moving, "tid") > 0.0 && of(&moving, "e-prime") > 0.0 && of(&moving, "lights-moved") > 0.5);
    assert!((0.5..=1.0).contains(&of(&moving, "lights-that-reach")), "{moving:?}");
    assert!((0.5..2.0).contains(&of(&moving, "energy")), "{moving:?}");
    let still = figures("still");
    for key in ["tid", "tid-of-reference", "e-prime", "tone-change", "lights-moved", "static-deviation"] {
        assert_eq!(of(&still, key), 0.0, "{key}");
    }
}

/// A pipeline that says how far it is has converged before its first counted frame.
#[test]
fn a_cell_converges_before_its_first_counted_frame() {
    let Some(folder) = folder() else { return };
    let progressive = r#"Study(
        scenes: ["cornell-box"], pipelines: ["reference"], size: (16, 12), warm_up: 0, budget: Frames(1),
        set: { "samples": 8, "samples_per_frame": 2 }, measures: ["rel-mse"],
        reference: Pipeline(pipeline: "reference", set: { "samples": 8, "samples_per_frame": 2 }),
    )"#;
    fs::write(folder.path().join("converged.ron"), progressive).unwrap();
    let done = study(folder.path(), &["converged.ron", "-o", "out"]);
    assert!(done.status.success(), "{}", text(&done));
    let results = ::study::Results::read(&folder.path().join("out")).unwrap();
    // The same eight samples as the reference has: after one frame alone there would be two.
    assert_eq!(results.cells[0].measures["rel-mse"], Some(0.0), "{:?}", results.cells[0].measures);
}
