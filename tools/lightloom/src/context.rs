//! The context of all commands, and arguments that several of them take.

use crate::start::Phases;
use anyhow::{Result, anyhow, bail, ensure};
pub(crate) use catalog::Sort;
use frame_graph::resolve::Files as _;
use frame_graph::{Overrides, Traits, Value, nearest};
use renderer::{Assets, Catalog, parse_value};
use std::path::PathBuf;
use std::sync::Arc;

/// The files, and the output format.
pub(crate) struct Context {
    /// What starts this program; empty where it does not know.
    program: Vec<String>,
    pub(crate) catalog: Arc<Catalog>,
    pub(crate) json: bool,
    /// The times of phases since the process started.
    pub(crate) phases: Phases,
}

impl Context {
    /// Creates the context with the given folder, or the tree around the working folder, or the built-in files alone.
    pub(crate) fn new(program: Vec<String>, root: Option<PathBuf>, json: bool, phases: Phases) -> Context {
        let root = root.or_else(|| Assets::find_root(&std::env::current_dir().ok()?));
        let root = root.map(|root| std::path::absolute(&root).unwrap_or(root));
        Context { program, catalog: Arc::new(Catalog::new(Assets::new(root))), json, phases }
    }

    /// Returns what starts another process of this program that has the same files.
    pub(crate) fn program(&self) -> Result<Vec<String>> {
        let mut words = self.program.clone();
        ensure!(!words.is_empty(), "the program that runs does not know where it is");
        if let Some(root) = self.catalog.assets().root() {
            let root = root.canonicalize().unwrap_or_else(|_| root.to_owned());
            words.extend(["--root".to_owned(), root.display().to_string()]);
        }
        Ok(words)
    }

    /// Returns whether a name means something of this sort.
    pub(crate) fn is(&self, sort: Sort, name: &str) -> bool {
        let assets = self.catalog.assets();
        let stem = name.strip_suffix(".ron").unwrap_or(name);
        let text = (stem != name).then(|| assets.text(name)).flatten();
        match (sort, text.map(|text| Sort::of_text(&text))) {
            (_, Some(Some(of_file))) => of_file == sort,
            // A file that does not say what it is, such as an empty one, is what it is taken for.
            (_, Some(None)) => true,
            (Sort::Pipeline, None) => self.catalog.pipelines().read(name).is_some(),
            (Sort::Study, None) => assets.has(&format!("studies/{stem}.ron")),
            (Sort::Scene, None) => scene::is_geometry(name) || assets.has(&format!("scenes/{stem}.ron")),
        }
    }

    /// Checks that a name does not mean something of another sort than this one. That it means anything is checked where it
    /// is read.
    pub(crate) fn expect(&self, sort: Sort, name: &str) -> Result<()> {
        let is = |sort: &Sort| self.is(*sort, name);
        match Sort::ALL.iter().find(|other| is(other)).filter(|_| !is(&sort)) {
            Some(other) => bail!("`{name}` is a {}; a {} is expected here", other.name(), sort.name()),
            None => Ok(()),
        }
    }

    /// Returns the traits of a scene; those of the plainest scene if none is named.
    pub(crate) fn traits(&self, scene: Option<&str>) -> Result<Traits> {
        Ok(renderer::load_scene(&self.catalog, scene.unwrap_or("cornell-box"))?.traits())
    }
}

// No doc comment: clap would take it for that of the command.
#[derive(clap::Args)]
pub(crate) struct Values {
    /// A value for a parameter or a pass's setting. May be repeated
    #[arg(long, value_name = "NAME=VALUE", value_parser = parse_set)]
    set: Vec<(String, Value)>,
}

impl Values {
    pub(crate) fn overrides(&self) -> Overrides {
        Overrides(self.set.clone())
    }
}

/// Parses `name=value`.
pub(crate) fn parse_set(text: &str) -> Result<(String, Value), String> {
    let (name, value) = text.split_once('=').ok_or("expected `parameter=value` or `pass.setting=value`")?;
    Ok((name.trim().to_owned(), parse_value(value)))
}

/// Formats a value as `--set` takes it.
pub(crate) fn set_text((name, value): &(String, Value)) -> String {
    format!("{name}={}", value.to_argument())
}

/// Returns the error for a name that is none of `known`, which `lightloom LIST` lists.
pub(crate) fn unknown(what: &str, name: &str, known: &[String], list: &str) -> anyhow::Error {
    match nearest(name, known.iter().map(String::as_str)) {
        Some(near) => anyhow!("there is no {what} `{name}`; did you mean `{near}`?"),
        None => anyhow!("there is no {what} `{name}`; `lightloom {list}` lists all"),
    }
}

/// Parses a size: `640x480`.
pub(crate) fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let sides = text.split_once(['x', '×']).and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    match sides {
        Some((w @ 1..=16384, h @ 1..=16384)) => Ok((w, h)),
        _ => Err(format!(
            "must be WIDTHxHEIGHT in pixels, of 1 to 16384 each, such as 640x480; found `{text}`"
        )),
    }
}
