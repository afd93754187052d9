//! Studies in jobs of a batch system: a Snakefile, its jobs by hand and by Snakemake.

#[cfg(target_os = "linux")]
mod slurm;

use crate::adapter::root;
use crate::program::{Done, Folder, command_of_tree};
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

/// 40 cells that take a third of a second each, of which a quarter is a job of 1.5 minutes while nothing is known of their cost.
const SMALL: &str = r#"Study(
    about: "Small",
    scenes: ["cornell-box"],
    pipelines: ["ism", "ism-uniform"],
    size: (16, 16),
    set: { "rsm.size": 32, "map": 32, "shadows.points": Optional(4096) },
    vary: Grid({ "lights": [8, 16, 32, 64] }),
    budget: Frames(2),
    seeds: 5,
    measures: ["rel-mse", "energy", "gpu-ms", "memory"],
    reference: Pipeline(pipeline: "reference", set: { "samples": 8 }),
)"#;

/// A few of the cells, for what every test runs.
const FEW: &[&str] = &["--seeds", "2"];

fn study(folder: &Path, arguments: &[&str]) -> Done {
    Done::of(command_of_tree(folder).arg("study").args(arguments))
}

/// Returns a folder with the study in it.
fn folder() -> Option<Folder> {
    Folder::with_gpu(&[("small.ron", SMALL)])
}

/// Writes the Snakefile of the study, and returns its path and text.
fn snakefile(folder: &Folder, arguments: &[&str]) -> (String, String) {
    let done = study(folder, &[&["small.ron", "--snakefile"], arguments].concat()).success();
    assert!(done.err.contains("nothing is known of the costs of cells"), "{done}");
    let path = done.out.trim_end().to_owned();
    let text = folder.read(&path);
    (path, text)
}

/// Writes the records of a study without times, clocks and nodes, and its report again.
fn without_times(folder: &Path) {
    let edit = |path: PathBuf, edit: &dyn Fn(&mut Value)| {
        let mut value: Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
        edit(&mut value);
        fs::write(path, value.to_string()).unwrap();
    };
    let all = |name: &str| {
        let entries = fs::read_dir(folder.join(name)).unwrap().map(|entry| entry.unwrap().path());
        entries.filter(|path| path.extension().is_some_and(|extension| extension == "json"))
    };
    for path in all("cells") {
        edit(path, &|cell| {
            cell["seconds"] = json!(0.0);
            (cell["node"]["host"], cell["node"]["clock"]) = (json!("node"), json!(""));
            cell["measures"]["gpu-ms"] = json!(1.0);
            cell["passes"].as_array_mut().unwrap().iter_mut().for_each(|pass| pass["gpu_ms"] = json!(1.0));
        });
    }
    for path in all("references") {
        edit(path, &|reference| reference["seconds"] = json!(0.0));
    }
    edit(folder.join("study.json"), &|study| {
        study["started"] = json!("");
        study["references"].as_array_mut().unwrap().iter_mut().for_each(|one| one["seconds"] = json!(0.0));
    });
}

/// Checks that two folders have the same pictures, tables and report in all but times.
fn assert_alike(folder: &Folder, one: &str, other: &str) {
    for name in [one, other] {
        without_times(&folder.at(name));
        study(folder, &["merge", name, "-o", name]).success();
    }
    for part in ["cells", "images", "references", "figures", "tables"] {
        let names = |name: &str| -> Vec<_> {
            let entries = fs::read_dir(folder.at(name).join(part)).unwrap();
            let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name()).collect();
            names.sort();
            names
        };
        assert_eq!(names(one), names(other), "{part}");
        for name in names(one) {
            let path = Path::new(part).join(&name);
            let read = |folder_name: &str| fs::read(folder.at(folder_name).join(&path)).unwrap();
            assert!(read(one) == read(other), "{} differs", path.display());
        }
    }
    for file in ["report.html", "cells.csv", "summary.csv", "frames.csv"] {
        let read = |name: &str| fs::read_to_string(folder.at(name).join(file)).unwrap();
        assert_eq!(read(one), read(other), "{file}");
    }
}

/// Returns the places in a table of jobs of a Snakefile.
fn places(text: &str, table: &str) -> Vec<String> {
    let (_, rest) = text.split_once(&format!("{table} = {{")).expect("the table");
    let (body, _) = rest.split_once('}').expect("its end");
    body.lines().filter_map(|line| Some(line.trim().split('"').nth(1)?.to_owned())).collect()
}

