//! `lightloom reproduce`: the findings of a paper.

use crate::program::{Done, Folder, command, run_in};

const STUDY: &str = r#"Study(
    about: "Light is there",
    paper: "TCAS Fig. 99",
    scenes: ["cornell-box"],
    pipelines: ["ism-ray-traced"],
    output: "indirect",
    size: (96, 96),
    set: { "rsm.size": 64 },
    vary: Grid({ "lights": [8, 32, 1024] }),
    budget: Frames(1),
    seeds: 4,
    measures: ["rel-mse", "energy"],
    reference: Pipeline(pipeline: "reference", set: { "bounces": 1, "samples": 64 }),
    claims: [
        Bound(measure: "energy", of: "ism-ray-traced", at_least: 0.02, at_most: 20, says: "neither dark nor all light"),
        Bound(measure: "energy", of: "ism-ray-traced", at_least: 40, says: "forty times the light"),
    ],
)"#;

#[test]
fn each_finding_has_a_line() {
    let Some(folder) = Folder::with_gpu(&[("studies/tcas-fig-99.ron", STUDY)]) else { return };
    let of = |more: &[&str]| {
        let mut command = command(folder.at("").as_path());
        Done::of(
            command
                .args(["--root", ".", "reproduce", "tcas", "--only", "tcas-fig-99", "-o", "out"])
                .args(more),
        )
    };
    let done = of(&["--json"]).success();
    let found = done.json()["findings"].clone();
    let verdicts: Vec<&str> =
        found.as_array().unwrap().iter().map(|finding| finding["verdict"].as_str().unwrap()).collect();
    assert_eq!(verdicts, ["holds", "fails"], "{found:#}");
    assert_eq!(found[0]["where"], "TCAS Fig. 99");
    let page = folder.read("out/findings.md");
    for words in ["TCAS Fig. 99", "neither dark nor all light", "forty times the light", "does not hold"] {
        assert!(page.contains(words), "no `{words}` in {page}");
    }
    assert!(folder.at("out/tcas-fig-99/report.html").exists());
    // Nothing runs again, and a paper's finding that does not hold is no failure.
    of(&[]).success().says(&["1 of 2 findings hold, 1 do not, 0 are not decided", "out/findings.md"]);
    of(&["--list"]).success().says(&["tcas-fig-99", "TCAS Fig. 99: Light is there"]);
}

#[test]
fn papers_and_studies_that_there_are_not_are_told() {
    let Some(folder) = Folder::with_gpu(&[]) else { return };
    let of = |arguments: &[&str]| run_in(folder.at("").as_path(), &[&["reproduce"], arguments].concat());
    of(&["tcsa"]).failure(1, &["there is no paper `tcsa`; did you mean `tcas`?"]);
    of(&["ism", "--only", "ism-fig-44"])
        .failure(1, &["no study of ISM `ism-fig-44`; did you mean `ism-fig-4`?"]);
    of(&["ism", "--only", "tcas-fig-7"]).failure(1, &["no study of ISM `tcas-fig-7`"]);
}
