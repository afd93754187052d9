//! Camera, lights and keys of the scene.

mod bookmarks;
mod lights;

use crate::action::Action;
use crate::app::App;
use crate::edits::counted;
use crate::engine::Published;
pub(crate) use bookmarks::Bookmark;
use eframe::egui::{DragValue, Grid, Id, Response, ScrollArea, Slider, Ui};
use glam::{DVec3, Vec3};
use scene::{Camera, CameraKey, Light, LightKey, LightKind, SceneEdit, SceneKeys};

/// Keys that are edited, on top of those of the scene's file.
#[derive(Default)]
pub(crate) struct ScenePanel {
    /// `None` until there is one to add or to take away.
    keys: Option<SceneKeys>,
    /// The keys of the file, where they are edited.
    of_file: SceneKeys,
}

impl ScenePanel {
    /// The keys as they are edited: those of the file at first.
    fn keys(&mut self, now: &Published) -> &mut SceneKeys {
        let of_file = || {
            let view = now.scene.as_ref()?;
            // The errors of a file were reported when it was loaded.
            scene::keys_of(view.file.as_ref()?, view.scene.origin).ok()
        };
        if self.keys.is_none() {
            self.of_file = of_file().unwrap_or_default();
        }
        self.keys.get_or_insert_with(|| self.of_file.clone())
    }

    /// Returns the keys as they are edited; `None` where those of the file stand.
    pub(crate) fn edited_keys(&self) -> Option<SceneKeys> {
        self.keys.clone()
    }

    /// Edits these keys.
    pub(crate) fn set_keys(&mut self, keys: Option<SceneKeys>) {
        self.keys = keys;
    }

    /// Returns whether there are keys that are not in the file.
    pub(crate) fn has_unsaved_keys(&self) -> bool {
        self.keys.as_ref().is_some_and(|keys| *keys != self.of_file)
    }

    /// Forgets the keys, which are in the file now.
    pub(crate) fn saved(&mut self) {
        self.keys = None;
    }

    /// Records a key of the camera at a time \[s\], in place of one that is there.
    pub(crate) fn record(&mut self, now: &Published, camera: Camera, time: f32) {
        let keys = &mut self.keys(now).camera;
        keys.retain(|key| key.time != time);
        keys.push(CameraKey { time, position: Some(camera.position), target: Some(camera.target) });
        keys.sort_by(|a, b| a.time.total_cmp(&b.time));
    }

    /// Records a key of a light at a time \[s\].
    fn record_light(&mut self, now: &Published, light: &Light, time: f32) {
        let keys = self.keys(now).lights.entry(light.name.clone()).or_default();
        keys.retain(|key| key.time != time);
        let (point, sun) = (light.kind == LightKind::Point, light.kind == LightKind::Directional);
        keys.push(LightKey {
            time,
            position: (!sun).then_some(light.position),
            direction: (!point).then_some(light.direction),
            intensity: Some(light.intensity),
        });
        keys.sort_by(|a, b| a.time.total_cmp(&b.time));
    }

