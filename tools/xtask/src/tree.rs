//! The files of the tree, as the chores read them.

use anyhow::{Context, Result};
use std::ops::Range;
use std::path::{Path, PathBuf};
use toml_edit::{Document, TableLike};

/// Folders that are no part of the tree: what is built and rendered.
const NOT_OURS: &[&str] = &["target", "out"];

/// Folders that are read although their names begin with a dot.
const HIDDEN: &[&str] = &[".cargo", ".ci", ".github"];

/// Extensions of the files that are read; those in `.ci` are read without.
const EXTENSIONS: &[&str] = &["rs", "wgsl", "ron", "md", "toml", "yml", "yaml", "sh"];

/// Returns the root of the tree.
pub fn root() -> PathBuf {
    // Cargo says at run time where the tree lies now; it may have been moved since this program was built.
    let manifest =
        std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_else(|| env!("CARGO_MANIFEST_DIR").into());
    let here = PathBuf::from(manifest);
    here.ancestors().nth(2).unwrap_or(&here).to_path_buf()
}

/// Every text file of the tree.
#[derive(Debug)]
pub struct Tree {
    root: PathBuf,
    files: Vec<File>,
    manifests: Vec<Manifest>,
}

/// A text file.
#[derive(Debug)]
pub struct File {
    /// From the root, with `/`.
    pub path: String,
    /// The text.
    pub text: String,
}

/// A `Cargo.toml`.
#[derive(Debug)]
pub struct Manifest {
    /// From the root, with `/`.
    pub path: String,
    document: Document<String>,
}

/// A dependency in a manifest.
#[derive(Debug, PartialEq, Eq)]
pub struct Dependency<'a> {
    /// Name of the package, as [`Manifest::package`].
    pub package: &'a str,
    /// Path as written, for one that says it.
    pub path: Option<&'a str>,
    /// Only for tests, benchmarks and examples.
    pub dev: bool,
    /// Line in the manifest, from 1.
    pub line: usize,
}

impl Tree {
    /// Reads all of it. Errors name the file.
    pub fn read(root: &Path) -> Result<Tree> {
        let mut files = Vec::new();
        let mut open = vec![root.to_path_buf()];
        while let Some(folder) = open.pop() {
            for entry in folder.read_dir().with_context(|| format!("cannot read {}", folder.display()))? {
                let path = entry?.path();
                // Links make packages whole; what they lead to is in the tree.
                if path.is_symlink() {
                    continue;
                }
                let name = path.file_name().unwrap_or_default().to_string_lossy();
                if path.is_dir() {
                    if !NOT_OURS.contains(&&*name) && (!name.starts_with('.') || HIDDEN.contains(&&*name)) {
                        open.push(path);
                    }
                } else if is_read(&path) {
                    let text = std::fs::read_to_string(&path)
                        .with_context(|| format!("cannot read {}", path.display()))?;
                    let relative =
                        path.strip_prefix(root).unwrap_or(&path).to_string_lossy().replace('\\', "/");
                    files.push(File { path: relative, text });
                }
            }
        }
        files.sort_by(|a, b| a.path.cmp(&b.path));
        let is_manifest = |file: &&File| file.path.rsplit('/').next() == Some("Cargo.toml");
        let manifests = files.iter().filter(is_manifest).map(Manifest::parse).collect::<Result<_>>()?;
        Ok(Tree { root: root.to_path_buf(), files, manifests })
    }

    /// Returns the root on disk.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Returns all files, by path.
    pub fn files(&self) -> &[File] {
        &self.files
    }

    /// Returns the file at that path.
    pub fn file(&self, path: &str) -> Option<&File> {
        self.files.binary_search_by(|file| file.path.as_str().cmp(path)).ok().map(|index| &self.files[index])
    }

    /// Returns the files below a folder, given without a `/` at its end.
    pub fn below<'a>(&'a self, folder: &'a str) -> impl Iterator<Item = &'a File> {
        let below =
            move |file: &&File| file.path.strip_prefix(folder).is_some_and(|rest| rest.starts_with('/'));
        self.files.iter().filter(below)
    }

    /// Returns all manifests, by path; that of the workspace is one of them.
    pub fn manifests(&self) -> &[Manifest] {
        &self.manifests
    }

