//! The panels around the picture.

pub(crate) mod bar;
pub(crate) mod compare;
pub(crate) mod graph;
pub(crate) mod help;
pub(crate) mod library;
pub(crate) mod log;
pub(crate) mod look;
pub(crate) mod save;
pub(crate) mod scene;
pub(crate) mod settings;
pub(crate) mod status;
pub(crate) mod time;
pub(crate) mod write;

use crate::action::Tab;
use crate::app::App;
use crate::engine::SideId;
use eframe::egui::{ComboBox, Ui};

/// Chooses whose resources a panel shows, where there are several sides.
fn choose_side(ui: &mut Ui, sides: &[SideId], chosen: &mut SideId) {
    if sides.len() < 2 {
        return;
    }
    ComboBox::from_label("of").selected_text(chosen.name()).show_ui(ui, |ui| {
        for id in sides {
            ui.selectable_value(chosen, *id, id.name());
        }
    });
}

/// Draws the panel on the right.
pub(crate) fn show(app: &mut App, ui: &mut Ui) {
    ui.horizontal_wrapped(|ui| {
        for tab in Tab::ALL {
            ui.selectable_value(&mut app.remembered.tab, *tab, tab.name());
        }
    });
    ui.separator();
    match app.remembered.tab {
        Tab::Time => time::show(app, ui),
        Tab::Graph => graph::show(app, ui),
        Tab::Look => look::show(app, ui),
        Tab::Scene => scene::show(app, ui),
        Tab::Compare => compare::show(app, ui),
        Tab::Write => write::show(app, ui),
        Tab::Log => log::show(app, ui),
    }
}
