//! `cargo xtask docs`: the tables of documents.

use crate::cargo::{cargo, run as run_command};
use anyhow::Result;
use std::path::Path;

/// Runs the test of the catalog that compares tables with declarations, so that it writes them. Only a crate that depends
/// on all passes knows these.
pub fn run(root: &Path) -> Result<()> {
    let mut test = cargo(root, "test");
    test.args(["--quiet", "--package", "lightloom-catalog", "--no-default-features", "--test", "main"]);
    run_command(test.arg("tables_of_documents").env("LIGHTLOOM_BLESS", "1"))
}
