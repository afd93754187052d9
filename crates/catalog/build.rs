//! Makes the list of passes from the dependencies of this crate that lie under `passes/`, and embeds the files
//! that the program needs in any folder: WGSL, pipelines, scenes, studies.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Folders whose files are embedded, with the extension wanted.
const EMBEDDED: &[(&str, &str)] =
    &[("shaders", "wgsl"), ("pipelines", "ron"), ("scenes", "ron"), ("studies", "ron")];

fn main() {
    // The manifest of a packed crate is written anew, without paths; the one that was written by hand lies beside it.
    let manifest =
        ["Cargo.toml.orig", "Cargo.toml"].into_iter().find_map(|file| std::fs::read_to_string(file).ok());
    let manifest = manifest.expect("this crate's manifest");
    let mut out = String::from(
        "/// Every pass type, in the order of the documentation.\npub static PASSES: &[&dyn pass::Pass] = &[\n",
    );
    for name in manifest
        .lines()
        .filter(|line| line.contains("path = \"../../passes/"))
        .filter_map(|line| line.split_whitespace().next())
    {
        let _ = writeln!(out, "    {}::PASS,", name.replace('-', "_"));
    }
    out.push_str("];\n\n/// Path from the root of the tree, and text.\npub(crate) static EMBEDDED: &[(&str, &str)] = &[\n");
    // A packed crate has a copy of these folders, to which links in `tree` lead.
    let is_tree = EMBEDDED.iter().all(|(folder, _)| Path::new("../..").join(folder).is_dir());
    let root =
        Path::new(if is_tree { "../.." } else { "tree" }).canonicalize().expect("the root of the tree");
    for (folder, extension) in EMBEDDED {
        println!("cargo::rerun-if-changed={}", root.join(folder).display());
        let mut files = Vec::new();
        walk(&root.join(folder), extension, &mut files);
        files.sort();
        for file in files {
            println!("cargo::rerun-if-changed={}", file.display());
            let relative =
                file.strip_prefix(&root).expect("a file below the root").to_string_lossy().replace('\\', "/");
            let _ = writeln!(out, "    ({relative:?}, include_str!({:?})),", file.display().to_string());
        }
    }
    out.push_str("];\n");
    println!("cargo::rerun-if-changed=Cargo.toml");
    let target = PathBuf::from(std::env::var_os("OUT_DIR").expect("cargo sets OUT_DIR")).join("catalog.rs");
    std::fs::write(target, out).expect("the build folder can be written");
}

/// All files below a folder with that extension.
fn walk(folder: &Path, extension: &str, files: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for path in entries.flatten().map(|entry| entry.path()) {
        if path.is_dir() {
            walk(&path, extension, files);
        } else if path.extension().is_some_and(|found| found == extension) {
            files.push(path);
        }
    }
}
