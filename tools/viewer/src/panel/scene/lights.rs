//! Lights: moved, turned, added, removed, and changed in kind.

use super::{place, row, vector};
use crate::action::Action;
use crate::app::App;
use crate::panel::labelled;
use eframe::egui::{ComboBox, Grid, Slider, Ui};
use glam::{DVec3, Vec3};
use scene::{Light, LightKind};

/// The kinds that a light can get.
const KINDS: [(&str, LightKind); 3] = [
    ("spot", LightKind::Spot { inner: 0.0, outer: 0.5 }),
    ("point", LightKind::Point),
    ("directional", LightKind::Directional),
];

fn name_of(kind: LightKind) -> &'static str {
    match kind {
        LightKind::Spot { .. } => "spot",
        LightKind::Point => "point",
        LightKind::Directional => "directional",
    }
}

/// Returns a light of another kind that shines on the middle of the scene as brightly as before, and from the same side.
/// `extent` is that of the scene \[m\].
fn of_kind(light: &Light, kind: LightKind, middle: Vec3, extent: f32) -> Light {
    let (was_sun, is_sun) = (light.kind == LightKind::Directional, kind == LightKind::Directional);
    let mut light = Light { kind, ..light.clone() };
    if was_sun && !is_sun {
        // A light without a place gets one where it came from.
        light.position = middle - light.direction.normalize_or(Vec3::NEG_Y) * 0.4 * extent;
    }
    let to_middle = middle - light.position;
    let square = to_middle.length_squared().max(1e-4 * extent * extent);
    match (was_sun, is_sun) {
        (true, false) => light.intensity *= square,
        (false, true) => light.intensity /= square,
        _ => {}
    }
    // A point light has no direction of its own.
    if light.direction.length_squared() < 0.5 || !was_sun {
        let turned = to_middle.normalize_or(Vec3::NEG_Y);
        light.direction = if light.direction.length_squared() < 0.5 { turned } else { light.direction };
    }
    light
}

/// Returns a new light, near the middle of the scene, as bright as the others are in the mean.
fn another(lights: &[Light], middle: Vec3, extent: f32) -> Light {
    let name =
        (1..).map(|n| format!("new light {n}")).find(|name| lights.iter().all(|light| light.name != *name));
    let as_points = lights.iter().map(|light| of_kind(light, LightKind::Point, middle, extent).intensity);
    let intensity = match lights.len() {
        0 => Vec3::splat(0.1 * extent * extent),
        n => as_points.sum::<Vec3>() / n as f32,
    };
    Light {
        name: name.unwrap_or_default(),
        kind: LightKind::Point,
        position: middle + Vec3::new(0.0, 0.1 * extent, 0.0),
        direction: Vec3::NEG_Y,
        intensity,
    }
}

/// Shows the lights.
pub(super) fn show(app: &mut App, ui: &mut Ui) {
    let context = ui.ctx().clone();
    let mut lights = app.pilot.lights.clone().unwrap_or_else(|| app.now.lights.clone());
    let before = lights.clone();
    let (middle, extent) = app.now.scene.as_ref().map_or((Vec3::ZERO, 1.0), |view| {
        let (min, max) = view.scene.bounds();
        ((min + max) * 0.5, (max - min).length().max(1e-3))
    });
    let (mut record, mut remove) = (None, None);
    ui.horizontal_wrapped(|ui| {
        ui.strong("Lights");
        ui.checkbox(&mut app.remembered.handles, "Handles").on_hover_text("H");
        if ui.button("Add a light").clicked() {
            lights.push(another(&lights, middle, extent));
        }
        if app.pilot.lights.is_some() && ui.button("Give back").on_hover_text("B").clicked() {
            app.act(Action::SceneLights, &context);
        }
    });
    let origin = app.now.scene.as_ref().map_or(DVec3::ZERO, |view| view.scene.origin);
    for (i, light) in lights.iter_mut().enumerate() {
        ui.push_id(i, |ui| {
            ui.horizontal_wrapped(|ui| {
                let name = light.name.clone();
                let kind = labelled(ui, &name, |ui| {
                    let list = ComboBox::from_id_salt("kind").selected_text(name_of(light.kind)).width(90.0);
                    let list = list.show_ui(ui, |ui| {
                        for (name, kind) in KINDS {
                            if ui.selectable_label(name == name_of(light.kind), name).clicked()
                                && name != name_of(light.kind)
                            {
                                *light = of_kind(light, kind, middle, extent);
                            }
                        }
                    });
                    list.response
                });
                kind.on_hover_text("The kind of the light");
                if ui.small_button("Record a key").clicked() {
                    record = Some(i);
                }
                if ui.small_button("Remove").clicked() {
                    remove = Some(i);
                }
            });
            one(ui, light, origin, extent);
        });
    }
    if let Some(light) = record.map(|i| lights[i].clone()) {
        let time = app.time();
        app.scene_panel.record_light(&app.now, &light, time);
    }
    if let Some(i) = remove {
        lights.remove(i);
    }
    if lights != before {
        app.pilot.set_lights(&app.engine, lights);
    }
}

