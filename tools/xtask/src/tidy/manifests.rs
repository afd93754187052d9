//! Rules on packages.

use super::Finding;
use crate::new_pass::catalog_line;
use crate::tree::{File, Manifest, Tree};
use std::collections::BTreeSet;

const CATALOG: &str = "crates/catalog/Cargo.toml";

/// Packages that are used where there is no GPU; passes are too.
const WITHOUT_GPU: &[&str] = &[
    "data-file",
    "frame-graph",
    "scene",
    "shader-library",
    "pass",
    "interfaces",
    "language-server",
    "gpu-algorithms",
    "study",
    "stress",
    "precision",
];

pub(super) fn catalog(tree: &Tree) -> Vec<Finding> {
    let Some(catalog) = tree.manifests().iter().find(|manifest| manifest.path == CATALOG) else {
        return vec![Finding::new(CATALOG, 1, "there is no catalog")];
    };
    let passes = tree.passes();
    let listed: Vec<_> = catalog
        .dependencies()
        .into_iter()
        .filter_map(|dependency| Some((dependency.path?.strip_prefix("../../passes/")?, dependency.line)))
        .collect();
    let missing = passes.iter().filter(|pass| !listed.iter().any(|(name, _)| name == *pass)).map(|pass| {
        let line = format!("add under [dependencies]: {}", catalog_line(pass));
        Finding::new(CATALOG, 1, format!("passes/{pass} is not in the catalog; {line}"))
    });
    let gone = listed.iter().filter(|(name, _)| !passes.contains(name));
    let gone =
        gone.map(|(name, line)| Finding::new(CATALOG, *line, format!("there is no folder passes/{name}")));
    missing.chain(gone).collect()
}

pub(super) fn names(tree: &Tree) -> Vec<Finding> {
    let mut found = Vec::new();
    for (short, manifest) in packages(tree) {
        let (Some((group, folder)), Some(name)) = (manifest.folder().split_once('/'), manifest.name()) else {
            continue;
        };
        if ["crates", "examples", "passes", "tools"].contains(&group) && folder != short {
            found.push(Finding::new(
                &manifest.path,
                1,
                format!("package `{name}` lies in the folder `{folder}`"),
            ));
        }
        if !manifest.is_unpublished() && short == name && name != "lightloom" {
            let message = format!(
                "package `{name}` is published: name it `lightloom-{short}`, or add `publish.workspace = true`"
            );
            found.push(Finding::new(&manifest.path, 1, message));
        }
    }
    found
}

pub(super) fn lints(tree: &Tree) -> Vec<Finding> {
    packages(tree)
        .filter(|(_, manifest)| !manifest.inherits_lints())
        .map(|(_, manifest)| Finding::new(&manifest.path, 1, "add: [lints] workspace = true"))
        .collect()
}

/// A test binary is linked, and documentation scanned, for each library that does not say that it has none: a tenth of a second to
/// some seconds for nothing, a hundred times.
pub(super) fn tested(tree: &Tree) -> Vec<Finding> {
    let mut found = Vec::new();
    for (_, manifest) in packages(tree) {
        let (sources, program) =
            (format!("{}/src", manifest.folder()), format!("{}/src/main.rs", manifest.folder()));
        if tree.file(&format!("{sources}/lib.rs")).is_none() {
            continue;
        }
        let code: Vec<&File> =
            tree.below(&sources).filter(|file| file.is("rs") && file.path != program).collect();
        let has_tests =
            code.iter().any(|file| ["#[test]", "proptest!"].iter().any(|word| file.text.contains(word)));
        let has_examples = code.iter().any(|file| has_example(file));
        for (key, has) in [("test", has_tests), ("doctest", has_examples)] {
            if manifest.of_library(key) != has {
                let wanted = if has { "has some: remove" } else { "has none: add" };
                let message = format!("the library {wanted} `{key} = false` in [lib]");
                found.push(Finding::new(&manifest.path, 1, message));
            }
        }
    }
    found
}

/// Whether the documentation of a file has an example that compiles: a fenced block in Rust, or in no stated language.
fn has_example(file: &File) -> bool {
    let docs = file.lines().filter_map(|(_, line)| {
        let line = line.trim_start();
        line.strip_prefix("//! ").or_else(|| line.strip_prefix("/// "))
    });
    // Every second fence ends a block.
    let mut opening = docs.filter_map(|line| line.strip_prefix("```")).step_by(2);
    opening.any(|language| ["", "rust", "no_run", "should_panic", "compile_fail"].contains(&language))
}

pub(super) fn no_gpu(tree: &Tree) -> Vec<Finding> {
    let is_pass = |manifest: &Manifest| manifest.folder().starts_with("passes/");
    packages(tree)
        .filter(|(name, manifest)| WITHOUT_GPU.contains(name) || is_pass(manifest))
        .filter_map(|(name, manifest)| {
            let (way, line) = way_to_wgpu(tree, manifest, &mut BTreeSet::new())?;
            Some(Finding::new(
                &manifest.path,
                line,
                format!("it must work without a GPU: {name} → {}", way.join(" → ")),
            ))
        })
        .collect()
}

/// The packages from a package's dependency to wgpu, tests apart, and the line of that dependency.
fn way_to_wgpu<'a>(
    tree: &'a Tree,
    from: &'a Manifest,
    seen: &mut BTreeSet<&'a str>,
) -> Option<(Vec<&'a str>, usize)> {
    from.dependencies().into_iter().filter(|dependency| !dependency.dev).find_map(|dependency| {
        if dependency.package == "wgpu" {
            return Some((vec!["wgpu"], dependency.line));
        }
        let next = tree.package(dependency.package).filter(|_| seen.insert(dependency.package))?;
        let (mut way, _) = way_to_wgpu(tree, next, seen)?;
        way.insert(0, dependency.package);
        Some((way, dependency.line))
    })
}

pub(super) fn alone(tree: &Tree) -> Vec<Finding> {
    let passes = tree.passes();
    let mut findings = Vec::new();
    for (name, manifest) in packages(tree).filter(|(_, manifest)| manifest.folder().starts_with("passes/")) {
        for dependency in manifest.dependencies() {
            if passes.contains(&dependency.package) && dependency.package != name {
                let message =
                    format!("no pass knows another, but this one depends on `{}`", dependency.package);
                findings.push(Finding::new(&manifest.path, dependency.line, message));
            }
        }
    }
    findings
}

fn packages(tree: &Tree) -> impl Iterator<Item = (&str, &Manifest)> {
    tree.manifests().iter().filter_map(|manifest| Some((manifest.package()?, manifest)))
}
