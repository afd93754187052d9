//! The pipelines and scenes there are.

use crate::{Catalog, SceneAssets};
use frame_graph::resolve::Files;
use frame_graph::{Overrides, resolve};

/// A pipeline or a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Named {
    /// The name, as it is opened.
    pub name: String,
    /// What it is, in a line; `None` where its file is broken.
    pub about: Option<String>,
}

impl Catalog {
    /// Returns the pipelines, sorted by name. Parts of pipelines are left out: those with inputs, and all of `parts/`.
    pub fn list_pipelines(&self) -> Vec<Named> {
        let files = self.pipelines();
        let whole = files.list().into_iter().filter(|path| path.split('/').all(|part| part != "parts"));
        sorted(whole.filter_map(|path| {
            let about = match resolve(&path, files, &Overrides::default()) {
                Ok(resolved) if resolved.is_part() => return None,
                Ok(resolved) => Some(resolved.about().unwrap_or_default().to_owned()),
                Err(_) => None,
            };
            Some(Named { name: path.trim_end_matches(".ron").to_owned(), about })
        }))
    }

    /// Returns the scenes, sorted by name.
    pub fn list_scenes(&self) -> Vec<Named> {
        let files = SceneAssets(self.assets().clone());
        sorted(self.assets().list("scenes", "ron").into_iter().map(|path| {
            let name = path.trim_start_matches("scenes/").trim_end_matches(".ron").to_owned();
            Named { about: scene::about(&name, &files).ok(), name }
        }))
    }
}

/// Sorted by name: paths are sorted with their ending, which puts `atrium.ron` behind `atrium-spot.ron`.
fn sorted(all: impl Iterator<Item = Named>) -> Vec<Named> {
    let mut all: Vec<Named> = all.collect();
    all.sort_by(|a, b| a.name.cmp(&b.name));
    all
}
