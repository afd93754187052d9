//! `cargo xtask demo`: from a fresh clone to a picture.

use crate::cargo::{built, cargo, run as run_command};
use crate::gpu;
use crate::packages::Consent;
use anyhow::{Result, bail};
use std::path::Path;
use std::process::Command;

/// What is built: the program, with features that packages have in tests.
pub const BUILT: &[&str] =
    &["--locked", "--package", "lightloom", "--package", "shared-features", "--no-default-features"];

const PICTURE: &str = "out/cornell-box.png";

/// Builds the program without a window, ensures that there is an adapter, and renders.
pub fn run(root: &Path, consent: Consent) -> Result<()> {
    println!("Building lightloom (a few minutes the first time)");
    // The dev profile is optimized where it matters. The window would double the time; what is built here is not built
    // again by `cargo xtask test` (tools/shared-features).
    run_command(cargo(root, "build").args(BUILT))?;
    let lightloom = built("lightloom")?;
    let adapters = gpu::ensure(&lightloom, consent)?;
    if adapters.is_empty() {
        bail!("there is no adapter to render with. {}", gpu::advice());
    }
    let picture = root.join(PICTURE);
    if let Some(folder) = picture.parent() {
        std::fs::create_dir_all(folder)?;
    }
    let render = ["render", "ism-invtm", "cornell-box", "-o"];
    run_command(Command::new(&lightloom).current_dir(root).args(render).arg(&picture))?;
    println!("The picture: {}", picture.display());
    Ok(())
}
