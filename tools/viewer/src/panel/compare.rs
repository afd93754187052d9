//! The comparison of pipelines, with each other and with the reference.

use crate::action::{Action, View};
use crate::app::App;
use crate::engine::SideId;
use crate::leave::Leave;
use crate::panel::labelled;
use eframe::egui::{Grid, Slider, Ui};

pub(crate) fn show(app: &mut App, ui: &mut Ui) {
    let context = ui.ctx().clone();
    crate::snapshots::show(app, ui);
    ui.separator();
    let mut reference = app.reference;
    if ui.checkbox(&mut reference, "Reference: path tracing, which converges while nothing moves").changed() {
        app.act(Action::Reference, &context);
    }
    if let Some(side) = app.now.side(SideId::Reference) {
        let steps =
            side.progress.map_or(String::new(), |p| format!("{} of {} samples a pixel", p.step, p.steps));
        ui.weak(format!("{} · {steps}", side.name));
    }
    if app.now.sides.len() < 2 {
        ui.label("Choose a pipeline B in the bar, or start the reference.");
        return;
    }
    ui.horizontal(|ui| {
        if ui.button("Exchange A and B").on_hover_text("X").clicked() {
            app.act(Action::Swap, &context);
        }
        if ui.button("Copy A to B").clicked()
            && let Some(a) = app.now.side(SideId::A)
        {
            let (name, overrides) = (a.name.clone(), a.overrides.clone());
            app.leave(Leave::Pipeline(SideId::B, name, overrides), &context);
        }
    });
    ui.separator();
    ui.horizontal_wrapped(|ui| {
        for view in View::ALL {
            ui.selectable_value(&mut app.remembered.view, *view, view.name());
        }
    });
    match app.remembered.view {
        View::Difference => {
            let gain = Slider::new(&mut app.remembered.gain, 0.1..=1000.0).logarithmic(true);
            ui.horizontal(|ui| labelled(ui, "Factor", |ui| ui.add(gain)));
        }
        View::Split => {
            let split = Slider::new(&mut app.remembered.split, 0.0..=1.0);
            ui.horizontal(|ui| labelled(ui, "Split", |ui| ui.add(split)));
        }
        View::Flicker => {
            ui.weak("Space changes between A and B.");
        }
        _ => {}
    }
    ui.checkbox(&mut app.remembered.errors, "Errors in numbers");
    let Some(measured) = app.now.measured.clone().filter(|_| app.remembered.errors) else { return };
    Grid::new("errors").striped(true).num_columns(6).show(ui, |ui| {
        for head in ["of", "against", "RMSE", "relMSE", "FLIP", "energy"] {
            ui.weak(head);
        }
        ui.end_row();
        for errors in &measured.errors {
            ui.label(errors.of.name());
            ui.label(errors.to.name());
            ui.label(format!("{:.3e}", errors.rmse));
            ui.label(errors.rel_mse.map_or("–".to_owned(), |value| format!("{value:.4}")));
            ui.label(format!("{:.4}", errors.flip));
            ui.label(errors.energy.map_or("–".to_owned(), |value| format!("{value:.3}")));
            ui.end_row();
        }
    });
    ui.weak(
        "RMSE in W/(m² sr); energy is the ratio of mean luminances. Errors are measured while frames go on.",
    );
}