    /// Returns the differences from the scene as it was loaded.
    pub(crate) fn edit(&self, app: &App) -> SceneEdit {
        let own = app.now.scene.as_ref().map(|view| &view.scene);
        let is_own = |name: &str| own.is_some_and(|scene| scene.lights.iter().any(|own| own.name == name));
        let moved = |light: &&Light| {
            own.is_none_or(|scene| scene.lights.iter().all(|own| own.name != light.name || own != *light))
        };
        let digits = own.map_or(4, |scene| {
            let (min, max) = scene.bounds();
            digits((max - min).length())
        });
        let round = |value: Vec3| rounded(value, digits);
        let moved = app.pilot.lights.iter().flatten().filter(moved).cloned();
        // What was not moved stays as it is written.
        let kept = |value: Vec3, of: Option<Vec3>, digits: i32| {
            if of == Some(value) { value } else { rounded(value, digits) }
        };
        let gone = |light: &&Light| {
            let stays = |user: &[Light]| user.iter().any(|user| user.name == light.name);
            app.pilot.lights.as_ref().is_some_and(|user| !stays(user))
        };
        let removed = own.iter().flat_map(|scene| &scene.lights).filter(gone).map(|light| light.name.clone());
        let lights = moved.map(|light| {
            let before = own.and_then(|scene| scene.lights.iter().find(|own| own.name == light.name));
            Light {
                position: kept(light.position, before.map(|light| light.position), digits),
                direction: kept(light.direction, before.map(|light| light.direction), 4),
                ..light
            }
        });
        let camera = app.pilot.camera().map(|camera| Camera {
            position: round(camera.position),
            target: round(camera.target),
            ..camera
        });
        let mut keys = self.keys.clone();
        for key in keys.iter_mut().flat_map(|keys| &mut keys.camera) {
            (key.position, key.target) = (key.position.map(round), key.target.map(round));
        }
        for key in keys.iter_mut().flat_map(|keys| keys.lights.values_mut().flatten()) {
            key.position = key.position.map(round);
        }
        let (lights, added): (Vec<Light>, Vec<Light>) = lights.partition(|light| is_own(&light.name));
        SceneEdit {
            camera,
            lights,
            added,
            removed: removed.collect(),
            camera_keys: keys.as_ref().map(|keys| keys.camera.clone()).filter(|keys| !keys.is_empty()),
            light_keys: keys.map_or_else(Default::default, |keys| keys.lights),
            origin: own.map_or(DVec3::ZERO, |scene| scene.origin),
        }
    }
}

/// The decimals by which places in a scene of this extent \[m\] differ visibly: a hundred-thousandth of it.
fn digits(extent: f32) -> i32 {
    if extent > 0.0 && extent.is_finite() { (5 - extent.log10().floor() as i32).clamp(0, 12) } else { 4 }
}

/// A place as a person would write it: what the mouse gives has digits that mean nothing.
fn rounded(value: Vec3, digits: i32) -> Vec3 {
    let scale = 10f64.powi(digits);
    Vec3::from(value.to_array().map(|x| ((f64::from(x) * scale).round() / scale) as f32))
}

pub(crate) fn show(app: &mut App, ui: &mut Ui) {
    let context = ui.ctx().clone();
    let Some(view) = app.now.scene.clone() else { return };
    ui.strong(&view.scene.name);
    ui.label(&view.scene.about);
    let (triangles, count) = (view.scene.triangles(), view.scene.lights.len());
    ui.weak(format!("{}, {}", counted(triangles, "triangle"), counted(count, "light")));
    ui.horizontal_wrapped(|ui| {
        if ui.button("Save into the scene's file").on_hover_text("Ctrl-E").clicked() {
            app.act(Action::SaveScene, &context);
        }
        if ui.button("Record a key").on_hover_text("K: the camera at the time shown").clicked() {
            app.act(Action::Key, &context);
        }
    });
    ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        camera(app, ui);
        ui.separator();
        lights::show(app, ui);
        ui.separator();
        keys(app, ui);
    });
}

fn camera(app: &mut App, ui: &mut Ui) {
    let Some(before) = app.pilot.camera().or(app.now.camera) else { return };
    let mut camera = before;
    let origin = app.now.scene.as_ref().map_or(DVec3::ZERO, |view| view.scene.origin);
    let context = ui.ctx().clone();
    ui.horizontal(|ui| {
        ui.strong("Camera");
        let own = if app.pilot.camera().is_some() { "moved by you" } else { "the scene's own" };
        ui.weak(own);
        if app.pilot.camera().is_some() && ui.button("Give back").on_hover_text("C").clicked() {
            app.act(Action::SceneCamera, &context);
        }
    });
    Grid::new("camera").num_columns(2).show(ui, |ui| {
        let speed = 0.01 * (before.position - before.target).length().max(1e-3);
        row(ui, "position", |ui, _| place(ui, "Camera position", &mut camera.position, origin, speed));
        row(ui, "target", |ui, _| place(ui, "Camera target", &mut camera.target, origin, speed));
        row(ui, "vertical angle", |ui, label| {
            let mut degrees = camera.vertical_fov.to_degrees();
            let slider = Slider::new(&mut degrees, 5.0..=150.0).suffix("°");
            if ui.add(slider).labelled_by(label).changed() {
                camera.vertical_fov = degrees.to_radians();
            }
        });
    });
    let views = app.now.scene.as_ref().map_or_else(Vec::new, |view| view.scene.cameras.clone());
    ui.horizontal_wrapped(|ui| {
        for (name, of_file) in views {
            if ui.button(&name).on_hover_text("A camera of the geometry's file").clicked() {
                camera = of_file;
            }
        }
    });
    if let Some(chosen) = bookmarks::show(app, ui, &before) {
        app.pilot.fly_to(before, chosen);
    }
    if camera != before && camera.position != camera.target {
        app.pilot.take(&app.engine, camera, false);
    }
}

