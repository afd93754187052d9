//! Broken files: the whole text of each error is kept.

use super::fake::Shelf;
use frame_graph::codes::study::CODES;
use frame_graph::{Diagnostics, Source};
use proptest::prelude::*;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
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
    for code in CODES {
        assert!(codes.contains(code.code), "no file shows {}", code.code);
    }
}

const GOOD: &str = include_str!("good.ron");

#[test]
fn the_good_file_is_good() {
    check(Source::new("good.ron", GOOD)).unwrap_or_else(|errors| panic!("{errors}"));
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