/// The jobs of a Snakefile, one by one in the reverse order, and one of them twice, give what one process gives.
#[test]
fn jobs_of_a_snakefile_give_the_report_of_one_process() {
    let Some(folder) = folder() else { return };
    let (path, text) = snakefile(&folder, &[FEW, &["--shard-minutes", "0.7"]].concat());
    assert_eq!(path, "small.smk");
    for rule in ["report", "references", "shard"] {
        assert!(text.contains(&format!("\nrule {rule}:\n")), "{rule}: {text}");
    }
    assert_eq!(text.matches("\nrule ").count(), 3);
    let (references, cells) = (places(&text, "REFERENCES"), places(&text, "CELLS"));
    assert_eq!(
        (&references[..], &cells[..]),
        (&["1-1".to_owned()][..], &["1-4", "5-8", "9-12", "13-16"].map(str::to_owned)[..])
    );
    let job = |shard: &str| study(&folder, &[&["small.ron", "-o", "jobs", "--shard", shard], FEW].concat());
    job("references:1-1/1").success();
    for places in cells.iter().rev().chain(&cells[..1]) {
        job(&format!("cells:{places}/16")).success().says(&["4 of 16 cells are of this shard"]);
    }
    assert!(!folder.at("jobs/report.html").exists(), "a job writes no report");
    study(&folder, &[&["small.ron", "-o", "one"], FEW].concat()).success();
    assert_alike(&folder, "one", "jobs");
    // Places of another study, and costs that change while shards are cut by them.
    job("cells:1-9/39").failure(1, &["with 39 cells, and this one has 16"]);
    let costs = ["small.ron", "-o", "jobs", "--shard", "1/2", "--costs", "jobs"];
    study(&folder, &costs).failure(1, &["each would cut others"]);
}

/// Costs of a run cut the jobs.
#[test]
fn costs_of_a_run_cut_the_jobs() {
    let Some(folder) = folder() else { return };
    let timing = study(&folder, &["small.ron", "-o", "timing", "--timing", "--json"]).success().json();
    assert_eq!(timing["cells"], 4, "one seed, both ends of the axis: {timing}");
    for entry in fs::read_dir(folder.at("timing/cells")).unwrap() {
        let path = entry.unwrap().path();
        let mut cell: Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
        cell["seconds"] = json!(if cell["pipeline"] == "ism" { 30.0 } else { 90.0 });
        fs::write(&path, cell.to_string()).unwrap();
    }
    study(
        &folder,
        &[
            "small.ron",
            "--snakefile=jobs.smk",
            "--costs",
            "timing",
            "--set",
            "map=32",
            "--shard-minutes",
            "10",
        ],
    )
    .success();
    let text = folder.read("jobs.smk");
    // 20 cells of half a minute and 20 of one and a half: 40 minutes.
    assert_eq!(places(&text, "CELLS"), ["1-20", "21-27", "28-33", "34-40"], "{text}");
    assert!(text.contains("\"1-20\": 10.0,"), "{text}");
    assert!(text.contains("\"study\", \"small.ron\", \"--set\", \"map=32\", \"-o\", OUT"), "{text}");
}

/// The costs of a run give the time of the whole study on several GPUs, also if it had less work.
#[test]
fn costs_of_a_run_give_the_time_on_several_gpus() {
    let Some(folder) = folder() else { return };
    let timed = |out: &str, more: &[&str], (cell, reference): (f64, f64)| {
        study(&folder, &[&["small.ron", "-o", out, "--timing"], more].concat()).success();
        for (part, seconds) in [("cells", cell), ("references", reference)] {
            for entry in fs::read_dir(folder.at(out).join(part)).unwrap() {
                let path = entry.unwrap().path();
                if path.extension().is_some_and(|extension| extension == "json") {
                    let mut record: Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
                    record["seconds"] = json!(seconds);
                    fs::write(&path, record.to_string()).unwrap();
                }
            }
        }
        let name = format!("{out}/study.json");
        let mut record: Value = serde_json::from_str(&folder.read(&name)).unwrap();
        record["references"] = json!([]);
        folder.write(&name, &record.to_string());
        study(&folder, &["costs", out]).success()
    };
    // 40 cells of ten minutes in 20 shards, after a reference of twenty minutes: 21, 4 and 2 times twenty minutes. With twice
    // the cells, 41, 6 and 2 times. Both ends of the axis, of two pipelines, were measured.
    timed("timing", &[], (600.0, 1200.0))
        .says(&["| small | 40 | 20 | 1 | 1 | 7 h | 80 min | 40 min | 0.97 | 0.58 | 0.00 |"]);
    // The same by a run with a quarter of the pixels, and two of three frames (the first is not measured) or half the samples.
    let less = ["--size", "8x8", "--frames", "1", "--set-reference", "samples=4"];
    timed("less", &less, (100.0, 150.0))
        .says(&["| small | 40 | 0 | 1 | 0 | 7 h | 80 min | 40 min | 0.97 | 0.58 | 0.00 |"]);
    study(&folder, &["costs", "nowhere"]).failure(1, &["there is no study here"]);
}

