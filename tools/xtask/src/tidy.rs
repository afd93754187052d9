//! `cargo xtask tidy`: the rules of the tree that no compiler knows. They are run by `cargo test` as well.

mod manifests;
mod passes;
mod text;

use crate::tree::Tree;
use anyhow::{Result, bail};
use std::path::Path;

/// A rule.
#[derive(Clone, Copy, Debug)]
pub struct Check {
    /// Its name, in kebab-case.
    pub name: &'static str,
    /// The rule.
    pub rule: &'static str,
    /// Whether what it finds is printed and breaks nothing.
    pub note: bool,
    /// Looks for what breaks it.
    pub run: fn(&Tree) -> Vec<Finding>,
}

/// All rules.
pub static CHECKS: &[Check] = &[
    check(
        "catalog",
        "every folder of passes/ is a dependency of the catalog, and the other way round",
        manifests::catalog,
    ),
    check(
        "names",
        "a package is named after its folder, with `lightloom-` before it where it is published",
        manifests::names,
    ),
    check("lints", "every package has `[lints] workspace = true`", manifests::lints),
    check("tested", "a library says where it has no tests or no examples of its own", manifests::tested),
    check("no-gpu", "what must work without a GPU reaches no wgpu", manifests::no_gpu),
    check("alone", "no pass depends on another pass", manifests::alone),
    check("readme", "a pass has a README", passes::readme),
    check(
        "deviations",
        "a pass that cites a paper says where it deviates, the same in code and README",
        passes::deviations,
    ),
    check("header", "shaders and pipelines begin with a comment", text::header),
    check("unfinished", "nothing is left to be done later", text::unfinished),
    check("machine", "no path of one machine", text::machine),
    check("links", "links between documents lead somewhere", text::links),
    Check {
        note: true,
        ..check(
            "long",
            "more than 500 lines of code, or 40 by hand in a pass's README, may be two things",
            text::long,
        )
    },
];

const fn check(name: &'static str, rule: &'static str, run: fn(&Tree) -> Vec<Finding>) -> Check {
    Check { name, rule, note: false, run }
}

/// A place where a rule is broken.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Finding {
    /// File, from the root.
    pub path: String,
    /// Line, from 1.
    pub line: usize,
    /// The mistake, and what to write instead.
    pub message: String,
}

impl Finding {
    fn new(path: &str, line: usize, message: impl Into<String>) -> Finding {
        Finding { path: path.to_owned(), line, message: message.into() }
    }
}

impl std::fmt::Display for Finding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}:{}: {}", self.path, self.line, self.message)
    }
}

/// Returns what every rule finds, rules without findings left out.
pub fn findings(tree: &Tree) -> Vec<(&'static Check, Vec<Finding>)> {
    let run = |check: &'static Check| {
        let mut findings = (check.run)(tree);
        findings.sort();
        (check, findings)
    };
    CHECKS.iter().map(run).filter(|(_, findings)| !findings.is_empty()).collect()
}

/// Prints what is found. Errors where a rule is broken that is more than a note.
pub fn run(root: &Path) -> Result<()> {
    let tree = Tree::read(root)?;
    let mut broken = 0;
    for (check, findings) in findings(&tree) {
        println!("{}{}: {}", if check.note { "note: " } else { "" }, check.name, check.rule);
        for finding in &findings {
            println!("  {finding}");
        }
        broken += if check.note { 0 } else { findings.len() };
    }
    if broken > 0 {
        bail!("{broken} findings");
    }
    println!("tidy: {} rules hold in {} files", CHECKS.len(), tree.files().len());
    Ok(())
}
