//! The window of Lightloom: pipelines and shaders are edited while they run, compared, and looked into.
//!
//! ```text
//! App (window's thread) ── Command ──▶ Engine (a thread, with a device of its own) ──▶ Renderer A, B, reference
//!      ▲                                  │
//!      └────── Published (pictures as pixels, plans, times, errors) ◀──┘
//! ```
//!
//! The interface never waits for a frame of a pipeline. [`run`] opens the window; everything else is private.

mod action;
mod app;
mod auto;
mod camera;
mod editor;
mod edits;
mod engine;
mod files;
mod history;
mod leave;
mod painter;
mod palette;
mod panel;
mod pilot;
mod remembered;
mod snapshots;
mod terminal;
#[cfg(test)]
mod tests;
mod textures;
mod theme;
mod viewport;

use app::App;
use eframe::egui;
use frame_graph::Overrides;
use remembered::Remembered;
use renderer::Catalog;
use std::path::PathBuf;
use std::sync::Arc;

/// The content of the window at first.
#[derive(Clone, Debug)]
pub struct Options {
    /// Pipelines, scenes and shaders.
    pub catalog: Arc<Catalog>,
    /// The pipeline, by name or path; `None` for the last one.
    pub pipeline: Option<String>,
    /// The scene, by name or path; `None` for the last one.
    pub scene: Option<String>,
    /// Values for parameters and settings.
    pub overrides: Overrides,
    /// Seed of all random numbers.
    pub seed: u32,
    /// The command that opens the place of an error: words, in which `{file}`, `{line}` and `{column}` are put in.
    pub editor: Option<String>,
    /// The file for the state of the window; `None` for the user's data folder.
    pub state: Option<PathBuf>,
}

/// The reason why there is no window.
#[derive(Debug, thiserror::Error)]
pub enum ViewError {
    /// The system has no display that a window could be on.
    #[error(
        "there is no display to open a window on: neither DISPLAY nor WAYLAND_DISPLAY is set\n  \
         `lightloom render PIPELINE SCENE -o FILE --watch` renders again at every save, without a window"
    )]
    NoDisplay,
    /// The window, or the device that draws it, could not be made.
    #[error(
        "no window can be opened: {0}\n  \
         `lightloom render PIPELINE SCENE -o FILE --watch` renders again at every save, without a window"
    )]
    Window(#[from] eframe::Error),
}

/// Whether there is a display; other systems than those of X11 and Wayland always have one.
fn has_display() -> bool {
    let named = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    !cfg!(all(unix, not(target_vendor = "apple")))
        || ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"].into_iter().any(named)
}

/// Returns the options to present frames: without waiting for the screen, which takes a tenth of a second where the driver renders on the
/// processor. Nothing is drawn unless something changed.
fn surface() -> eframe::egui_wgpu::WgpuConfiguration {
    let mut options = eframe::egui_wgpu::WgpuConfiguration::default();
    options.surface.present_mode = renderer::wgpu::PresentMode::AutoNoVsync;
    options
}

/// Opens the window, and returns when it is closed.
///
/// # Errors
/// There is no display, or no adapter that can draw a window.
pub fn run(options: Options) -> Result<(), ViewError> {
    if !has_display() {
        return Err(ViewError::NoDisplay);
    }
    let native = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("Lightloom")
            .with_app_id("lightloom")
            .with_inner_size([1280.0, 800.0])
            .with_min_inner_size([480.0, 320.0]),
        persistence_path: options.state.clone(),
        wgpu_options: surface(),
        // The text is in English, and the fonts that come with the program have all of it.
        system_font_fallback: false,
        ..eframe::NativeOptions::default()
    };
    eframe::run_native(
        "lightloom",
        native,
        Box::new(|context| {
            if let Some(state) = &context.wgpu_render_state {
                painter::install(&context.egui_ctx, state);
            }
            let remembered = Remembered::load(context.storage);
            let Options { catalog, pipeline, scene, overrides, seed, editor, .. } = options;
            let start = engine::Start {
                catalog,
                pipeline: pipeline.unwrap_or_else(|| remembered.pipeline.clone()),
                scene: scene.unwrap_or_else(|| remembered.scene.clone()),
                overrides,
                // Until the window says how large it is: a processor takes long for more.
                size: (96, 72),
                seed,
            };
            let mut app = App::new(&context.egui_ctx, start, remembered);
            app.editor = editor.map(editor::Editor);
            Ok(Box::new(app))
        }),
    )
    .map_err(ViewError::Window)
}