fn keys(app: &mut App, ui: &mut Ui) {
    let now = app.now.clone();
    let Some(keys) = app.scene_panel.keys.as_mut() else {
        ui.strong("Keys");
        ui.weak("The keys of the scene's file. Recording adds to them.");
        if ui.button("Edit them").clicked() {
            app.scene_panel.keys(&now);
        }
        return;
    };
    ui.strong("Keys: they play once they are saved");
    let (mut go, mut drop_camera, mut drop_light) = (None, None, None);
    let mut line = |ui: &mut Ui, name: &str, time: f32| {
        let mut dropped = false;
        ui.horizontal(|ui| {
            if ui.button(format!("{time:.2} s")).on_hover_text("Go there").clicked() {
                go = Some(time);
            }
            ui.label(name);
            dropped = ui.small_button("Remove").clicked();
        });
        dropped
    };
    for (i, key) in keys.camera.iter().enumerate() {
        if ui.push_id(("camera", i), |ui| line(ui, "camera", key.time)).inner {
            drop_camera = Some(i);
        }
    }
    for (name, of_light) in &keys.lights {
        for (i, key) in of_light.iter().enumerate() {
            if ui.push_id((name, i), |ui| line(ui, name, key.time)).inner {
                drop_light = Some((name.clone(), i));
            }
        }
    }
    if let Some(i) = drop_camera {
        keys.camera.remove(i);
    }
    if let Some((name, i)) = drop_light
        && let Some(keys) = keys.lights.get_mut(&name)
    {
        keys.remove(i);
    }
    if let Some(time) = go {
        app.go_to_time(time);
    }
}

/// A row of a grid: a label, and what stands behind it.
fn row(ui: &mut Ui, name: &str, content: impl FnOnce(&mut Ui, Id)) {
    let label = ui.weak(name).id;
    ui.horizontal(|ui| content(ui, label));
    ui.end_row();
}

/// Three numbers, each with a name for those who cannot see the label.
fn vector(ui: &mut Ui, name: &str, value: &mut Vec3, speed: f32) {
    place(ui, name, value, DVec3::ZERO, speed);
}

/// The coordinates of a place relative to an origin, as the scene's file has them.
fn place(ui: &mut Ui, name: &str, value: &mut Vec3, origin: DVec3, speed: f32) {
    let axes = ["x", "y", "z"].into_iter().zip(value.as_mut());
    for ((axis, number), origin) in axes.zip(origin.to_array()) {
        let world = |set: Option<f64>| {
            if let Some(set) = set {
                *number = (set - origin) as f32;
            }
            origin + f64::from(*number)
        };
        let response: Response = ui.add(DragValue::from_get_set(world).speed(speed).max_decimals(4));
        response.widget_info(|| {
            eframe::egui::WidgetInfo::labeled(eframe::egui::Role::SpinButton, true, format!("{name} {axis}"))
        });
    }
}

/// Whether a camera is one that a file can hold.
pub(crate) fn can_be_saved(camera: &Camera) -> bool {
    camera.position.is_finite() && camera.target.is_finite() && camera.position != camera.target
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_rounded_by_the_extent_of_the_scene() {
        assert_eq!((digits(0.9), digits(30.0), digits(2e4), digits(0.0)), (6, 4, 1, 4));
        let value = rounded(Vec3::new(0.45107928, -1.0, 12.000001), 4);
        assert_eq!(value, Vec3::new(0.4511, -1.0, 12.0));
    }
}
