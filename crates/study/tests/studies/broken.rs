//! Broken files: the whole text of each error is kept.

use super::fake::Shelf;
use frame_graph::{Diagnostics, Source};
use proptest::prelude::*;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::Duration;
use study::codes::{CODES, COLD};
use study::{Plan, parse};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/broken")
}

fn check(source: std::sync::Arc<Source>) -> Result<(), Diagnostics> {
    Plan::new(parse(source)?, &Shelf).map(|_| ())
}

#[test]
fn every_broken_file_gives_its_errors() {
    let mut codes = BTreeSet::new();
    let mut entries: Vec<PathBuf> =
        std::fs::read_dir(folder()).unwrap().flatten().map(|entry| entry.path()).collect();
    entries.sort();
    for path in &entries {
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let text = std::fs::read_to_string(path).unwrap();
        let errors = check(Source::new(format!("{name}.ron"), text))
            .err()
            .unwrap_or_else(|| panic!("{name} is not broken"));
        assert!(errors.0.iter().all(|error| !error.labels.is_empty()), "{errors}");
        codes.extend(errors.0.iter().map(|error| error.code));
        insta::with_settings!({ prepend_module_to_snapshot => false, snapshot_path => "../snapshots", omit_expression => true }, {
            insta::assert_snapshot!(name, errors.to_string());
        });
    }
    // A study of which only a warning is told is not broken.
    for code in CODES.iter().filter(|code| code.code != COLD.code) {
        assert!(codes.contains(code.code), "no file shows {}", code.code);
    }
}

const GOOD: &str = include_str!("good.ron");

#[test]
fn the_good_file_is_good() {
    check(Source::new("good.ron", GOOD)).unwrap_or_else(|errors| panic!("{errors}"));
}

const LIMIT: Duration = Duration::from_secs(20);

#[test]
fn large_studies_of_one_piece_and_of_many_names_are_refused_fast() {
    let mut texts: Vec<String> =
        mutation::large(1 << 20).into_iter().map(|(_, text)| text.to_string()).collect();
    texts.push("Study(a: ".repeat(50_000));
    let names = |of: &str| (0..20_000).map(|i| format!("\"{of}{i}\", ")).collect::<String>();
    texts.push(format!("Study(scenes: [{}], pipelines: [\"fast\"], measures: [\"rmse\"])", names("s")));
    texts.push(format!("Study(scenes: [\"box\"], pipelines: [{}], measures: [\"rmse\"])", names("p")));
    texts.push(format!("Study(scenes: [\"box\"], pipelines: [\"fast\"], measures: [{}])", names("m")));
    let axis: String = (0..20_000).map(|i| format!("\"a{i}\": [1, 2], ")).collect();
    texts.push(format!(
        "Study(scenes: [\"box\"], pipelines: [\"fast\"], vary: {{{axis}}}, measures: [\"rmse\"])"
    ));
    let values: String = (1..20_000).map(|i| format!("{i}, ")).collect();
    texts.push(format!("Study(scenes: [\"box\"], pipelines: [\"fast\"], vary: {{\"lights\": [{values}]}}, measures: [\"rmse\"])"));
    for text in texts {
        let start: String = text.chars().take(60).collect();
        let told = mutation::within(LIMIT, move || {
            check(Source::new("x.ron", text)).err().map(|errors| errors.to_string())
        });
        let told = told.unwrap_or_else(|| panic!("{start:?} is not broken"));
        assert!(told.contains("x.ron:") && told.len() < 300_000, "{start:?}: {} bytes", told.len());
    }
}

