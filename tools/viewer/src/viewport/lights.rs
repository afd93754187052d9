//! The virtual lights over the picture: where they are, what they shine, what they stand for.

use super::Placed;
use crate::app::App;
use crate::camera::metres_per_pixel;
use eframe::egui::{Color32, Stroke, Ui, vec2};
use glam::Vec3;
use scene::Camera;

/// The most that are drawn: beyond that, dots hide the picture.
const MOST: usize = 20_000;

/// Draws a dot for each light, of its color and as large as its flux, in a ring as large as its area. Those that are new
/// in this frame have a white ring.
pub(super) fn show(app: &App, ui: &Ui, placed: Placed, camera: &Camera) {
    let painter = ui.painter_at(placed.rect);
    let lights = &app.now.virtual_lights;
    let flux = |light: &[f32; 3]| light.iter().sum::<f32>();
    let all: f32 = lights.iter().map(|(light, _)| flux(&light.flux)).sum();
    let mean = all / lights.len().max(1) as f32;
    let height = placed.rect.height();
    for (light, is_new) in lights.iter().take(MOST) {
        let position = Vec3::from(light.position);
        let Some(at) = placed.project(camera, position).filter(|at| placed.rect.contains(*at)) else {
            continue;
        };
        let share = if mean > 0.0 { (flux(&light.flux) / mean).max(0.0) } else { 0.0 };
        let radius = (2.0 * share.sqrt()).clamp(1.0, 8.0);
        let most = light.flux.iter().copied().fold(f32::MIN_POSITIVE, f32::max);
        let channel = |c: f32| (metrics::srgb_from_linear((c / most).clamp(0.0, 1.0)) * 255.0) as u8;
        let color = Color32::from_rgb(channel(light.flux[0]), channel(light.flux[1]), channel(light.flux[2]));
        if light.area > 0.0 {
            let metres = (light.area / std::f32::consts::PI).sqrt();
            let ring = metres / metres_per_pixel(camera, position, height);
            if ring > radius && ring < height {
                painter.circle_stroke(at, ring, Stroke::new(0.5, color.gamma_multiply(0.6)));
            }
        }
        painter.circle(at, radius, color, Stroke::new(1.0, Color32::BLACK));
        if *is_new {
            painter.circle_stroke(at, radius + 2.0, Stroke::new(1.0, Color32::WHITE));
        }
    }
    let new = lights.iter().filter(|(_, is_new)| *is_new).count();
    let text = format!("{} virtual lights, {new} new in this frame", lights.len());
    super::label(&painter, placed.rect.left_bottom() - vec2(0.0, 50.0), &text);
}
