//! Reload at a frame's edge: files that changed are read again, and what cannot be made of them leaves the
//! last good plan in place.

use crate::{LoadReport, RenderError, Renderer};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// What a reload came to.
#[derive(Debug)]
pub enum Reload {
    /// None of the files takes part.
    Nothing,
    /// The plan is the new one; what was made anew.
    Done(LoadReport),
    /// The new text is wrong: the last good plan goes on.
    Failed(RenderError),
}

impl Renderer {
    /// Takes in that files have changed, as [`shader_library::Watcher`] tells it; call it between frames.
    pub fn reload(&mut self, changed: &BTreeSet<PathBuf>) -> Reload {
        let paths: BTreeSet<String> = changed.iter().filter_map(|path| self.asset_path(path)).collect();
        let Some(loaded) = &self.pipeline else { return Reload::Nothing };
        let stale = self.catalog.shaders().invalidate(&paths.iter().map(String::as_str).collect::<Vec<_>>());
        let pipeline_touched =
            loaded.compiled.resolved.sources().iter().any(|source| paths.contains(&source.name))
                || paths.iter().any(|path| path.ends_with(".ron") && path.starts_with("pipelines/"));
        if stale.is_empty() && !pipeline_touched {
            return Reload::Nothing;
        }
        let (name, overrides) = (loaded.name.clone(), loaded.overrides.clone());
        match self.set_pipeline(&name, &overrides) {
            Ok(report) => Reload::Done(report),
            Err(error) => Reload::Failed(error),
        }
    }

    /// The path by which a file on disk is known: from the root of the tree, with `/`.
    fn asset_path(&self, path: &Path) -> Option<String> {
        let root = self.catalog.assets().root();
        let relative = root.and_then(|root| path.strip_prefix(root).ok()).unwrap_or(path);
        Some(relative.to_str()?.replace('\\', "/"))
    }
}
