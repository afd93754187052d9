//! The pipelines and scenes there are.

use eframe::egui::Context;
use renderer::{Catalog, Named};
use std::sync::{Arc, OnceLock};

/// Pipelines and scenes, which are read on a thread of their own.
#[derive(Clone, Default)]
pub(crate) struct Library(Arc<OnceLock<(Vec<Named>, Vec<Named>)>>);

impl Library {
    /// Begins to read them, and draws the window again when that is done.
    pub(crate) fn load(catalog: Arc<Catalog>, context: Context) -> Library {
        let library = Library::default();
        let filled = library.clone();
        let read = move || {
            // It is set here alone.
            let _ = filled.0.set((catalog.list_pipelines(), catalog.list_scenes()));
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

/// Returns a line about a pipeline or a scene.
pub(crate) fn about(named: &Named) -> &str {
    named.about.as_deref().unwrap_or("does not load")
}
