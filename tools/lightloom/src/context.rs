//! What every command starts from.

use crate::start::Phases;
use anyhow::{Result, bail};
use frame_graph::{Overrides, Traits};
use renderer::{Assets, Catalog, parse_value};
use std::path::PathBuf;
use std::sync::Arc;

/// Files, and how to print.
pub(crate) struct Context {
    pub(crate) catalog: Arc<Catalog>,
    pub(crate) json: bool,
    /// Where the time has gone since the process started.
    pub(crate) phases: Phases,
}

impl Context {
    /// With the folder given, or the tree that the working folder is in, or the files built in alone.
    pub(crate) fn new(root: Option<PathBuf>, json: bool, phases: Phases) -> Context {
        let root = root.or_else(|| Assets::find_root(&std::env::current_dir().ok()?));
        let root = root.map(|root| std::path::absolute(&root).unwrap_or(root));
        Context { catalog: Arc::new(Catalog::new(Assets::new(root))), json, phases }
    }

    /// What a scene holds; of all scenes the plainest where none is named.
    pub(crate) fn traits(&self, scene: Option<&str>) -> Result<Traits> {
        Ok(renderer::load_scene(&self.catalog, scene.unwrap_or("cornell-box"))?.traits())
    }
}

/// Values from `--set name=value`, any number of times.
pub(crate) fn overrides(given: &[String]) -> Result<Overrides> {
    let mut overrides = Overrides::default();
    for text in given {
        let Some((name, value)) = text.split_once('=') else {
            bail!("`--set {text}`: expected `parameter=value` or `pass.setting=value`");
        };
        overrides.0.push((name.trim().to_owned(), parse_value(value)));
    }
    Ok(overrides)
}

/// A `name=value` as [`overrides`] takes it.
pub(crate) fn parse_set(text: &str) -> Result<String, String> {
    match text.contains('=') {
        true => Ok(text.to_owned()),
        false => Err("expected `parameter=value` or `pass.setting=value`".to_owned()),
    }
}

/// `640x480`.
pub(crate) fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let sides = text.split_once(['x', '×']).and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    match sides {
        Some((w @ 1..=16384, h @ 1..=16384)) => Ok((w, h)),
        _ => Err(format!(
            "`{text}` is no size: expected WIDTHxHEIGHT in pixels, such as 640x480, of 1 to 16384 each"
        )),
    }
}