/// Installs Snakemake and Slurm, once, where the environment allows it.
fn install() {
    static DONE: std::sync::Once = std::sync::Once::new();
    if std::env::var_os("LIGHTLOOM_CLUSTER_SETUP").is_some_and(|value| value == "1") {
        DONE.call_once(|| {
            let done = Done::of(&mut Command::new(root().join("tests/cluster/install.sh")));
            if done.code != Some(0) {
                eprintln!("tests/cluster/install.sh failed: {done}");
            }
        });
    }
}

/// Returns the program Snakemake: that of LIGHTLOOM_SNAKEMAKE, of the path, or of `tests/cluster/install.sh`; `None`, with the
/// reason on standard error, where there is none.
fn snakemake() -> Option<PathBuf> {
    install();
    let installed = root().join("target/cluster/venv/bin/snakemake");
    let mut candidates = vec![PathBuf::from("snakemake"), installed];
    if let Ok(named) = std::env::var("LIGHTLOOM_SNAKEMAKE") {
        candidates.insert(0, named.into());
    }
    let works = |path: &PathBuf| {
        Command::new(path).arg("--version").output().is_ok_and(|output| output.status.success())
    };
    let found = candidates.into_iter().find(works);
    if found.is_none() {
        eprintln!("skipped: there is no Snakemake; tests/cluster/install.sh installs it");
    }
    found
}

/// The real Snakemake runs the file, two jobs at a time.
#[test]
fn snakemake_gives_the_report_of_one_process() {
    let Some(snakemake) = snakemake() else { return };
    let Some(folder) = folder() else { return };
    let (path, _) = snakefile(&folder, &["--shard-minutes", "1.5"]);
    let mut command = Command::new(snakemake);
    command.args(["-c2", "--snakefile", &path, "--config", "out=out/snake"]).current_dir(&*folder);
    Done::of(&mut command).success();
    assert!(folder.at("out/snake/report.html").is_file());
    study(&folder, &["small.ron", "-o", "one"]).success();
    assert_alike(&folder, "one", "out/snake");
    eprintln!("ran: Snakemake on this machine");
}

/// The adapter is chosen by place or name; `--workers` takes as many as there are.
#[test]
fn an_adapter_is_chosen_and_workers_share_the_machine() {
    let Some(folder) = folder() else { return };
    let run = |out: &str, more: &[&str]| study(&folder, &[&["small.ron", "-o", out], FEW, more].concat());
    run("none", &["--adapter", "no such"]).failure(1, &["there is no adapter `no such`; there are: 0: "]);
    run("none", &["--adapter", "99"]).failure(1, &["there is no adapter `99`"]);
    run("none", &["--workers", "99"]).failure(1, &["--workers 99 needs as many adapters"]);
    run("one", &["--adapter", "0"]).success();
    let record: Value = serde_json::from_str(&folder.read("one/study.json")).unwrap();
    let name = record["adapter"].as_str().unwrap().split(" (").next().unwrap().to_uppercase();
    run("one", &["--adapter", &name]).success().says(&["16 of 16 cells are finished already"]);
    run("workers", &["--workers", "1"]).success().says(&["adapter 0: 4/4 "]);
    assert_alike(&folder, "one", "workers");
}

/// A second driver file of Mesa's lavapipe is a second adapter.
#[cfg(target_os = "linux")]
#[test]
fn two_workers_run_on_two_adapters() {
    let driver = Path::new("/usr/share/vulkan/icd.d/lvp_icd.x86_64.json");
    let Some(folder) = folder().filter(|_| driver.is_file()) else {
        eprintln!("skipped: there is no lavapipe to list twice");
        return;
    };
    let second = folder.at("second.json");
    fs::copy(driver, &second).unwrap();
    let drivers = std::env::join_paths([driver, second.as_path()]).unwrap();
    let mut command = command_of_tree(&folder);
    command.args(["study", "small.ron", "-o", "workers", "--workers", "2"]).args(FEW);
    let done = Done::of(command.env("VK_ICD_FILENAMES", drivers)).success();
    done.says(&["adapter 0: ", "adapter 1: "]);
    study(&folder, &[&["small.ron", "-o", "one", "--adapter", "llvmpipe"], FEW].concat()).success();
    assert_alike(&folder, "one", "workers");
}

