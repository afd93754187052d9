//! The messages.

use crate::app::App;
use eframe::egui::{Label, RichText, ScrollArea, Ui};

pub(crate) fn show(app: &mut App, ui: &mut Ui) {
    let messages = app.now.messages.clone();
    ScrollArea::vertical().auto_shrink([false, false]).stick_to_bottom(true).show(ui, |ui| {
        for message in messages.iter() {
            let text = format!(
                "{:8.2} s  {}",
                message.time.duration_since(app.begun).as_secs_f64(),
                message.text.trim_end()
            );
            let text = RichText::new(text).monospace();
            let text = if message.error { text.color(ui.visuals().error_fg_color) } else { text };
            ui.add(Label::new(text).wrap());
        }
    });
}
