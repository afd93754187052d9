//! The keys.

use crate::action::{IN_THE_PICTURE, table};
use crate::app::App;
use eframe::egui::{Context, Grid, Key, Modifiers, RichText, ScrollArea, Window};

pub(crate) fn show(app: &mut App, context: &Context) {
    let mut open =
        app.help && !context.input_mut(|input| app.help && input.consume_key(Modifiers::NONE, Key::Escape));
    Window::new("Keys").open(&mut open).collapsible(false).default_size([470.0, 620.0]).show(context, |ui| {
        ScrollArea::vertical().max_height(context.content_rect().height() * 0.75).show(ui, |ui| {
            ui.strong("In the picture");
            Grid::new("mouse").striped(true).num_columns(2).show(ui, |ui| {
                for (input, about) in IN_THE_PICTURE {
                    ui.label(RichText::new(input).monospace());
                    ui.label(about);
                    ui.end_row();
                }
            });
            ui.add_space(8.0);
            ui.strong("Keys");
            Grid::new("keys").striped(true).num_columns(2).show(ui, |ui| {
                for entry in table() {
                    let key = entry.key.map_or(String::new(), |key| context.format_shortcut(&key));
                    ui.label(RichText::new(key).monospace());
                    ui.label(entry.about);
                    ui.end_row();
                }
            });
        });
    });
    app.help = open;
}
