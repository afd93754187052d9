//! The rules hold in the tree, and each fires where it is broken.

use crate::{tree, write};
use xtask::tidy::{CHECKS, findings};
use xtask::tree::Tree;

/// A tree in which all rules hold.
const TIDY: &[(&str, &str)] = &[
    (
        "Cargo.toml",
        "[workspace]\n[workspace.dependencies]\npass = { path = \"crates/pass\" }\nwgpu = \"30\"\n",
    ),
    (
        "crates/catalog/Cargo.toml",
        concat!(
            "[package]\nname = \"lightloom-catalog\"\n[lints]\nworkspace = true\n",
            "[dependencies]\ngather = { path = \"../../passes/gather\" }\npass.workspace = true\n",
        ),
    ),
    (
        "crates/pass/Cargo.toml",
        "[package]\nname = \"lightloom-pass\"\n[lints]\nworkspace = true\n[lib]\ntest = false\ndoctest = false\n",
    ),
    (
        "crates/executor/Cargo.toml",
        concat!(
            "[package]\nname = \"lightloom-executor\"\n[lints]\nworkspace = true\n",
            "[dependencies]\nwgpu.workspace = true\n",
        ),
    ),
    (
        "passes/gather/Cargo.toml",
        concat!(
            "[package]\nname = \"lightloom-gather\"\n[lints]\nworkspace = true\n",
            "[dependencies]\npass.workspace = true\n[dev-dependencies]\nexecutor.workspace = true\n",
            "[lib]\ntest = false\ndoctest = false\n",
        ),
    ),
    (
        "passes/gather/README.md",
        "# gather\n\n[root](../../Cargo.toml#top), [web](https://gpuweb.github.io)\n\n## Deviations from the paper\n\n- **runs**: strides leave stripes.\n- Nothing else.\n",
    ),
    ("passes/gather/src/lib.rs", "//! Gathers. DEVIATION( needs a name.\nInfo { paper: \"ISM §4\" }\n"),
    ("passes/gather/gather.wgsl", "// Gathers.\n// DEVIATION(runs): strides leave stripes.\n"),
    ("pipelines/ism.ron", "// ISM.\nPipeline()\n"),
    ("pipelines/parts/maps.ron", "// Maps.\nPipeline()\n"),
    ("docs/first.md", "Look at net/work/x, https://host/home/ and `[this](no-link)`.\n"),
];

/// Returns the findings in that tree after these files have been written, as `rule path:line: message`.
fn found(changes: &[(&str, &str)]) -> Vec<String> {
    let folder = tree(TIDY);
    for (path, text) in changes {
        write(folder.path(), path, text);
    }
    let tree = Tree::read(folder.path()).unwrap();
    let lines = findings(&tree).into_iter().flat_map(|(check, findings)| {
        findings.into_iter().map(|finding| format!("{} {finding}", check.name)).collect::<Vec<_>>()
    });
    lines.collect()
}

fn package(name: &str, rest: &str) -> String {
    let lib = "[lib]\ntest = false\ndoctest = false\n";
    format!("[package]\nname = \"lightloom-{name}\"\n[lints]\nworkspace = true\n{rest}{lib}")
}

#[test]
fn the_tree_is_tidy() {
    let tree = Tree::read(&xtask::tree::root()).unwrap();
    let broken = findings(&tree).into_iter().filter(|(check, _)| !check.note);
    let lines: Vec<String> = broken
        .flat_map(|(check, findings)| {
            findings.into_iter().map(move |finding| format!("{finding} [{}]", check.name))
        })
        .collect();
    assert!(lines.is_empty(), "{}", lines.join("\n"));
}

#[test]
fn nothing_is_found_where_the_rules_hold() {
    assert_eq!(found(&[]), [""; 0]);
}

