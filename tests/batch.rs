//! Studies in jobs of a batch system: a Snakefile, its jobs by hand and by Snakemake.

use crate::adapter::root;
use crate::program::{Done, Folder, command_of_tree};
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

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

/// Returns the program Snakemake: of the path, or of what `tests/cluster/install.sh` installed.
fn snakemake() -> Option<PathBuf> {
    let installed = root().join("target/cluster/venv/bin/snakemake");
    let mut candidates = vec![PathBuf::from("snakemake"), installed];
    if let Ok(named) = std::env::var("LIGHTLOOM_SNAKEMAKE") {
        candidates.insert(0, named.into());
    }
    let works = |path: &PathBuf| {
        Command::new(path).arg("--version").output().is_ok_and(|output| output.status.success())
    };
    candidates.into_iter().find(works)
}

/// The real Snakemake runs the file, two jobs at a time.
#[test]
fn snakemake_gives_the_report_of_one_process() {
    let Some(snakemake) = snakemake() else {
        eprintln!("skipped: there is no Snakemake; tests/cluster/install.sh installs it");
        return;
    };
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
