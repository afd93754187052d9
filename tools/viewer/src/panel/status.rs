//! The line at the bottom: how fast, how large, on what.

use crate::app::App;
use crate::edits::counted;
use crate::engine::SideId;
use eframe::egui::{ComboBox, Label, Spinner, Ui};

/// Pixels of a frame per pixel of the screen that can be chosen.
const RESOLUTIONS: [(f32, &str); 5] =
    [(0.0, "auto"), (1.0, "100 %"), (0.5, "50 %"), (0.25, "25 %"), (0.125, "12.5 %")];

/// The window's width from which on the line has all that can be in it.
const WIDE: f32 = 1200.0;

/// A rate with two digits where it is small.
fn per_second(rate: f32) -> String {
    if rate < 9.95 { format!("{rate:.1}") } else { format!("{rate:.0}") }
}

pub(crate) fn show(app: &mut App, ui: &mut Ui) {
    ui.horizontal(|ui| {
        if let Some(stage) = &app.now.stage {
            ui.add(Spinner::new().size(14.0));
            ui.label(stage.describe());
            ui.separator();
        }
        if let Some(side) = app.now.side(SideId::A) {
            let (width, height) = side.plan.frame;
            let others = app.now.sides.iter().any(|(id, side)| *id != SideId::A && !side.idle);
            let state = match side.progress {
                Some(progress) if !progress.is_done() => format!("step {} of {}", progress.step, progress.steps),
                Some(_) => "converged".to_owned(),
                _ if side.idle && others => "A is done, others go on".to_owned(),
                // The picture is that of before what is being done.
                None if side.idle && app.now.stage.is_some() => format!("frame {} is shown", side.frames),
                None if side.idle => format!("idle after {}", counted(side.frames as usize, "frame")),
                None => format!("{} frames/s", per_second(app.now.frames_per_second)),
            };
            if let Some(whole) = side.whole.last() {
                ui.label(format!("{state} · frame {whole:.1} ms")).on_hover_text(
                    "Time of the last frame, from the call to pixels in memory. A pipeline does not run while nothing changes.",
                );
                ui.separator();
            }
            let before = app.remembered.resolution;
            let name = |scale: f32| RESOLUTIONS.iter().find(|(s, _)| *s == scale).map_or("auto", |(_, name)| name);
            let list = ComboBox::from_id_salt("resolution").selected_text(name(before)).width(64.0);
            let list = list.show_ui(ui, |ui| {
                for (scale, name) in RESOLUTIONS {
                    ui.selectable_value(&mut app.remembered.resolution, scale, name);
                }
            });
            list.response.on_hover_text("Resolution: pixels of a frame per pixel of the screen");
            ui.label(format!("{width}×{height}")).on_hover_text("Size of frames in pixels");
            ui.separator();
            ui.label(frame_graph::human_bytes(side.bytes)).on_hover_text("Memory of all objects of pipeline A on the device");
            ui.separator();
        }
        // The line is not wrapped: the picture would change its size with every word.
        let wide = ui.ctx().content_rect().width() >= WIDE;
        if wide {
            ui.label(format!("interface {:.1} ms", app.interface_ms))
                .on_hover_text("Mean time to lay out the interface itself; not part of the frame");
            ui.separator();
        }
        if let Some(ms) = app.now.reload_ms {
            ui.label(format!("reload {ms:.0} ms")).on_hover_text("Time from the last save of a file to its picture");
            ui.separator();
        }
        ui.add(Label::new(&app.now.adapter).truncate()).on_hover_text(&app.now.adapter);
    });
}
