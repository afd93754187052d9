//! The pipelines and scenes there are.

use catalog::SceneAssets;
use eframe::egui::Context;
use frame_graph::resolve::Files;
use frame_graph::{Overrides, resolve};
use renderer::Catalog;
use std::sync::{Arc, OnceLock};

/// A name with a line about it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Named {
    /// The name, as it is opened.
    pub(crate) name: String,
    /// What it is.
    pub(crate) about: String,
}

/// Pipelines and scenes, which are read on a thread of their own.
#[derive(Clone, Default)]
pub(crate) struct Library(Arc<OnceLock<(Vec<Named>, Vec<Named>)>>);

impl Library {
    /// Begins to read them, and draws the window again when that is done.
    pub(crate) fn load(catalog: Arc<Catalog>, context: Context) -> Library {
        let library = Library::default();
        let filled = library.clone();
        let read = move || {
            let (pipelines, scenes) = (pipelines(&catalog), scenes(&catalog));
            // It is set here alone.
            let _ = filled.0.set((pipelines, scenes));
            context.request_repaint();
        };
        // Without the thread lists stay empty, and names can still be typed.
        let _ = std::thread::Builder::new().name("library".to_owned()).spawn(read);
        library
    }

    /// Returns the pipelines; empty until they are read.
    pub(crate) fn pipelines(&self) -> &[Named] {
        self.0.get().map_or(&[], |(pipelines, _)| pipelines)
    }

    /// Returns the scenes; empty until they are read.
    pub(crate) fn scenes(&self) -> &[Named] {
        self.0.get().map_or(&[], |(_, scenes)| scenes)
    }
}

fn pipelines(catalog: &Catalog) -> Vec<Named> {
    let files = catalog.pipelines();
    let named = files.list().into_iter().filter_map(|path| {
        let name = path.trim_end_matches(".ron").to_owned();
        match resolve(&path, files, &Overrides::default()) {
            Ok(resolved) if resolved.is_part() => None,
            Ok(resolved) => Some(Named { name, about: resolved.about().unwrap_or_default().to_owned() }),
            Err(_) => Some(Named { name, about: "does not load".to_owned() }),
        }
    });
    named.collect()
}

fn scenes(catalog: &Catalog) -> Vec<Named> {
    let paths = catalog.assets().list("scenes", "ron");
    let files = SceneAssets(catalog.assets().clone());
    let named = paths.iter().map(|path| {
        let name = path.trim_start_matches("scenes/").trim_end_matches(".ron").to_owned();
        Named { about: scene::about(&name, &files).unwrap_or_default(), name }
    });
    named.collect()
}
