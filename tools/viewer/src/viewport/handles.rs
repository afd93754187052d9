//! Handles by which lights are moved and turned.

use super::Placed;
use crate::app::App;
use crate::camera::{metres_per_pixel, shifted};
use eframe::egui::{self, Align2, Color32, CursorIcon, FontId, Sense, Stroke, Ui, Vec2, vec2};
use glam::Vec3;
use scene::{Camera, Light, LightKind};

/// Length of an arrow in points of the screen.
const ARROW: f32 = 60.0;

/// Draws the handles over a picture, of which this is the number, and takes what is dragged; returns whether the mouse is over one, or drags one.
pub(super) fn show(app: &mut App, ui: &mut Ui, number: usize, placed: Placed, camera: &Camera) -> bool {
    let mut lights = app.pilot.lights.clone().unwrap_or_else(|| app.now.lights.clone());
    let middle = app.now.scene.as_ref().map_or(Vec3::ZERO, |scene| {
        let (min, max) = scene.scene.bounds();
        (min + max) * 0.5
    });
    let (mut busy, mut changed) = (false, false);
    for (i, light) in lights.iter_mut().enumerate() {
        // A directional light has no place: its arrow stands in the middle of the scene.
        let base = if light.kind == LightKind::Directional { middle } else { light.position };
        let Some(at) = placed.project(camera, base).filter(|at| placed.rect.expand(20.0).contains(*at))
        else {
            continue;
        };
        let id = ui.scope_id().with(("light", number, i));
        let (moved, over) = handle(ui, id, at, &format!("Light {}: drag to move", light.name));
        busy |= over;
        if moved != Vec2::ZERO && light.kind != LightKind::Directional {
            light.position =
                shifted(camera, light.position, glam::Vec2::new(moved.x, moved.y), placed.rect.height());
            changed = true;
        }
        if light.kind != LightKind::Point {
            let metres = ARROW * metres_per_pixel(camera, base, placed.rect.height());
            let tip = base + light.direction * metres;
            if let Some(tip_at) = placed.project(camera, tip) {
                let arrow = Stroke::new(2.0, color(light));
                ui.painter_at(placed.rect).arrow(at, tip_at - at, arrow);
                let (turned, over) =
                    handle(ui, id.with("tip"), tip_at, &format!("Light {}: drag to turn", light.name));
                busy |= over;
                if turned != Vec2::ZERO {
                    let to = shifted(camera, tip, glam::Vec2::new(turned.x, turned.y), placed.rect.height());
                    light.direction = (to - base).normalize_or(light.direction);
                    changed = true;
                }
            }
        }
        let painter = ui.painter_at(placed.rect);
        painter.circle(at, 7.0, color(light), Stroke::new(1.5, Color32::BLACK));
        let name = at + vec2(11.0, 0.0);
        let font = FontId::proportional(12.0);
        painter.text(name + vec2(1.0, 1.0), Align2::LEFT_CENTER, &light.name, font.clone(), Color32::BLACK);
        painter.text(name, Align2::LEFT_CENTER, &light.name, font, Color32::WHITE);
    }
    if changed {
        app.pilot.set_lights(&app.engine, lights);
        ui.ctx().request_repaint();
    }
    busy
}

/// A place that can be dragged: by how much it was, and whether the mouse is over it.
fn handle(ui: &Ui, id: egui::Id, at: egui::Pos2, name: &str) -> (Vec2, bool) {
    let rect = egui::Rect::from_center_size(at, Vec2::splat(20.0));
    let response = ui.interact(rect, id, Sense::drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Unknown, true, name));
    let over = response.hovered() || response.dragged();
    let moved = response.drag_delta();
    response.on_hover_and_drag_cursor(CursorIcon::Move);
    (moved, over)
}

/// The color that a light shines in, as bright as the screen can.
fn color(light: &Light) -> Color32 {
    let most = light.intensity.max_element().max(f32::MIN_POSITIVE);
    let channel = |c: f32| (metrics::srgb_from_linear((c / most).clamp(0.0, 1.0)) * 255.0) as u8;
    let [r, g, b] = light.intensity.to_array().map(channel);
    Color32::from_rgb(r, g, b)
}
