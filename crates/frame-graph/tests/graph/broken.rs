//! Broken files: the whole text of each error is kept.
//!
//! A file may begin with `// set: path=value`, `// ask: output` and `// keep: resource`, for what comes from
//! outside.

use super::kinds::{MemoryFiles, TestPassTypes, traits, value};
use frame_graph::codes::CODES;
use frame_graph::{CompileOptions, Diagnostics, LinkContext, Overrides, Source, compile, link, resolve};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/broken")
}

/// All files of the folder and of its sub-graphs, by their paths within it.
fn files() -> MemoryFiles {
    let mut files = MemoryFiles::default();
    for inner in ["", "parts"] {
        for entry in std::fs::read_dir(folder().join(inner)).unwrap().flatten() {
            let name = entry.file_name().into_string().unwrap();
            if name.ends_with(".ron") {
                let path = if inner.is_empty() { name } else { format!("{inner}/{name}") };
                let text = std::fs::read_to_string(entry.path()).unwrap();
                files.0.insert(path.clone(), Source::new(path, text));
            }
        }
    }
    files
}

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
    let files = files();
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
    let missing: Vec<&str> =
        CODES.iter().map(|code| code.code).filter(|code| !codes.contains(code)).collect();
    assert!(missing.is_empty(), "no broken file has the codes {missing:?}");
}

#[test]
fn colour_is_only_where_it_is_asked_for() {
    let files = files();
    let errors = errors_of("unknown-kind.ron", &files).unwrap();
    assert!(!errors.render(false).contains('\x1b'));
    assert!(errors.render(true).contains('\x1b'));
    assert_eq!(errors.0[0].labels[0].span.line_column(), (4, 30));
}