/// For each rule a change that breaks it, and what is found then.
#[test]
fn every_rule_fires() {
    let long = "line\n".repeat(501);
    let readme = TIDY[5].1;
    let written = format!("<!-- x: written by cargo xtask docs -->\n{long}<!-- end of x -->\n");
    let (splat, loose) = (package("splat", ""), "[package]\nname = \"lightloom-pass\"\n");
    let misnamed = package("passes", "");
    let gpu = package("pass", "[target.'cfg(unix)'.dependencies]\nexecutor.workspace = true\n");
    let friends = package("gather", "[dev-dependencies]\nsplat = { path = \"../splat\" }\n");
    let catalog = package(
        "catalog",
        "[dependencies]\ngather = { path = \"../../passes/gather\" }\nsplat = { path = \"../../passes/splat\" }\n",
    );
    type Case<'a> = (&'a str, &'a [(&'a str, &'a str)], &'a [&'a str]);
    let cases: &[Case<'_>] = &[
        (
            "catalog",
            &[("crates/catalog/Cargo.toml", &catalog)],
            &["catalog crates/catalog/Cargo.toml:7: there is no folder passes/splat"],
        ),
        (
            "catalog",
            &[("passes/splat/Cargo.toml", &splat), ("passes/splat/README.md", "")],
            &[
                "catalog crates/catalog/Cargo.toml:1: passes/splat is not in the catalog; add under [dependencies]: splat = { path = \"../../passes/splat\", package = \"lightloom-splat\", version = \"0.1.0\" }",
            ],
        ),
        (
            "names",
            &[("crates/pass/Cargo.toml", &misnamed)],
            &["names crates/pass/Cargo.toml:1: package `lightloom-passes` lies in the folder `pass`"],
        ),
        (
            "names",
            &[("crates/pass/Cargo.toml", &package("pass", "").replace("lightloom-", ""))],
            &[
                "names crates/pass/Cargo.toml:1: package `pass` is published: name it `lightloom-pass`, or add `publish.workspace = true`",
            ],
        ),
        (
            "tested",
            &[("crates/pass/src/lib.rs", "//! ```\n//! f();\n//! ```\n\n//! ```text\n//! ```\n")],
            &["tested crates/pass/Cargo.toml:1: the library has some: remove `doctest = false` in [lib]"],
        ),
        (
            "tested",
            &[("crates/executor/src/lib.rs", "//! Runs.\n//!\n//! ```text\n//! ```\n#[test]\nfn f() {}\n")],
            &["tested crates/executor/Cargo.toml:1: the library has none: add `doctest = false` in [lib]"],
        ),
        (
            "lints",
            &[("crates/pass/Cargo.toml", loose)],
            &["lints crates/pass/Cargo.toml:1: add: [lints] workspace = true"],
        ),
        (
            "no-gpu",
            &[("crates/pass/Cargo.toml", &gpu)],
            &[
                "no-gpu crates/pass/Cargo.toml:6: it must work without a GPU: pass → executor → wgpu",
                "no-gpu passes/gather/Cargo.toml:6: it must work without a GPU: gather → pass → executor → wgpu",
            ],
        ),
        (
            "alone",
            &[
                ("passes/gather/Cargo.toml", &friends),
                ("passes/splat/Cargo.toml", &splat),
                ("passes/splat/README.md", ""),
                ("crates/catalog/Cargo.toml", &catalog),
            ],
            &["alone passes/gather/Cargo.toml:6: no pass knows another, but this one depends on `splat`"],
        ),
        (
            "readme",
            &[("passes/splat/Cargo.toml", &splat), ("crates/catalog/Cargo.toml", &catalog)],
            &["readme passes/splat/README.md:1: there is no README"],
        ),
        (
            "long",
            &[("passes/gather/README.md", &format!("{readme}{written}{}", "\n".repeat(32)))],
            &["long passes/gather/README.md:1: 41 lines"],
        ),
        (
            "deviations",
            &[("passes/gather/README.md", "# gather\n"), ("passes/gather/gather.wgsl", "// Gathers.\n")],
            &[
                "deviations passes/gather/src/lib.rs:2: it cites a paper, but passes/gather/README.md has no section \"Deviations …\"",
            ],
        ),
        (
            "deviations",
            &[("passes/gather/gather.wgsl", "// Gathers.\n\n  // DEVIATION(strides): why\n")],
            &[
                "deviations passes/gather/README.md:7: no comment in the code says DEVIATION(runs)",
                "deviations passes/gather/gather.wgsl:3: say it in passes/gather/README.md, under \"Deviations …\": - **strides**: …",
            ],
        ),
        (
            "header",
            &[("pipelines/ism.ron", "Pipeline()\n"), ("shaders/camera.wgsl", "\n// Camera.\n")],
            &[
                "header pipelines/ism.ron:1: begin with a comment that says what it computes, and its paper",
                "header shaders/camera.wgsl:1: begin with a comment that says what it computes, and its paper",
            ],
        ),
        (
            "unfinished",
            &[(
                "crates/pass/src/lib.rs",
                "//! todo!() in a document\nfn f() {\n    todo!()\n}\n// TODO: g\n// TODOS\n",
            )],
            &[
                "unfinished crates/pass/src/lib.rs:3: `todo!` is left",
                "unfinished crates/pass/src/lib.rs:5: `TODO` is left",
            ],
        ),
        (
            "machine",
            &[(".ci/run", "#!/bin/bash\ncd /home/me\n"), ("docs/second.md", "`/root/x`\n")],
            &[
                "machine .ci/run:2: a path of one machine: `/home/…`",
                "machine docs/second.md:1: a path of one machine: `/root/…`",
            ],
        ),
        (
            "links",
            &[("docs/second.md", "[here](first.md)\n\n![away](first.png)\n[abs](/docs/first.md)\n")],
            &[
                "links docs/second.md:3: there is no `first.png`",
                "links docs/second.md:4: there is no `/docs/first.md`",
            ],
        ),
        ("long", &[("crates/pass/src/lib.rs", &long)], &["long crates/pass/src/lib.rs:1: 501 lines"]),
    ];
    for (rule, changes, expected) in cases {
        assert_eq!(found(changes), *expected, "{rule}");
    }
    for check in CHECKS {
        assert!(cases.iter().any(|(rule, ..)| *rule == check.name), "no case breaks the rule {}", check.name);
    }
}

#[test]
fn a_manifest_that_does_not_parse_is_named() {
    let folder = tree(&[("crates/pass/Cargo.toml", "[package\n")]);
    assert!(format!("{:#}", Tree::read(folder.path()).unwrap_err()).starts_with("crates/pass/Cargo.toml: "));
}

#[test]
fn what_is_built_is_not_read() {
    let folder =
        tree(&[("target/debug/x.rs", ""), (".git/x.md", ""), (".ci/run", ""), ("crates/x.png", "\0")]);
    let tree = Tree::read(folder.path()).unwrap();
    assert_eq!(tree.files().iter().map(|file| &*file.path).collect::<Vec<_>>(), [".ci/run"]);
}
