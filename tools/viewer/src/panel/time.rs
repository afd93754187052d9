//! The times of passes.

use crate::app::App;
use crate::engine::{Command, PassTimes, SideId, SideView};
use eframe::egui::{Color32, Grid, Painter, Rect, ScrollArea, Sense, Stroke, Ui, pos2, vec2};

pub(crate) fn show(app: &mut App, ui: &mut Ui) {
    let sides: Vec<(SideId, SideView)> = app.now.sides.clone();
    ScrollArea::both().auto_shrink([false, false]).show(ui, |ui| {
        for (id, side) in &sides {
            ui.strong(format!("{}: {}", id.name(), side.name));
            table(ui, *id, side);
            ui.add_space(10.0);
        }
        let about =
            "Timed passes do not overlap on the GPU. Times are read some frames later, without waiting.";
        if ui.checkbox(&mut app.timing, "Time each pass").on_hover_text(about).changed() {
            app.engine.send(Command::Timing(app.timing));
        }
    });
}

fn table(ui: &mut Ui, id: SideId, side: &SideView) {
    Grid::new(("times", id)).striped(true).num_columns(6).show(ui, |ui| {
        for head in ["pass", "last", "mean", "± dev.", "CPU", "last frames"] {
            ui.weak(head);
        }
        ui.end_row();
        let ms = |value: Option<f32>| value.map_or("–".to_owned(), |ms| format!("{ms:.3}"));
        let row = |ui: &mut Ui, name: &str, about: &str, ran: bool, times: &PassTimes| {
            let label = if ran { ui.label(name) } else { ui.weak(name) };
            label.on_hover_text(about);
            ui.label(ms(times.last()));
            ui.label(ms(times.mean()));
            ui.label(ms(times.deviation()));
            ui.label(format!("{:.3}", times.cpu()));
            sparkline(ui, times);
            ui.end_row();
        };
        for (i, (pass, times)) in side.plan.passes.iter().zip(side.times.iter()).enumerate() {
            let ran = side.ran.get(i) == Some(&true);
            let about = format!("{}{}", pass.kind, if ran { "" } else { ": did not run in the last frame" });
            row(ui, &pass.name, &about, ran, times);
        }
        let of_last = side.times.iter().zip(&side.ran).filter(|(_, ran)| **ran);
        let last = of_last.filter_map(|(times, _)| times.last()).fold(0.0, |sum, ms| sum + ms);
        let mean = side.times.iter().filter_map(PassTimes::mean).fold(0.0, |sum, ms| sum + ms);
        let cpu = side.times.iter().fold(0.0, |sum, times| sum + times.cpu());
        ui.strong("all passes");
        ui.strong(format!("{last:.3}"));
        ui.strong(format!("{mean:.3}"));
        ui.label("");
        ui.strong(format!("{cpu:.3}"));
        ui.end_row();
        row(ui, "frame", "From the call to pixels in memory", true, &side.whole);
    });
    ui.weak("ms");
}

/// The last times as a line, from 0 to the greatest.
fn sparkline(ui: &mut Ui, times: &PassTimes) {
    let (rect, response) = ui.allocate_exact_size(vec2(90.0, 16.0), Sense::hover());
    let most = times.all().fold(0.0, f32::max);
    if most <= 0.0 || times.all().len() < 2 {
        return;
    }
    let color = ui.visuals().strong_text_color();
    line(&ui.painter_at(rect), rect, times, most, color);
    response.on_hover_text(format!("The last {} frames, 0 to {most:.3} ms", times.all().len()));
}

fn line(painter: &Painter, rect: Rect, times: &PassTimes, most: f32, color: Color32) {
    let count = times.all().len();
    let points = times.all().enumerate().map(|(i, ms)| {
        let x = rect.left() + rect.width() * i as f32 / (count - 1) as f32;
        pos2(x, rect.bottom() - 1.0 - (rect.height() - 2.0) * ms / most)
    });
    painter.line(points.collect(), Stroke::new(1.0, color));
}
