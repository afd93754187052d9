//! Packages as they are published.

use xtask::cargo::cargo;
use xtask::tree::root;

/// All packages can be packed, and cargo has nothing to say about it. Without `--no-verify`, which
/// takes half an hour, cargo also builds each from what is packed.
#[test]
#[ignore = "slow"]
fn packages_are_packed_without_a_warning() {
    let mut package = cargo(&root(), "package");
    package.args(["--workspace", "--no-verify", "--allow-dirty", "--locked", "--offline"]);
    let done = package.output().expect("cargo runs");
    let said = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success() && said.contains("Packaged"), "{said}");
    assert!(!said.contains("warning"), "{said}");
}