/// A process that dies in the middle of a picture leaves no row of that cell; the next removes the rest of the picture.
#[cfg(unix)]
#[test]
fn a_worker_killed_while_it_writes_leaves_no_row() {
    let growing = r#"Study(
        scenes: ["cornell-box"], pipelines: ["ism-uniform"], set: { "rsm.size": 32, "lights": 8 },
        vary: Grid({ "size": [(16, 12), (800, 600)] }), budget: Frames(1), measures: ["gpu-ms"],
    )"#;
    let Some(folder) = Folder::with_gpu(&[("growing.ron", growing)]) else { return };
    let names = |part: &str, end: &str| -> Vec<String> {
        let entries = fs::read_dir(folder.at("out").join(part)).into_iter().flatten();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        names.filter(|name| name.ends_with(end)).collect()
    };
    let shard = ["study", "growing.ron", "-o", "out", "--shard", "1/1"];
    // The large picture is written for tens of milliseconds; a machine may be too slow to see that at once.
    let killed = (0..20).any(|_| {
        let mut command = command_of_tree(&folder);
        let mut child = command.args(shard).stderr(Stdio::null()).stdout(Stdio::null()).spawn().unwrap();
        while child.try_wait().unwrap().is_none() {
            if names("cells", ".json").len() == 1 && !names("images", ".part").is_empty() {
                child.kill().unwrap();
            }
            std::thread::sleep(Duration::from_micros(200));
        }
        let is_in_the_middle = names("cells", ".json").len() == 1 && !names("images", ".part").is_empty();
        if !is_in_the_middle {
            fs::remove_dir_all(folder.at("out")).unwrap();
        }
        is_in_the_middle
    });
    assert!(killed, "no process was seen to write in twenty runs");
    let again = Done::of(command_of_tree(&folder).args(shard)).success();
    again.says(&["2 of 2 cells are of this shard; 1 ran now"]);
    assert_eq!((names("cells", ".json").len(), names("images", ".part").len()), (2, 0));
    assert_eq!(names("images", ".exr").len(), 2);
}

/// A disk that is full in the middle of a study: rows are whole, and the same command goes on once there is room.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_whole_rows() {
    let Some(folder) = folder() else { return };
    let disk = folder.at("disk");
    fs::create_dir(&disk).unwrap();
    let mount = |options: &str| {
        let mut command = Command::new("mount");
        command.args(["-t", "tmpfs", "-o", options, "tmpfs"]).arg(&disk);
        command.output().is_ok_and(|output| output.status.success())
    };
    if !mount("size=400k") {
        eprintln!("skipped: a small disk takes root, to mount it");
        return;
    }
    let run = || study(&folder, &[&["small.ron", "-o", "disk/out", "--shard", "1/1"], FEW].concat());
    let full = run();
    let count = || {
        let rows =
            fs::read_dir(disk.join("out/cells")).into_iter().flatten().map(|entry| entry.unwrap().path());
        let rows = rows.filter(|path| path.extension().is_some_and(|extension| extension == "json"));
        let rows: Vec<Value> =
            rows.map(|path| serde_json::from_slice(&fs::read(path).unwrap()).unwrap()).collect();
        rows.len()
    };
    let before = count();
    let grown = mount("remount,size=64m");
    let again = run();
    let after = count();
    // Before anything is checked, since a mounted folder cannot be removed.
    let copied = Done::of(Command::new("cp").arg("-r").arg(disk.join("out")).arg(folder.at("out")));
    Done::of(Command::new("umount").arg(&disk)).success();
    full.failure(1, &["No space left on device", "what is finished is kept"]);
    assert!(grown && (1..16).contains(&before), "{before} rows on a full disk");
    again.success().says(&[&format!("{} ran now", 16 - before)]);
    assert_eq!(after, 16);
    copied.success();
    study(&folder, &["merge", "out", "-o", "out"]).success();
    study(&folder, &[&["small.ron", "-o", "one"], FEW].concat()).success();
    assert_alike(&folder, "one", "out");
    eprintln!("ran: a full disk");
}
