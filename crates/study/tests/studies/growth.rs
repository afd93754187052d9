//! Claims of growth: exponents over an axis, over pixels, and over the triangles of scenes.

use super::fake::{Fake, done, plan, run};
use frame_graph::Source;
use std::fs;
use study::{Edits, Finding, Study, Verdict};

fn growing(fields: &str) -> Study {
    let text = format!("Study(pipelines: [\"fast\", \"exact\"], measures: [\"gpu-ms\"], {fields})");
    study::parse(Source::new("growth.ron", text)).unwrap_or_else(|errors| panic!("{errors}"))
}

/// The exponents, upper and whole.
fn exponents(finding: &Finding<'_>) -> [f64; 2] {
    [0, 1].map(|place| finding.means[place].expect("an exponent").mean)
}

/// Frames take 2 + 0.01 n ms: the lights of `fast` cost less than everything else.
const LIGHTS: &str =
    "scenes: [\"box\"], size: (8, 4), vary: Grid({ \"lights\": [4, 16, 64, 256, 1024, 4096] }), seeds: 3,
    claims: [
        Growth(measure: \"gpu-ms\", of: \"fast\", over: \"lights\", at_most: 1, says: \"one visit a light\"),
        Growth(measure: \"gpu-ms\", of: \"exact\", over: \"lights\", at_least: 0.95, at_most: 1.0),
        Growth(measure: \"gpu-ms\", of: \"fast\", over: \"lights\", at_most: 0.5),
    ]";

#[test]
fn exponents_are_those_of_the_upper_half() {
    let (folder, ran) = done(&plan(growing(LIGHTS)));
    let findings = ran.results.findings();
    let verdicts: Vec<Option<Verdict>> = findings.iter().map(|finding| finding.verdict).collect();
    assert_eq!(verdicts, [Some(Verdict::Holds), Some(Verdict::Holds), Some(Verdict::Fails)]);
    // Of `fast`, the slope of ln 4.56, ln 12.24 and ln 42.96 over three powers of four.
    let [upper, whole] = exponents(&findings[0]);
    assert!((upper - (42.96_f64 / 4.56).ln() / 16_f64.ln()).abs() < 1e-6, "{upper}");
    assert!(whole < 0.5 && findings[0].means[0].unwrap().seeds == 3, "{whole}");
    study::report(&ran.results, folder.path()).unwrap();
    let table = fs::read_to_string(folder.path().join("tables/claims.md")).unwrap();
    assert!(table.contains(
        "| GPU time: exponent of fast over lights ≤ 1 | one visit a light | box | 0.8090; whole 0.4325 | holds |"
    ), "{table}");
    assert!(table.contains("| GPU time: 0.95 ≤ exponent of exact over lights ≤ 1 |"), "{table}");
    assert!(table.contains("An exponent is that of the upper half of its axis"), "{table}");
}

#[test]
fn fewer_values_than_three_are_not_measured() {
    let mut study = growing(LIGHTS);
    study.edit(&Edits { quick: true, ..Edits::default() }).unwrap();
    let (_folder, ran) = done(&plan(study));
    assert!(ran.results.findings().iter().all(|finding| finding.verdict.is_none()));
}

/// A size counts as its pixels; the time of a frame does not depend on them here.
#[test]
fn sizes_are_pixels() {
    let folder = tempfile::tempdir().unwrap();
    let study = growing(
        "scenes: [\"box\"], vary: Grid({ \"size\": [(4, 4), (8, 8), (16, 8)] }),
         claims: [Growth(measure: \"gpu-ms\", of: \"fast\", over: \"size\", at_most: 0.1)]",
    );
    let results = run(&plan(study), &mut Fake::default(), folder.path()).unwrap().results;
    assert_eq!(results.findings()[0].verdict, Some(Verdict::Holds));
    assert_eq!(exponents(&results.findings()[0]), [0.0, 0.0]);
}

/// Over triangles there is one result for all scenes that the claim is about.
#[test]
fn triangles_are_those_of_the_scenes() {
    let study = growing(
        "scenes: [\"box\", \"grid-1000\", \"grid-4000\", \"grid-16000\"], size: (8, 4),
         claims: [
            Growth(measure: \"gpu-ms\", of: \"exact\", over: \"triangles\", at_least: 0.9,
                scenes: [\"grid-1000\", \"grid-4000\", \"grid-16000\"]),
            Growth(measure: \"gpu-ms\", of: \"fast\", over: \"triangles\", at_most: 0.1),
         ]",
    );
    let (folder, ran) = done(&plan(study));
    let findings = ran.results.findings();
    assert_eq!(findings.len(), 2);
    assert_eq!(findings[0].scenes, ["grid-1000", "grid-4000", "grid-16000"]);
    // 108.4, 408.4 and 1608.4 ms.
    let [upper, _] = exponents(&findings[0]);
    assert!((upper - (1608.4_f64 / 108.4).ln() / 16_f64.ln()).abs() < 1e-6, "{upper}");
    assert!(findings.iter().all(|finding| finding.verdict == Some(Verdict::Holds)));
    study::report(&ran.results, folder.path()).unwrap();
    let table = fs::read_to_string(folder.path().join("tables/claims.md")).unwrap();
    assert!(table.contains("| grid-1000 to grid-16000 |"), "{table}");
}