#[test]
fn names_are_looked_up_also_where_the_text_has_errors() {
    let text = "Study(scenes: [\"bax\"], pipelines: [\"fast\", \"fest\"], vary: Grid({\"lihgts\": [32]}), \
                budget: Frame(1), measures: [\"rmsee\"], seeds: [-1])";
    let told = study::parse_with(Source::new("x.ron", text), &Shelf).expect_err("it is broken");
    let codes: Vec<&str> = told.0.iter().map(|error| error.code).collect();
    assert_eq!(codes, ["T001", "T002", "T003", "E008", "T008", "T012"], "{told}");
    // Nothing is said about what stands in for what is missing or wrong.
    for (text, code) in [
        ("Study(pipelines: [\"fast\"], measures: [\"rmse\"])", "E004"),
        ("Study(scenes: 5, pipelines: [\"fast\"], measures: [\"rmse\"])", "E005"),
        ("Study(scenes: [\"box\"], pipelines: [7], measures: [\"rmse\"])", "E005"),
        (
            "Study(scenes: [\"box\"], pipelines: [\"fast\"], reference: Pipeline(\"a\", frames: 1), measures: [\"rmse\"])",
            "E001",
        ),
    ] {
        let told = study::parse_with(Source::new("x.ron", text), &Shelf).expect_err("it is broken");
        assert_eq!(told.0.iter().map(|error| error.code).collect::<Vec<_>>(), [code], "{told}");
    }
}

#[test]
fn studies_name_no_files_outside_of_their_folders() {
    for (scene, pipeline, picture, code) in [
        ("/etc/passwd", "fast", "a.exr", "T001"),
        ("../../../../../../../../../../scenes/box.ron", "fast", "a.exr", "T001"),
        ("box", "/other/x.ron", "a.exr", "T002"),
        ("box", "fast", "../../../../../../../../../../a.exr", "T013"),
    ] {
        let text = format!(
            "Study(scenes: [\"{scene}\"], pipelines: [\"{pipeline}\"], measures: [\"rmse\"], reference: Picture(\"{picture}\"))"
        );
        let told = check(Source::new("x.ron", text)).expect_err("it names a file elsewhere").to_string();
        assert!(told.contains(&format!("error[{code}]: the file `")) && told.contains("`--root`"), "{told}");
    }
    // What the command line gives is not asked about.
    let mut study = parse(Source::new("good.ron", GOOD)).expect("a good study");
    study
        .edit(&study::Edits { scenes: vec!["/elsewhere/box.ron".to_owned()], ..Default::default() })
        .expect("edits");
    let told = Plan::new(study, &Shelf).expect_err("there is no such scene").to_string();
    assert!(told.contains("/elsewhere/box.ron") && !told.contains("`--root`"), "{told}");
}

/// The studies of this tree, and the good one.
fn good() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../studies");
    let paths = std::fs::read_dir(folder).unwrap().flatten().map(|entry| entry.path());
    let mut texts: Vec<String> = paths
        .filter(|path| path.extension().is_some_and(|extension| extension == "ron"))
        .map(|path| std::fs::read_to_string(path).unwrap())
        .collect();
    texts.sort();
    // More often than the others, since the names in it are known.
    texts.extend(std::iter::repeat_n(GOOD.to_owned(), 10));
    texts
}

proptest! {
    #![proptest_config(mutation::config(400))]

    #[test]
    fn studies_with_edits(text in mutation::texts(good())) {
        let told = mutation::within(LIMIT, move || {
            check(Source::new("x.ron", text)).err().map(|errors| errors.to_string())
        });
        prop_assert!(told.is_none_or(|told| !told.is_empty()));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    /// A file that is cut, or has a piece put in, gives errors and never a panic.
    #[test]
    fn mutilated_files_never_panic(at in 0..GOOD.len(), length in 0..40usize, piece in "[(){}\\[\\]:,\"a-z0-9. -]{0,6}") {
        let (mut start, mut end) = (at, (at + length).min(GOOD.len()));
        while !GOOD.is_char_boundary(start) { start -= 1; }
        while !GOOD.is_char_boundary(end) { end += 1; }
        let text = format!("{}{piece}{}", &GOOD[..start], &GOOD[end..]);
        if let Err(errors) = check(Source::new("x.ron", text)) {
            prop_assert!(!errors.to_string().is_empty());
        }
    }
}
