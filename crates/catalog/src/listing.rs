//! The pipelines and scenes there are.

use crate::{Catalog, SceneAssets};
use frame_graph::resolve::Files;
use frame_graph::{Overrides, Resolved, resolve};

/// A pipeline or a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Named {
    /// The name, as it is opened.
    pub name: String,
    /// Its summary, in a line; `None` where its file is broken.
    pub about: Option<String>,
}

impl Catalog {
    /// Returns the pipelines, sorted by name. Parts of pipelines are left out: those with inputs, and all of `parts/`.
    pub fn list_pipelines(&self) -> Vec<Named> {
        self.listed(false)
    }

    /// Returns the parts of pipelines, which others use by `Sub(file: …)`, sorted by name: those with inputs, and all of
    /// `parts/`.
    pub fn list_parts(&self) -> Vec<Named> {
        self.listed(true)
    }

    fn listed(&self, parts: bool) -> Vec<Named> {
        let files = self.pipelines();
        sorted(files.list().into_iter().filter_map(|path| {
            let in_parts = path.split('/').any(|part| part == "parts");
            if in_parts && !parts {
                return None;
            }
            let resolved = resolve(&path, files, &Overrides::default()).ok();
            let is_part = in_parts || resolved.as_ref().is_some_and(Resolved::is_part);
            let about = resolved.map(|resolved| resolved.about().unwrap_or_default().to_owned());
            (is_part == parts).then(|| Named { name: path.trim_end_matches(".ron").to_owned(), about })
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
