//! Studies as a user runs them: the tree's own in miniature, a kill, two runs, a full disk, parts, pages.

use crate::adapter::{gpu, names_in, root};
use crate::program::{Done, Folder, command_of_tree};
use metrics::Image;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
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

fn study(folder: &Path, arguments: &[&str]) -> Done {
    Done::of(command_of_tree(folder).arg("study").args(arguments))
}

/// Returns a folder with the small study in it.
fn folder() -> Option<Folder> {
    Folder::with_gpu(&[("small.ron", SMALL)])
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

#[test]
fn a_killed_study_goes_on_and_comes_to_the_same() {
    let Some(folder) = folder() else { return };
    let mut child = command_of_tree(&folder)
        .args(["study", "small.ron", "-o", "killed"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let cells = folder.at("killed/cells");
    let start = Instant::now();
    while files(&cells).is_empty() && child.try_wait().unwrap().is_none() {
        assert!(start.elapsed() < Duration::from_secs(600), "nothing happens");
        std::thread::sleep(Duration::from_millis(5));
    }
    // A second run while the first is at work is refused, and harms nothing.
    let second = study(&folder, &["small.ron", "-o", "killed"]);
    child.kill().unwrap();
    child.wait().unwrap();
    second.failure(1, &[&format!("process {}", child.id())]);
    let before = files(&cells);
    assert!((1..16).contains(&before.len()), "{} cells before the kill", before.len());
    let words = format!("{} of 16 cells are finished already", before.len());
    study(&folder, &["small.ron", "-o", "killed"]).success().says(&[&words]);
    let after = files(&cells);
    assert_eq!(after.len(), 16);
    for (path, time) in before {
        assert_eq!(after[&path], time, "{} was written again", path.display());
    }
    study(&folder, &["small.ron", "-o", "whole"]).success();
    assert_eq!(table(&folder.at("killed")), table(&folder.at("whole")));
    assert!(folder.at("whole/report.html").is_file());
}

#[test]
fn parts_join_and_results_go_into_a_page() {
    let Some(folder) = folder() else { return };
    for part in ["1", "2"] {
        let shard = format!("{part}/2");
        let arguments = ["--shard", &shard, "--references", "shared", "--seeds", "1", "--json"];
        let json = study(&folder, &[&["small.ron", "-o", part][..], &arguments].concat()).json();
        assert_eq!((&json["cells"], &json["missing"]), (&4.into(), &4.into()), "{json}");
    }
    study(&folder, &["merge", "1", "2", "-o", "all"]).success();
    assert_eq!(files(&folder.at("all/cells")).len(), 8);
    folder.write("pages/small.md", "# Results\n\nBy hand.\n");
    for _ in 0..2 {
        study(&folder, &["publish", "all", "--into", "pages"]).success();
    }
    let page = folder.read("pages/small.md");
    assert!(page.starts_with("# Results\n\nBy hand.\n\n<!-- study: small -->"), "{page}");
    assert_eq!(page.matches("<!-- study").count(), 1);
    assert!(
        page.contains("lightloom study small.ron --seeds 1 -o DIR") && page.contains("| ism-uniform |"),
        "{page}"
    );
    study(&folder, &["report", "all"]).says(&["report.html"]);
    pictures_go_into_a_page(&folder);
    study(&folder, &["report", "nowhere"]).failure(1, &["there is no study here"]);
}

/// A gallery: the pictures of the study `all` as files, and a table of them in a page, whose other text stays.
fn pictures_go_into_a_page(folder: &Folder) {
    let gallery = ["pictures", "all", "--page", "pages/all.md", "--into", "pages/pictures"];
    folder.write("pages/all.md", "By hand.\n");
    study(folder, &gallery).failure(1, &["pages/all.md", "<!-- gallery: small -->"]);
    assert_eq!(folder.read("pages/all.md"), "By hand.\n");
    folder.write("pages/all.md", "Before.\n<!-- gallery: small -->\nold\n<!-- end -->\nAfter.\n");
    for _ in 0..2 {
        study(folder, &gallery).success();
    }
    let page = folder.read("pages/all.md");
    assert!(
        page.starts_with("Before.\n<!-- gallery: small -->\n") && page.ends_with("<!-- end -->\nAfter.\n")
    );
    assert!(
        !page.contains("old") && page.contains("<code>reference</code>") && page.contains(" ms"),
        "{page}"
    );
    let shown: Vec<&str> =
        page.split("<img src=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
    // The reference, and eight cells.
    assert_eq!(shown.len(), 9, "{page}");
    for file in shown {
        let picture = Image::read(folder.at("pages").join(file)).unwrap();
        assert!(picture.pixels().iter().any(|pixel| pixel[0] > 0.0), "{file}");
    }
}

/// Files may not grow beyond some blocks, as on a disk that is full: the file is named, finished cells are kept.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_reported_and_keeps_finished_cells() {
    let growing = r#"Study(
        scenes: ["cornell-box"], pipelines: ["ism-uniform"], set: { "rsm.size": 32, "lights": 8 },
        vary: Grid({ "size": [(16, 12), (160, 120)] }), budget: Frames(1), measures: ["gpu-ms"],
    )"#;
    let Some(folder) = Folder::with_gpu(&[("growing.ron", growing)]) else { return };
    let run = |limit: &str| {
        let line = format!("trap '' XFSZ; ulimit -f {limit}; exec \"$0\" \"$@\"");
        let mut command = Command::new("sh");
        command.args(["-c", &line, env!("CARGO_BIN_EXE_lightloom"), "--root"]).arg(root());
        command.args(["study", "growing.ron", "-o", "out"]).env("MESA_SHADER_CACHE_DISABLE", "true");
        Done::of(command.current_dir(&*folder))
    };
    // The first cell takes some 10 KB a file, the picture of the second more than 100.
    run("64").failure(1, &["what is finished is kept", "images/", "File too large"]);
    assert_eq!(files(&folder.at("out/cells")).len(), 1);
    run("unlimited").success().says(&["1 of 2 cells are finished already"]);
}

/// A pipeline that cannot be made, and a picture that is no picture, fail alone.
#[test]
fn cells_that_fail_leave_the_others() {
    let failing =
        SMALL.replace("\"ism-uniform\"", "\"unlinked.ron\", \"nan.ron\"").replace("16, 32, 64", "16");
    let nan = "Pipeline(
        extends: \"ism.ron\",
        passes: { \"nan\": Pass(kind: \"fullscreen\", shader: \"nan.wgsl\", out: { \"result\": Out(interface: \"Radiance\") }) },
        outputs: { \"indirect\": \"nan\" },
    )";
    let shader = "// Not a number, by its bits.
        @fragment
        fn nan(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
            return vec4(bitcast<f32>(0x7fc00000u + u32(at.x) % 2u));
        }";
    let files = [
        // It resolves, and then everything reads a pass that is not there.
        ("unlinked.ron", "Pipeline(extends: \"ism.ron\", patch: [Remove(\"view\")])"),
        ("nan.ron", nan),
        ("nan.wgsl", shader),
        ("failing.ron", &failing),
    ];
    let Some(folder) = Folder::with_gpu(&files) else { return };
    let done = study(&folder, &["failing.ron", "-o", "out", "--seeds", "1", "--json"]);
    let done = done.failure(1, &["4 cells failed; the same command tries them again"]);
    let json = done.json();
    let failed: Vec<&str> =
        json["failed"].as_array().unwrap().iter().map(|cell| cell["error"].as_str().unwrap()).collect();
    assert_eq!((failed.len(), &json["cells"]), (4, &6.into()), "{json}");
    assert!(
        failed[0].contains("E039") && failed[2] == "192 of 192 pixels of frame 1 are NaN or infinite",
        "{json}"
    );
    let records = json["records"].as_array().unwrap();
    assert_eq!(records.len(), 6, "{json}");
    for picture in records {
        if let Some(image) = picture["images"]["image"].as_str() {
            assert_eq!(image, format!("images/{}.exr", picture["key"].as_str().unwrap()));
            assert!(folder.at("out").join(image).is_file(), "{image}");
        }
    }
    let table = folder.read("out/cells.csv");
    let timed = table.lines().filter(|line| line.contains("nan") && line.contains(",gpu-ms,")).count();
    assert_eq!(timed, 2, "measures that need no pixels are taken: {table}");
}

#[test]
fn mistakes_are_reported_before_anything_runs() {
    let wrong = SMALL.replace("\"lights\": [", "\"ligths\": [").replace("cornell-box", "cornel-box");
    let folder = Folder::new(&[("wrong.ron", &wrong)]);
    let words = ["T001", "T003", "did you mean `cornell-box`?", "did you mean `lights`?", "wrong.ron:3:14"];
    study(&folder, &["wrong.ron", "-o", "out"]).failure(1, &words);
    assert!(!folder.at("out").exists());
    let check = |name: &str| {
        let mut command = command_of_tree(&folder);
        Done::of(command.args(["check", name]).env("VK_DRIVER_FILES", "/nonexistent"))
    };
    check("wrong.ron").failure(1, &["T003"]);
    check("ism-tab-1").says(&["ok      ism-tab-1: study of 18 cells"]);
    study(&folder, &["ism-fig4", "-o", "out"]).says(&["did you mean `ism-fig-4`?"]);
    for usage in [&["small.ron"][..], &["small.ron", "-o", "x", "--shard", "3/2"], &[]] {
        study(&folder, usage).failure(2, &[]);
    }
}

/// Studies of many pipelines, or of ones that iterate before their first frame.
fn takes_long(name: &str) -> bool {
    name.contains("smc-ir") || name.starts_with("approximations-") || name == "speed-against-accuracy"
}

/// Every study of the tree, whole but for its sizes.
#[test]
fn the_trees_studies_run_in_miniature() {
    run_in_miniature(|name| !takes_long(name));
}

#[test]
#[ignore = "slow"]
fn the_trees_long_studies_run_in_miniature() {
    run_in_miniature(takes_long);
}

fn run_in_miniature(wanted: fn(&str) -> bool) {
    if gpu().is_none() {
        return;
    }
    let folder = Folder::new(&[]);
    let names: Vec<String> = names_in("studies").into_iter().filter(|name| wanted(name)).collect();
    assert!(names.len() >= 3, "{names:?}");
    for name in names {
        let mut arguments = vec![&*name, "-o", &name, "--quick", "--size", "16x12", "--frames", "3"];
        // Many have the same reference.
        arguments.extend(["--scene", "cornell-box", "--references", "references", "--json"]);
        for set in ["rsm.size=32", "map=32", "lights=16"] {
            arguments.extend(["--set", set]);
        }
        // Lamps and skies have points of their own.
        let own_points = ["ism-fig-10", "ism-fig-11"].contains(&&*name);
        if own_points {
            arguments.extend(["--set", "points_per_map=256"]);
        }
        // All pipelines of these iterate.
        let iterates =
            ["approximations-smc-ir", "smc-ir-fig-8", "smc-ir-fig-10", "smc-ir-tab-1", "smc-ir-tab-2"];
        if iterates.contains(&&*name) {
            arguments.extend(["--set", "lights/replacement.warm_up=4"]);
        }
        // Rays, exact maps and what casts no shadow need no points.
        let pointless = ["approximations", "near-field", "acrsm-fig-3-10", "acrsm-fig-6-1", "light-tree"];
        if !own_points && !pointless.contains(&&*name) && !name.contains("smc-ir") {
            arguments.extend(["--set", "shadows.points_per_map=256"]);
        }
        // Others make points on the fly.
        if !own_points && name.starts_with("ism") || ["imperfect-maps", "tcas-tab-3"].contains(&&*name) {
            arguments.extend(["--set", "shadows.points=4096"]);
        }
        let reference: &[&str] = match name.as_str() {
            "ism-fig-4" => &["map=32", "rsm.size=32"],
            "ism-fig-5" | "ism-fig-11" | "ism-fig-12" => &["lights=64", "map=32", "rsm.size=32"],
            "filters" | "tcas-fig-6" | "tcas-weights" | "imperfect-maps" | "acrsm-fig-3-10"
            | "acrsm-fig-6-1" | "acrsm-fig-6-2" | "approximations" | "false-shadows" | "filling-maps"
            | "ism-fig-8" | "mixed-maps" => &["lights=64", "rsm.size=32"],
            "approximations-smc-ir-frame" => &["lights=16"],
            "ism-fig-7" => &["samples=4"],
            _ => &["samples=4", "bounces=1"],
        };
        for set in reference {
            arguments.extend(["--set-reference", set]);
        }
        let json = study(&folder, &arguments).success().json();
        assert!(json["cells"].as_u64().unwrap() > 0 && json["missing"] == 0, "{json}");
        assert_samples_of_the_reference(&folder, &name);
    }
}

/// A reference that sees the centre of a pixel is that of pipelines which see no more of it.
fn assert_samples_of_the_reference(folder: &Folder, name: &str) {
    let study = fs::read_to_string(root().join(format!("studies/{name}.ron"))).unwrap();
    if !study.contains("\"filter\": \"centre\"") {
        return;
    }
    let mut found = 0;
    for cell in fs::read_dir(folder.at(name).join("cells")).unwrap() {
        let cell = fs::read_to_string(cell.unwrap().path()).unwrap();
        let cell: serde_json::Value = serde_json::from_str(&cell).unwrap();
        let pipeline = cell["provenance"].to_string();
        // Where the parameter is declared, not where the study sets it.
        let declared = |rest: &str| {
            let parameter = rest.trim_start_matches(['\\', '"', ':', ' ']);
            parameter.strip_prefix("U32(default: ")?.chars().next()
        };
        let samples = pipeline.split("supersampling").skip(1).find_map(declared);
        assert!(samples.is_none_or(|samples| samples == '1'), "{name}, {}: {samples:?}", cell["pipeline"]);
        found += usize::from(samples.is_some());
    }
    assert!(found > 0, "{name}: no cell says how many samples a pixel has");
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
    folder.write("walk.ron", &walk);
    // Nothing flickers where nothing moves: sequences are the same in every frame.
    let still = walk.replace("-moving", "").replace("jump: 7,", "").replace("\"lag\", ", "");
    folder.write("still.ron", &still);
    let figures = |name: &str| -> BTreeMap<String, Option<f64>> {
        study(&folder, &[&format!("{name}.ron"), "-o", name]).success();
        let results = ::study::Results::read(&folder.at(name)).unwrap();
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
    folder.write("converged.ron", progressive);
    study(&folder, &["converged.ron", "-o", "out"]).success();
    let results = ::study::Results::read(&folder.at("out")).unwrap();
    // The same eight samples as the reference has: after one frame alone there would be two.
    assert_eq!(results.cells[0].measures["rel-mse"], Some(0.0), "{:?}", results.cells[0].measures);
}
