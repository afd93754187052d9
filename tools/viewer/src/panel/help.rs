//! The keys.

use crate::action::{IN_THE_PICTURE, table};
use crate::app::App;
use eframe::egui::scroll_area::ScrollBarVisibility;
use eframe::egui::{Align2, Context, Grid, Key, Modifiers, RichText, ScrollArea, Ui, Vec2, Window, vec2};

/// What the window leaves free around it \[points\].
const MARGIN: Vec2 = vec2(60.0, 110.0);

/// The width from which on there are two columns \[points\].
const BESIDE: f32 = 900.0;

pub(crate) fn show(app: &mut App, context: &Context) {
    let mut open =
        app.help && !context.input_mut(|input| app.help && input.consume_key(Modifiers::NONE, Key::Escape));
    let space = context.content_rect().size() - MARGIN;
    let window = Window::new("Keys").open(&mut open).collapsible(false).resizable(false);
    window.anchor(Align2::CENTER_CENTER, [0.0, 0.0]).show(context, |ui| {
        let area = ScrollArea::vertical().max_height(space.y).min_scrolled_height(space.y).max_width(space.x);
        area.scroll_bar_visibility(ScrollBarVisibility::VisibleWhenNeeded).show(ui, |ui| {
            let keys: Vec<(String, &str)> = table()
                .iter()
                .map(|entry| {
                    (entry.key.map_or(String::new(), |key| context.format_shortcut(&key)), entry.about)
                })
                .collect();
            let mouse = IN_THE_PICTURE.map(|(input, about)| (input.to_owned(), about));
            // Side by side where both are seen whole.
            if space.x < BESIDE {
                rows(ui, "In the picture", &mouse);
                ui.add_space(8.0);
                rows(ui, "Keys", &keys);
            } else {
                let half = (keys.len() + mouse.len()).div_ceil(2);
                ui.horizontal_top(|ui| {
                    ui.vertical(|ui| rows(ui, "Keys", &keys[..half]));
                    ui.add_space(16.0);
                    ui.vertical(|ui| {
                        rows(ui, "More keys", &keys[half..]);
                        ui.add_space(8.0);
                        rows(ui, "In the picture", &mouse);
                    });
                });
            }
        });
    });
    app.help = open;
}

fn rows(ui: &mut Ui, title: &str, rows: &[(String, &str)]) {
    ui.strong(title);
    Grid::new(title).striped(true).num_columns(2).show(ui, |ui| {
        for (input, about) in rows {
            ui.label(RichText::new(input).monospace());
            ui.label(*about);
            ui.end_row();
        }
    });
}
