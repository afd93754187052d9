//! Broken files: the whole text of each error is kept.
//!
//! A file may begin with `// set: path=value`, `// ask: output` and `// keep: resource`, for what comes from
//! outside.

use super::kinds::{MemoryFiles, TestPassTypes, files, traits, value};
use data_file::codes::CODES as TEXT_CODES;
use frame_graph::codes::CODES;
use frame_graph::{CompileOptions, Diagnostics, LinkContext, Overrides, compile, link, resolve};
use std::collections::BTreeSet;

fn errors_of(path: &str, files: &MemoryFiles) -> Option<Diagnostics> {
    let text = &files.0[path].text;
    let header = |key: &str| -> Vec<String> {
        text.lines().filter_map(|line| line.strip_prefix(&format!("// {key}: "))).map(str::to_owned).collect()
    };
    let overrides = header("set").into_iter().map(|set| {
        let (path, text) = set.split_once('=').unwrap();
        (path.to_owned(), value(text))
    });
    let overrides = Overrides(overrides.collect());
    let options =
        CompileOptions { outputs: header("ask"), keep: header("keep"), ..CompileOptions::default() };
    let context = LinkContext { frame: (1920, 1080), traits: traits() };
    // The other broken files are none that it could mean.
    let files =
        MemoryFiles(files.0.clone().into_iter().filter(|(p, _)| p.contains('/') || p == path).collect());
    let files = &files;
    let run =
        || compile(&link(&resolve(path, files, &overrides)?, &TestPassTypes::new(), &context)?, &options);
    run().err()
}

#[test]
fn every_broken_file_gives_its_errors() {
    let files = files("tests/broken");
    let mut codes = BTreeSet::new();
    let broken: Vec<&String> = files.0.keys().filter(|path| !path.contains('/')).collect();
    assert!(broken.len() >= 40, "there are {} broken files", broken.len());
    for path in broken {
        let errors = errors_of(path, &files).unwrap_or_else(|| panic!("{path} is not broken"));
        codes.extend(errors.0.iter().map(|error| error.code));
        insta::with_settings!({ prepend_module_to_snapshot => false, snapshot_path => "../snapshots", omit_expression => true }, {
            insta::assert_snapshot!(path.trim_end_matches(".ron"), errors.to_string());
        });
    }
    let missing: Vec<&str> = TEXT_CODES
        .iter()
        .chain(CODES)
        .map(|code| code.code)
        .filter(|code| code.starts_with('E'))
        .filter(|code| !codes.contains(code))
        .collect();
    assert!(missing.is_empty(), "no broken file has the codes {missing:?}");
}

#[test]
fn color_is_only_where_it_is_asked_for() {
    let files = files("tests/broken");
    let errors = errors_of("unknown-kind.ron", &files).unwrap();
    assert!(!errors.render(false).contains('\x1b'));
    assert!(errors.render(true).contains('\x1b'));
    assert_eq!(errors.0[0].labels[0].span.line_column(), (4, 30));
}
