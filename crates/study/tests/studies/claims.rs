//! What the paper says, beside what was measured.

use super::fake::{Fake, done, parse, plan, run, told};
use frame_graph::Source;
use std::fs;
use study::{AxisValue, Edits, Finding, Results, RunOptions, Study, Verdict};

/// Times of a frame with 16 and 64 lights: `fast` 2.16 and 2.64 ms, on average 2.4; `slow` 3.6 and 8.4, on average 6.
fn claiming(claims: &str) -> Study {
    let text = format!(
        "Study(scenes: [\"box\"], pipelines: [\"fast\", Variant(name: \"slow\", pipeline: \"exact\"), \"nan\"],
            size: (8, 4), vary: Grid({{ \"lights\": [16, 64], \"map\": Optional([32, 64]) }}), seeds: 2,
            measures: [\"gpu-ms\", \"memory\"], phases: {{ \"rays\": [\"rays\"] }}, claims: [{claims}])"
    );
    study::parse(Source::new("claims.ron", text)).unwrap_or_else(|errors| panic!("{errors}"))
}

const CLAIMS: &str = "
    Order(measure: \"gpu-ms\", rising: [\"fast\", \"slow\"], says: \"TCAS Tab. 1\"),
    Order(measure: \"gpu-ms\", rising: [\"slow\", \"fast\"]),
    Order(measure: \"memory\", rising: [\"fast\", \"slow\"]),
    Ratio(measure: \"gpu-ms\", of: \"fast\", to: \"slow\", at_most: 0.41, at_least: 0.39),
    Ratio(measure: \"gpu-ms\", of: \"fast\", to: \"slow\", at_most: 0.39),
    Ratio(measure: \"gpu-ms\", of: \"fast\", to: \"slow\", at_most: 0.32, at: { \"lights\": 64, \"map\": 32 }),
    Ratio(measure: \"gpu-ms\", of: At(\"slow\", { \"lights\": 64 }), to: At(\"slow\", { \"lights\": 16 }), at_least: 2.3),
    Order(measure: \"gpu-ms\", rising: [\"fast\", \"nan\"]),
    Ratio(measure: \"gpu-ms:rays\", of: \"fast\", to: \"slow\", at_most: 1),
    Bound(measure: \"gpu-share:rays\", of: \"slow\", at_least: 0.6, at_most: 0.61)";

fn means(finding: &Finding<'_>) -> Vec<Option<f64>> {
    finding.means.iter().map(|mean| mean.map(|mean| (mean.mean * 1e9).round() / 1e9)).collect()
}

#[test]
fn claims_are_checked_on_means_over_cells() {
    let (_folder, ran) = done(&plan(claiming(CLAIMS)));
    let findings = ran.results.findings();
    let verdicts: Vec<Option<Verdict>> = findings.iter().map(|finding| finding.verdict).collect();
    let (yes, no) = (Some(Verdict::Holds), Some(Verdict::Fails));
    // An order is strict: both take 3 MiB.
    assert_eq!(verdicts, [yes, no, no, yes, no, yes, yes, None, None, yes]);
    assert_eq!(means(&findings[0]), [Some(2.4), Some(6.0)]);
    assert!((findings[3].ratio().unwrap() - 0.4).abs() < 1e-12);
    // `slow` has no maps, so that it is there at any size of them.
    assert_eq!(means(&findings[5]), [Some(2.64), Some(8.4)]);
    assert_eq!(means(&findings[6]), [Some(8.4), Some(3.6)]);
    assert_eq!(
        means(&findings[7]),
        [Some(2.4), None],
        "cells that failed take no part, though `nan` was timed"
    );
    assert_eq!(means(&findings[8]), [None, Some(4.0)], "`fast` has no rays");
    // 1.6 of 3.6 ms and 6.4 of 8.4.
    assert_eq!(means(&findings[9]), [Some(0.603174603)]);
    assert_eq!(findings[0].claim.says, "TCAS Tab. 1");
}

#[test]
fn report_and_page_show_what_holds() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let ran = run(&plan(claiming(CLAIMS)), &mut Fake::default(), folder.path()).unwrap();
    let files = study::report(&ran.results, folder.path()).unwrap();
    assert!(files.contains(&at("tables/claims.md")) && files.contains(&at("tables/claims.tex")));
    let read = |name: &str| fs::read_to_string(at(name)).unwrap();
    let table = read("tables/claims.md");
    let lines: Vec<&str> = table.lines().collect();
    assert_eq!(
        lines[0],
        "Claims: 5 of 10 hold, 2 are not measured. Each is about means over all finished cells of a scene; it is decided where the \
         95 % interval of the difference, seed by seed, is on one side."
    );
    assert_eq!(lines[2], "| Claim | From | Scene | Measured | Result |");
    assert_eq!(lines[4], "| GPU time: fast \\< slow | TCAS Tab. 1 | box | 2.400, 6 ms | holds |");
    assert_eq!(lines[5], "| GPU time: slow \\< fast |  | box | 6, 2.400 ms | **does not hold** |");
    assert_eq!(
        lines[7],
        "| GPU time: 0.39 × slow ≤ fast ≤ 0.41 × slow |  | box | 2.400 / 6 ms = 0.4000 | holds |"
    );
    assert_eq!(
        lines[9],
        "| GPU time: fast ≤ 0.32 × slow, lights = 64, map = 32 |  | box | 2.640 / 8.400 ms = 0.3143 | holds |"
    );
    assert_eq!(
        lines[10],
        "| GPU time: slow (lights = 64) ≥ 2.3 × slow (lights = 16) |  | box | 8.400 / 3.600 ms = 2.333 | holds |"
    );
    assert_eq!(lines[12], "| rays: fast ≤ slow |  | box | – / 4 ms | not measured |");
    assert_eq!(lines[13], "| share of rays: 0.6 ≤ slow ≤ 0.61 |  | box | 0.6032 | holds |");
    let page = read("report.html");
    assert!(page.contains("<a href=\"#claims\">Claims</a>"));
    assert!(page.contains("<td class=failed><b>does not hold</b></td>"));
    let latex = read("tables/claims.tex");
    assert!(latex.contains("fast $\\le$ 0.32 $\\times$ slow") && latex.contains("\\textbf{does not hold}"));
    let pages = study::publish(&[folder.path().to_owned()], &at("pages")).unwrap();
    assert_eq!(pages, [at("pages/claims.md")]);
    assert!(read("pages/claims.md").contains(lines[4]));
}

/// The reason that a study states is shown where its claim does not hold, and nowhere else.
#[test]
fn reasons_stand_beside_what_does_not_hold() {
    let claims = "
        Order(measure: \"gpu-ms\", rising: [\"fast\", \"slow\"], because: \"rays wait\"),
        Order(measure: \"gpu-ms\", rising: [\"slow\", \"fast\"], because: \"memory is slow\"),
        Order(measure: \"memory\", rising: [\"fast\", \"slow\"])";
    let (folder, ran) = done(&plan(claiming(claims)));
    let findings = ran.results.findings();
    let reasons: Vec<Option<&str>> = findings.iter().map(Finding::reason).collect();
    assert_eq!(reasons, [None, Some("memory is slow"), None]);
    study::report(&ran.results, folder.path()).unwrap();
    let table = fs::read_to_string(folder.path().join("tables/claims.md")).unwrap();
    let ends: Vec<&str> =
        table.lines().skip(4).map(|line| line.rsplit_once("ms |").map_or(line, |end| end.1)).collect();
    assert!(ends[0].ends_with("holds |  |"), "{table}");
    assert!(ends[1].ends_with("**does not hold** | memory is slow |"), "{table}");
}

#[test]
fn other_claims_run_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let begin = |claims: &str| {
        let plan = plan(claiming(claims));
        told(&plan, &mut Fake::default(), folder.path(), &RunOptions::default()).remove(0)
    };
    let first = "Order(measure: \"gpu-ms\", rising: [\"fast\", \"slow\"])";
    assert_eq!(begin(first), "begin 20 0 0");
    // `nan` fails each time.
    assert_eq!(begin(CLAIMS), "begin 20 12 0");
    let claims = Results::read(folder.path()).unwrap().study.claims;
    let (_, map) = claims[5].at.iter().find(|(axis, _)| axis.value == "map").unwrap();
    assert_eq!((claims.len(), &map.value), (10, &AxisValue::Number(32.0)));
}

/// A run with other values leaves claims about those of the file unmeasured.
#[test]
fn what_was_not_run_is_not_measured() {
    let claim = "Ratio(measure: \"gpu-ms\", of: \"fast\", to: \"slow\", at_most: 1, at: { \"lights\": 64 })";
    let holds = |edits: &Edits| {
        let folder = tempfile::tempdir().unwrap();
        let mut study = claiming(claim);
        study.edit(edits).unwrap();
        run(&plan(study), &mut Fake::default(), folder.path()).unwrap().results.findings()[0].verdict
    };
    assert_eq!(
        holds(&Edits { quick: true, ..Edits::default() }),
        Some(Verdict::Holds),
        "64 is the last value"
    );
    let other = vec![("lights".to_owned(), AxisValue::Number(9.0))];
    assert_eq!(holds(&Edits { set: other, ..Edits::default() }), None);
}

#[test]
fn a_claim_may_be_about_some_scenes() {
    let text = "Study(scenes: [\"box\", \"walk\"], pipelines: [\"fast\", \"exact\"], size: (8, 4), measures: [\"gpu-ms\"],
        claims: [
            Order(measure: \"gpu-ms\", rising: [\"fast\", \"exact\"]),
            Order(measure: \"gpu-ms\", rising: [\"fast\", \"exact\"], scenes: [\"walk\"]),
        ])";
    let study = parse(text);
    let (folder, ran) = done(&plan(study.clone()));
    let scenes: Vec<&str> = ran.results.findings().iter().map(|finding| finding.scenes[0]).collect();
    assert_eq!(scenes, ["box", "walk", "walk"]);
    // A run on another scene has nothing to say of it.
    let mut other = study;
    other.edit(&Edits { scenes: vec!["box".to_owned()], ..Edits::default() }).unwrap();
    let ran = run(&plan(other), &mut Fake::default(), folder.path()).unwrap();
    assert_eq!(ran.results.findings().len(), 1);
}

/// A claim at a size names it as the axis does.
#[test]
fn sizes_are_picked_too() {
    let text = "Study(scenes: [\"box\"], pipelines: [\"fast\"], vary: Grid({ \"size\": [(8, 4), (4, 4)] }),
        measures: [\"gpu-ms\"],
        claims: [Ratio(measure: \"gpu-ms\", of: At(\"fast\", { \"size\": (8, 4) }), to: At(\"fast\", { \"size\": (4, 4) }), at_most: 1)])";
    let plan = plan(parse(text));
    let (_folder, ran) = done(&plan);
    assert_eq!(ran.results.findings()[0].verdict, Some(Verdict::Holds));
}