/// The numbers of a light.
fn one(ui: &mut Ui, light: &mut Light, origin: DVec3, extent: f32) {
    let name = light.name.clone();
    Grid::new("light").num_columns(2).show(ui, |ui| {
        if light.kind != LightKind::Directional {
            row(ui, "position", |ui, _| {
                place(ui, &format!("Position of {name}"), &mut light.position, origin, 0.003 * extent);
            });
        }
        if light.kind != LightKind::Point {
            row(ui, "direction", |ui, _| {
                let mut direction = light.direction;
                vector(ui, &format!("Direction of {name}"), &mut direction, 0.01);
                if direction != light.direction {
                    light.direction = direction.normalize_or(light.direction);
                }
            });
        }
        row(ui, "intensity", |ui, _| {
            let speed = 0.01 * light.intensity.max_element().max(1e-3);
            vector(ui, &format!("Intensity of {name}"), &mut light.intensity, speed);
            light.intensity = light.intensity.max(Vec3::ZERO);
        });
        if let LightKind::Spot { inner, outer } = &mut light.kind {
            row(ui, "half angle", |ui, label| {
                let mut degrees = outer.to_degrees();
                let slider = Slider::new(&mut degrees, 1.0..=90.0).suffix("°");
                if ui.add(slider).labelled_by(label).changed() {
                    *outer = degrees.to_radians();
                    *inner = inner.min(*outer);
                }
            });
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spot() -> Light {
        Light {
            name: "a".to_owned(),
            kind: LightKind::Spot { inner: 0.1, outer: 0.3 },
            position: Vec3::new(0.0, 4.0, 0.0),
            direction: Vec3::NEG_Y,
            intensity: Vec3::splat(32.0),
        }
    }

    #[test]
    fn a_light_of_another_kind_shines_as_brightly() {
        let middle = Vec3::new(0.0, 2.0, 0.0);
        let sun = of_kind(&spot(), LightKind::Directional, middle, 10.0);
        // 32 W/sr at two metres are 8 W/m².
        assert_eq!((sun.intensity, sun.direction), (Vec3::splat(8.0), Vec3::NEG_Y));
        let point = of_kind(&sun, LightKind::Point, middle, 10.0);
        let distance = point.position.distance(middle);
        assert_eq!((distance, point.intensity / (distance * distance)), (4.0, sun.intensity));
        assert!(point.position.y > middle.y, "it comes from where the sun was");
        let aimless = Light { direction: Vec3::ZERO, kind: LightKind::Point, ..spot() };
        assert_eq!(of_kind(&aimless, KINDS[0].1, middle, 10.0).direction, Vec3::NEG_Y);
    }

    #[test]
    fn a_new_light_has_a_name_of_its_own() {
        let first = another(&[spot()], Vec3::ZERO, 10.0);
        let second = another(&[spot(), first.clone()], Vec3::ZERO, 10.0);
        assert!(first.name != second.name, "{}", first.name);
        assert_eq!(first.intensity, Vec3::splat(32.0));
        assert!(another(&[], Vec3::ZERO, 2.0).intensity.min_element() > 0.0);
    }
}
