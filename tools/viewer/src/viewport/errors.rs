//! What is wrong, over the last good picture.

use crate::app::App;
use crate::editor::place;
use eframe::egui::{self, Color32, Rect, RichText, Ui, vec2};

/// Draws the errors that are not mended yet.
pub(super) fn show(app: &App, ui: &mut Ui, rect: Rect) {
    let fatal = app.now.fatal.iter().map(|text| ("cannot start", text.as_str()));
    let standing = app.now.troubles.iter().filter(|trouble| trouble.stands());
    let troubles = standing.clone().map(|trouble| (trouble.of, trouble.text.as_str()));
    let all: Vec<(&str, &str)> = fatal.chain(troubles).collect();
    if all.is_empty() {
        return;
    }
    if standing.filter_map(|trouble| trouble.until).next().is_some() {
        ui.ctx().request_repaint_after(std::time::Duration::from_millis(500));
    }
    let has_picture = |of: &str| {
        let mut sides = app.now.sides.iter().filter(|(id, _)| of == "scene" || id.name() == of);
        sides.any(|(_, side)| side.picture.is_some())
    };
    let around = rect.shrink(10.0);
    let area = egui::Area::new(ui.scope_id().with("errors")).fixed_pos(around.min).order(egui::Order::Middle);
    area.show(ui.ctx(), |ui| {
        let frame = egui::Frame::new()
            .fill(Color32::from_rgba_unmultiplied(40, 8, 8, 225))
            .stroke((1.0, Color32::from_rgb(200, 60, 50)))
            .corner_radius(4)
            .inner_margin(8);
        frame.show(ui, |ui| {
            ui.set_max_size(vec2(around.width() - 18.0, around.height() * 0.75));
            egui::ScrollArea::both().auto_shrink([true, true]).show(ui, |ui| {
                for (of, text) in all {
                    let head = if has_picture(of) {
                        format!("{of}: the last good picture stays until this is mended")
                    } else {
                        format!("{of}: there is a picture as soon as this is mended")
                    };
                    ui.label(RichText::new(head).color(Color32::from_rgb(255, 180, 170)));
                    ui.spacing_mut().item_spacing.y = 0.0;
                    for line in text.trim_end().lines() {
                        let text = RichText::new(line).monospace().color(Color32::WHITE);
                        if let (Some(editor), Some(place)) = (&app.editor, place(line)) {
                            if ui.link(text.underline()).clicked() {
                                editor.open(app.catalog.assets().root(), place);
                            }
                            continue;
                        }
                        // A caret points into the line above it, so neither may wrap.
                        let of_source = line.contains('│');
                        let label = egui::Label::new(text);
                        ui.add(if of_source { label.extend() } else { label.wrap() });
                    }
                }
            });
        });
    });
}
