//! The times of passes.

use crate::app::App;
use crate::edits::counted;
use crate::engine::{Command, PassTimes, SideId, SideView};
use eframe::egui::{Color32, Grid, Painter, Rect, ScrollArea, Sense, Stroke, Ui, pos2, vec2};

pub(crate) fn show(app: &mut App, ui: &mut Ui) {
    let sides: Vec<(SideId, SideView)> = app.now.sides.clone();
    ui.horizontal_wrapped(|ui| {
        let about =
            "Timed passes do not overlap on the GPU. Times are read some frames later, without waiting.";
        if ui.checkbox(&mut app.timing, "Time each pass").on_hover_text(about).changed() {
            app.engine.send(Command::Timing(app.timing));
        }
        let about =
            "Runs every pass of A and B again and again, also where nothing changes: for measurements";
        if ui.checkbox(&mut app.runs_everything, "Run every frame").on_hover_text(about).changed() {
            app.engine.send(Command::RunEverything(app.runs_everything));
        }
        if ui.button("Begin again").on_hover_text("Forgets the times so far").clicked() {
            app.engine.send(Command::ForgetTimes);
        }
    });
    ScrollArea::both().auto_shrink([false, false]).show(ui, |ui| {
        for (id, side) in &sides {
            ui.strong(format!("{}: {}", id.name(), side.name));
            ui.label(ran(side));
            table(ui, *id, side);
            ui.add_space(10.0);
        }
    });
}

/// Describes what ran in the last frame that had something to do.
fn ran(side: &SideView) -> String {
    if side.ran.is_empty() {
        return "No frame yet".to_owned();
    }
    let count = side.ran.iter().filter(|ran| **ran).count();
    let (width, height) = side.plan.frame;
    let of = format!("{count} of {} passes", side.plan.passes.len());
    let mean = counted(side.whole.all().len(), "frame");
    format!("{of} ran in the last frame; means over up to {mean} of {width}×{height}, in ms")
}

fn table(ui: &mut Ui, id: SideId, side: &SideView) {
    // What does not fit is scrolled to; the curve is what can be left out.
    let curve = ui.available_width() > 370.0;
    Grid::new(("times", id)).striped(true).spacing([8.0, 3.0]).show(ui, |ui| {
        for head in ["pass", "last", "mean", "± dev.", "CPU"] {
            ui.weak(head);
        }
        if curve {
            ui.weak("frames");
        }
        ui.end_row();
        let ms = |value: Option<f32>| value.map_or("–".to_owned(), |ms| format!("{ms:.3}"));
        let row = |ui: &mut Ui, name: &str, about: &str, ran: bool, times: &PassTimes| {
            let label = if ran { ui.label(name) } else { ui.weak(format!("{name} (kept)")) };
            label.on_hover_text(about);
            ui.label(ms(times.last()));
            ui.label(ms(times.mean()));
            ui.label(ms(times.deviation()));
            ui.label(format!("{:.3}", times.cpu()));
            if curve {
                sparkline(ui, times);
            }
            ui.end_row();
        };
        for (i, (pass, times)) in side.plan.passes.iter().zip(side.times.iter()).enumerate() {
            let ran = side.ran.get(i) != Some(&false);
            let kept =
                ": did not run in the last frame, for nothing that it reads had changed; its times are older";
            let about = format!("{}{}", pass.kind, if ran { "" } else { kept });
            row(ui, &pass.name, &about, ran, times);
        }
        let sum = Sum::of(side);
        ui.strong(if sum.timed == sum.ran { "those that ran" } else { "those timed" })
            .on_hover_text("The sum over the passes that ran in the last frame, as far as they are timed");
        ui.strong(format!("{:.3}", sum.last));
        ui.strong(format!("{:.3}", sum.mean));
        ui.label("");
        ui.strong(format!("{:.3}", sum.cpu));
        ui.end_row();
        row(ui, "frame", "From the call to pixels in memory", true, &side.whole);
    });
}

/// The sums over the passes that ran in the last frame \[ms\].
#[derive(Debug, Default, PartialEq)]
struct Sum {
    last: f32,
    mean: f32,
    cpu: f32,
    /// The number of passes that ran, and of those of them that have a time.
    ran: usize,
    timed: usize,
}

impl Sum {
    fn of(side: &SideView) -> Sum {
        let mut sum = Sum::default();
        for times in side.times.iter().zip(&side.ran).filter(|(_, ran)| **ran).map(|(times, _)| times) {
            sum.ran += 1;
            sum.timed += usize::from(times.last().is_some());
            sum.last += times.last().unwrap_or_default();
            sum.mean += times.mean().unwrap_or_default();
            sum.cpu += times.cpu();
        }
        sum
    }
}

/// The last times as a line, from 0 to the greatest.
fn sparkline(ui: &mut Ui, times: &PassTimes) {
    let (rect, response) = ui.allocate_exact_size(vec2(70.0, 16.0), Sense::hover());
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
