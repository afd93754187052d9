//! The panels around the picture.

pub(crate) mod bar;
pub(crate) mod compare;
pub(crate) mod graph;
pub(crate) mod help;
pub(crate) mod library;
pub(crate) mod log;
pub(crate) mod look;
pub(crate) mod open;
pub(crate) mod save;
pub(crate) mod scene;
pub(crate) mod settings;
pub(crate) mod status;
pub(crate) mod time;
pub(crate) mod write;

use crate::action::Tab;
use crate::app::App;
use crate::engine::SideId;
use eframe::egui::{ComboBox, Response, Ui};
use std::ops::RangeInclusive;

/// Chooses whose resources a panel shows, where there are several sides.
fn choose_side(ui: &mut Ui, sides: &[SideId], chosen: &mut SideId) {
    if sides.len() < 2 {
        return;
    }
    labelled(ui, "Side", |ui| {
        let list = ComboBox::from_id_salt("side").selected_text(chosen.name());
        let list = list.show_ui(ui, |ui| {
            for id in sides {
                ui.selectable_value(chosen, *id, id.name());
            }
        });
        list.response
    });
}

/// The share of the window's width that panels leave to the picture.
const PICTURE: f32 = 0.4;

/// Returns the widths that the panel of settings may have in a window of this width.
pub(crate) fn settings_width(window: f32) -> RangeInclusive<f32> {
    let most = (0.28 * window).max(120.0);
    most.min(180.0)..=most
}

/// Returns the widths that the panels on the right may have, beside the settings.
pub(crate) fn panels_width(window: f32, settings: f32) -> RangeInclusive<f32> {
    let most = (window * (1.0 - PICTURE) - settings).max(120.0);
    most.min(220.0)..=most
}

/// Draws a control behind its label, which is also its name for those who do not see it.
pub(crate) fn labelled(ui: &mut Ui, label: &str, control: impl FnOnce(&mut Ui) -> Response) -> Response {
    let label = ui.label(label);
    control(ui).labelled_by(label.id)
}

/// Draws the panel on the right.
pub(crate) fn show(app: &mut App, ui: &mut Ui) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        for tab in Tab::ALL {
            ui.selectable_value(&mut app.remembered.tab, *tab, tab.name());
        }
    });
    ui.separator();
    match app.remembered.tab {
        Tab::Time => time::show(app, ui),
        Tab::Graph => graph::show_details(app, ui),
        Tab::Look => look::show(app, ui),
        Tab::Scene => scene::show(app, ui),
        Tab::Compare => compare::show(app, ui),
        Tab::Write => write::show(app, ui),
        Tab::Log => log::show(app, ui),
    }
}
