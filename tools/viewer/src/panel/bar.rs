//! The bar at the top: what is rendered by what, and the animation.

use crate::action::{Action, View};
use crate::app::App;
use crate::engine::{Command, SideId};
use crate::leave::Leave;
use crate::panel::labelled;
use eframe::egui::{self, Button, ComboBox, Slider, Ui};
use frame_graph::Overrides;
use renderer::Named;

pub(crate) fn show(app: &mut App, ui: &mut Ui) {
    let context = ui.ctx().clone();
    ui.horizontal_wrapped(|ui| {
        let a =
            app.now.side(SideId::A).map_or_else(|| app.remembered.pipeline.clone(), |side| side.name.clone());
        let pipelines = app.library.pipelines().to_vec();
        if let Some(name) = choose(ui, "Pipeline A", &a, &pipelines, None) {
            app.leave(Leave::Pipeline(SideId::A, name, Overrides::default()), &context);
        }
        let scene =
            app.now.scene.as_ref().map_or_else(|| app.remembered.scene.clone(), |s| s.scene.spec.clone());
        let scenes = app.library.scenes().to_vec();
        if let Some(name) = choose(ui, "Scene", &scene, &scenes, None) {
            app.leave(Leave::Scene(name), &context);
        }
        ui.separator();
        let b = app.now.side(SideId::B).map_or(String::new(), |side| side.name.clone());
        match choose(ui, "Pipeline B", &b, &pipelines, Some("none")) {
            Some(name) if name.is_empty() => app.leave(Leave::CloseOther, &context),
            Some(name) => {
                app.leave(Leave::Pipeline(SideId::B, name, Overrides::default()), &context);
                if app.remembered.view == View::One {
                    app.remembered.view = View::Split;
                }
            }
            None => {}
        }
        if app.now.sides.len() > 1 {
            let view = app.remembered.view;
            labelled(ui, "View", |ui| {
                let list = ComboBox::from_id_salt("view").selected_text(view.name());
                let list = list.show_ui(ui, |ui| {
                    for view in View::ALL {
                        ui.selectable_value(&mut app.remembered.view, *view, view.name());
                    }
                });
                list.response
            });
        }
        ui.separator();
        animation(app, ui);
        for (action, word, what, key) in [
            (Action::Undo, "Undo", app.history.last(&app.edits()), "Ctrl-Z"),
            (Action::Redo, "Redo", app.history.next(&app.edits()), "Ctrl-Shift-Z"),
        ] {
            let button = ui.add_enabled(what.is_some(), Button::new(word));
            if button.on_hover_text(format!("{key}: {}", what.unwrap_or_default())).clicked() {
                app.act(action, &context);
            }
        }
        if ui.button("Keys").on_hover_text("F1").clicked() {
            app.act(Action::Help, &context);
        }
        if ui.button("Palette").on_hover_text("Ctrl-P").clicked() {
            app.act(Action::Palette, &context);
        }
    });
}

/// A list to choose from; returns the name of another one. `none` is what stands for an empty name.
fn choose(ui: &mut Ui, label: &str, now: &str, all: &[Named], none: Option<&str>) -> Option<String> {
    let mut chosen = None;
    let shown = if now.is_empty() { none.unwrap_or_default() } else { now };
    let width = if ui.ctx().content_rect().width() < 1000.0 { 100.0 } else { 150.0 };
    let list = ComboBox::from_id_salt(label).selected_text(shown).height(480.0).width(width).truncate();
    let name = ui.label(label);
    let list = list.show_ui(ui, |ui| {
        ui.set_min_width(260.0);
        if let Some(none) = none
            && ui.selectable_label(now.is_empty(), none).clicked()
        {
            chosen = Some(String::new());
        }
        for named in all {
            let response = ui.selectable_label(named.name == now, &named.name);
            if response.on_hover_text(super::library::about(named)).clicked() && named.name != now {
                chosen = Some(named.name.clone());
            }
        }
    });
    list.response.labelled_by(name.id);
    chosen
}

fn animation(app: &mut App, ui: &mut Ui) {
    let duration = app.now.scene.as_ref().map_or(0.0, |scene| scene.scene.duration);
    if duration <= 0.0 {
        return;
    }
    let context = ui.ctx().clone();
    // A slider does not wrap by itself.
    if ui.available_size_before_wrap().x < 290.0 {
        ui.end_row();
    }
    let word = if app.now.playing { "Stop" } else { "Play" };
    if ui.button(word).on_hover_text("P").clicked() {
        app.act(Action::Play, &context);
    }
    let before = app.time();
    let mut time = before;
    ui.spacing_mut().slider_width = 130.0;
    // Written with two decimals, but not rounded to them: while it plays that would be a change by the user.
    let slider = Slider::new(&mut time, 0.0..=duration).custom_formatter(|time, _| format!("{time:.2} s"));
    let response = labelled(ui, "Time", |ui| ui.add(slider)).on_hover_text("Time of the animation");
    if response.changed() && time != before {
        app.engine.send(Command::Play(false));
        app.go_to_time(time);
    }
    ui.add_space(egui::Spacing::default().item_spacing.x);
}
