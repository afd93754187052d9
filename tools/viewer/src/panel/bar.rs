//! The bar at the top: what is rendered by what, and the animation.

use crate::action::{Action, View};
use crate::app::App;
use crate::engine::{Command, SideId};
use crate::files::{Kind, listed};
use crate::leave::Leave;
use crate::panel::labelled;
use crate::panel::open::What;
use eframe::egui::{self, Button, ComboBox, Slider, Ui};
use renderer::Named;

pub(crate) fn show(app: &mut App, ui: &mut Ui) {
    let context = ui.ctx().clone();
    ui.horizontal_wrapped(|ui| {
        let a =
            app.now.side(SideId::A).map_or_else(|| app.remembered.pipeline.clone(), |side| side.name.clone());
        let pipelines = app.library.pipelines().to_vec();
        let of_files = Lists {
            recent: listed(&app.remembered.recent_pipelines),
            beside: app.beside.of(Kind::Pipeline),
            built_in: &pipelines,
        };
        match choose(ui, "Pipeline A", &a, &of_files, None) {
            Some(Chosen::File) => app.choose_file(What::Pipeline(SideId::A)),
            Some(Chosen::Name(name)) => app.open(What::Pipeline(SideId::A), name, &context),
            None => {}
        }
        let scene =
            app.now.scene.as_ref().map_or_else(|| app.remembered.scene.clone(), |s| s.scene.spec.clone());
        let scenes = app.library.scenes().to_vec();
        let lists = Lists {
            recent: listed(&app.remembered.recent_scenes),
            beside: app.beside.of(Kind::Scene),
            built_in: &scenes,
        };
        match choose(ui, "Scene", &scene, &lists, None) {
            Some(Chosen::File) => app.choose_file(What::Scene),
            Some(Chosen::Name(name)) => app.open(What::Scene, name, &context),
            None => {}
        }
        ui.separator();
        let b = app.now.side(SideId::B).map_or(String::new(), |side| side.name.clone());
        match choose(ui, "Pipeline B", &b, &of_files, Some("none")) {
            Some(Chosen::File) => app.choose_file(What::Pipeline(SideId::B)),
            Some(Chosen::Name(name)) if name.is_empty() => app.leave(Leave::CloseOther, &context),
            Some(Chosen::Name(name)) => app.open(What::Pipeline(SideId::B), name, &context),
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

/// The names in a list.
struct Lists<'a> {
    /// Files that were opened lately.
    recent: Vec<String>,
    /// Files of the working folder.
    beside: Vec<String>,
    /// What is built in.
    built_in: &'a [Named],
}

/// What was chosen in a list.
enum Chosen {
    /// A name; empty for none.
    Name(String),
    /// A file that is to be asked for.
    File,
}

/// A list to choose from; returns what is chosen if that is another than now. `none` is what stands for an empty name.
fn choose(ui: &mut Ui, label: &str, now: &str, lists: &Lists<'_>, none: Option<&str>) -> Option<Chosen> {
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
            chosen = Some(Chosen::Name(String::new()));
        }
        if ui.selectable_label(false, "Open a file…").clicked() {
            chosen = Some(Chosen::File);
        }
        let mut files = |ui: &mut Ui, head: &str, names: &[String]| {
            if !names.is_empty() {
                ui.weak(head);
            }
            for name in names {
                if ui.selectable_label(name == now, name).clicked() && name != now {
                    chosen = Some(Chosen::Name(name.clone()));
                }
            }
        };
        files(ui, "Opened lately", &lists.recent);
        let others: Vec<String> =
            lists.beside.iter().filter(|name| !lists.recent.contains(name)).cloned().collect();
        files(ui, "In this folder", &others);
        ui.weak("Built in");
        for named in lists.built_in {
            let response = ui.selectable_label(named.name == now, &named.name);
            if response.on_hover_text(super::library::about(named)).clicked() && named.name != now {
                chosen = Some(Chosen::Name(named.name.clone()));
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
