//! Cameras that the user goes back to. They are kept with the state of the window, scene by scene.

use crate::app::App;
use eframe::egui::{TextEdit, Ui, WidgetInfo};
use glam::Vec3;
use scene::Camera;
use serde::{Deserialize, Serialize};

/// A camera of a scene, with a name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Bookmark {
    /// The scene.
    pub(crate) scene: String,
    /// The name.
    pub(crate) name: String,
    /// The camera.
    pub(crate) camera: Camera,
}

impl App {
    /// Keeps the camera as it is now.
    pub(crate) fn bookmark(&mut self) {
        let (Some(camera), Some(view)) = (self.pilot.camera().or(self.now.camera), &self.now.scene) else {
            return;
        };
        let scene = view.scene.spec.clone();
        let is_free = |name: &String| self.bookmarks().all(|known| known.name != *name);
        let name = (1..).map(|n| format!("view {n}")).find(is_free).unwrap_or_default();
        self.remembered.bookmarks.push(Bookmark { scene, name, camera });
    }

    /// Returns the bookmarks of the scene that is shown.
    pub(crate) fn bookmarks(&self) -> impl Iterator<Item = &Bookmark> {
        let scene = self.now.scene.as_ref().map(|view| view.scene.spec.as_str());
        self.remembered.bookmarks.iter().filter(move |bookmark| Some(bookmark.scene.as_str()) == scene)
    }

    /// Moves the bookmarks of a scene with its origin.
    pub(crate) fn shift_bookmarks(&mut self, scene: &str, by: Vec3) {
        for bookmark in self.remembered.bookmarks.iter_mut().filter(|bookmark| bookmark.scene == scene) {
            bookmark.camera.position += by;
            bookmark.camera.target += by;
        }
    }

    /// Flies to a bookmark of this name.
    pub(crate) fn go_to_bookmark(&mut self, name: &str) {
        let to = self.bookmarks().find(|bookmark| bookmark.name == name).map(|bookmark| bookmark.camera);
        if let (Some(from), Some(to)) = (self.pilot.camera().or(self.now.camera), to) {
            self.pilot.fly_to(from, to);
        }
    }
}

/// Shows the bookmarks of the scene; returns the camera of the one that is chosen.
pub(super) fn show(app: &mut App, ui: &mut Ui, now: &Camera) -> Option<Camera> {
    let scene = app.now.scene.as_ref()?.scene.spec.clone();
    ui.horizontal(|ui| {
        ui.strong("Bookmarks");
        if ui.button("Add").on_hover_text("Ctrl-B: keep the camera as it is now").clicked() {
            app.bookmark();
        }
    });
    let (mut chosen, mut removed) = (None, None);
    for (i, bookmark) in app.remembered.bookmarks.iter_mut().enumerate() {
        if bookmark.scene != scene {
            continue;
        }
        ui.push_id(("bookmark", i), |ui| {
            ui.horizontal(|ui| {
                let name = ui.add(TextEdit::singleline(&mut bookmark.name).desired_width(120.0));
                name.widget_info(|| {
                    WidgetInfo::labeled(eframe::egui::Role::TextInput, true, "Name of a bookmark")
                });
                if ui.add_enabled(bookmark.camera != *now, eframe::egui::Button::new("Go")).clicked() {
                    chosen = Some(bookmark.camera);
                }
                if ui.button("Remove").clicked() {
                    removed = Some(i);
                }
            });
        });
    }
    if let Some(i) = removed {
        app.remembered.bookmarks.remove(i);
    }
    chosen
}