    /// Returns the manifest of a package, by its name with or without `lightloom-`.
    pub fn package(&self, name: &str) -> Option<&Manifest> {
        self.manifests.iter().find(|manifest| manifest.package() == Some(short(name)))
    }

    /// Returns the names of the folders of `passes/`, sorted.
    pub fn passes(&self) -> Vec<&str> {
        let mut names: Vec<&str> = self
            .below("passes")
            .filter_map(|file| file.path.split('/').nth(1))
            .filter(|name| !name.contains('.'))
            .collect();
        names.dedup();
        names
    }
}

fn is_read(path: &Path) -> bool {
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    let in_ci = path.parent().and_then(Path::file_name).is_some_and(|folder| folder == ".ci");
    EXTENSIONS.contains(&&*extension) || (in_ci && extension.is_empty())
}

impl File {
    /// Returns its lines with their numbers, from 1.
    pub fn lines(&self) -> impl Iterator<Item = (usize, &str)> {
        (1..).zip(self.text.lines())
    }

    /// Returns whether its name ends in this extension.
    pub fn is(&self, extension: &str) -> bool {
        self.path.rsplit_once('.').is_some_and(|(_, found)| found == extension)
    }
}

/// Returns the name of a package without the `lightloom-` of those that are published.
fn short(name: &str) -> &str {
    name.strip_prefix("lightloom-").unwrap_or(name)
}

/// Returns the number of the line, from 1, in which a byte of the text lies.
pub fn line_at(text: &str, byte: usize) -> usize {
    1 + text.as_bytes().iter().take(byte).filter(|&&b| b == b'\n').count()
}

impl Manifest {
    fn parse(file: &File) -> Result<Manifest> {
        let document = Document::parse(file.text.clone()).with_context(|| file.path.clone())?;
        Ok(Manifest { path: file.path.clone(), document })
    }

    /// Returns its folder, from the root.
    pub fn folder(&self) -> &str {
        self.path.rsplit_once('/').map_or("", |(folder, _)| folder)
    }

    /// Returns the name of the package; `None` for the workspace's own manifest.
    pub fn name(&self) -> Option<&str> {
        self.document.get("package")?.get("name")?.as_str()
    }

    /// Returns the name of the package without the `lightloom-` that it has where it is published.
    pub fn package(&self) -> Option<&str> {
        self.name().map(short)
    }

    /// Returns whether `publish` of the workspace, which is `false`, is that of the package.
    pub fn is_unpublished(&self) -> bool {
        let inherits = || self.document.get("package")?.get("publish")?.get("workspace")?.as_bool();
        inherits() == Some(true)
    }

    /// Returns whether its lints are those of the workspace.
    pub fn inherits_lints(&self) -> bool {
        let lints = || self.document.get("lints")?.get("workspace")?.as_bool();
        lints() == Some(true)
    }

    /// Returns what its library says about its `test` or its `doctest`: whether there are any, which is so where it says nothing.
    pub fn of_library(&self, key: &str) -> bool {
        let said = || self.document.get("lib")?.get(key)?.as_bool();
        said() != Some(false)
    }

    /// Returns all dependencies: those of the package, or for the workspace's manifest those that packages inherit.
    pub fn dependencies(&self) -> Vec<Dependency<'_>> {
        let root: &dyn TableLike = self.document.as_table();
        let mut found = Vec::new();
        let mut parents = vec![root];
        parents.extend(root.get("workspace").and_then(|item| item.as_table_like()));
        if let Some(targets) = root.get("target").and_then(|item| item.as_table_like()) {
            parents.extend(targets.iter().filter_map(|(_, item)| item.as_table_like()));
        }
        for parent in parents {
            for (section, dev) in
                [("dependencies", false), ("build-dependencies", false), ("dev-dependencies", true)]
            {
                let Some(table) = parent.get(section).and_then(|item| item.as_table_like()) else { continue };
                for (name, item) in table.iter() {
                    let text = |key: &str| item.get(key).and_then(|value| value.as_str());
                    let key = table.get_key_value(name).and_then(|(key, _)| key.span());
                    found.push(Dependency {
                        package: short(text("package").unwrap_or(name)),
                        path: text("path"),
                        dev,
                        line: self.line(key),
                    });
                }
            }
        }
        found
    }

    fn line(&self, span: Option<Range<usize>>) -> usize {
        span.map_or(1, |span| line_at(self.document.raw(), span.start))
    }
}
