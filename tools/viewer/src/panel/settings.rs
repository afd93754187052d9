//! Settings as controls, made from their one declaration.

use crate::action::Action;
use crate::app::App;
use crate::engine::SideId;
use eframe::egui::{
    self, Align, Checkbox, CollapsingHeader, ComboBox, DragValue, Label, Layout, Response, RichText,
    ScrollArea, Slider, SliderClamping, TextEdit, Ui, vec2,
};
use frame_graph::resolve::Settable;
use frame_graph::{Overrides, Setting, Value, ValueType};
use std::collections::HashMap;
use std::time::{Duration, Instant};

/// The time for which a control shows the user's value before it shows that of the engine.
const PATIENCE: Duration = Duration::from_secs(2);

/// A range whose ends are this many times apart is shown on a logarithmic scale.
const DECADES: f64 = 500.0;

/// Values that the user has typed or dragged and the engine has not taken yet.
#[derive(Default)]
pub(crate) struct Controls {
    given: HashMap<(SideId, String), (Value, Instant)>,
    filter: String,
    side: Option<SideId>,
}

impl Controls {
    /// Forgets what belongs to another pipeline.
    pub(crate) fn forget(&mut self, side: SideId) {
        self.given.retain(|(of, _), _| *of != side);
    }

    /// The value that a control shows.
    fn shown(&mut self, side: SideId, settable: &Settable) -> Value {
        let key = (side, settable.path.clone());
        match self.given.get(&key) {
            Some((given, since)) if *given != settable.value && since.elapsed() < PATIENCE => given.clone(),
            Some(_) => {
                self.given.remove(&key);
                settable.value.clone()
            }
            None => settable.value.clone(),
        }
    }
}

pub(crate) fn show(app: &mut App, ui: &mut Ui) {
    let sides: Vec<SideId> = app.now.sides.iter().map(|(id, _)| *id).collect();
    let mut side = app.controls.side.filter(|side| sides.contains(side)).unwrap_or(SideId::A);
    if sides.len() > 1 {
        ui.horizontal_wrapped(|ui| {
            for id in &sides {
                ui.selectable_value(&mut side, *id, format!("Settings of {}", id.name()));
            }
        });
    }
    app.controls.side = Some(side);
    let Some(shown) = app.now.side(side).cloned() else {
        ui.label("No pipeline is loaded.");
        return;
    };
    ui.strong(&shown.name);
    ui.label(&shown.about);
    let context = ui.ctx().clone();
    ui.horizontal(|ui| {
        let changed = shown.overrides.0.len();
        let save = egui::Button::new("Save as variant");
        if ui.add_enabled(changed > 0, save).on_hover_text("Ctrl-S").clicked() {
            app.act(Action::SaveVariant, &context);
        }
        let reset = egui::Button::new(format!("Reset {changed} changed"));
        if ui.add_enabled(changed > 0, reset).clicked() {
            app.controls.forget(side);
            for (path, _) in &shown.overrides.0 {
                app.reset_value(side, path);
            }
        }
    });
    ui.add(
        TextEdit::singleline(&mut app.controls.filter)
            .hint_text("Filter by name or text")
            .desired_width(f32::INFINITY),
    );
    ui.separator();
    let filter = app.controls.filter.to_lowercase();
    let wanted = |settable: &&Settable| {
        let about = |text: &str| text.to_lowercase().contains(&filter);
        filter.is_empty() || about(&settable.path) || about(&settable.setting.doc)
    };
    let found: Vec<&Settable> = shown.settable.iter().filter(wanted).collect();
    ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        let overrides = &shown.overrides;
        let own = found.iter().filter(|settable| !settable.path.contains('.'));
        for settable in own {
            control(app, ui, side, settable, overrides);
        }
        let mut groups: Vec<(&str, Vec<&Settable>)> = Vec::new();
        for settable in found.iter().filter(|settable| settable.path.contains('.')) {
            let group = settable.path.rsplit_once('.').map_or("", |(group, _)| group);
            match groups.iter_mut().find(|(known, _)| *known == group) {
                Some((_, members)) => members.push(settable),
                None => groups.push((group, vec![settable])),
            }
        }
        for (group, members) in groups {
            let changed = members.iter().any(|member| is_changed(overrides, &member.path));
            let kind = shown.plan.passes.iter().find(|pass| *pass.name == *group);
            let head = RichText::new(group);
            let head = if changed { head.strong() } else { head };
            // What a filter opens is closed again without it.
            let folded = CollapsingHeader::new(head).id_salt((side, group, filter.is_empty()));
            let open = if filter.is_empty() { None } else { Some(true) };
            let response = folded.open(open).show(ui, |ui| {
                for member in members {
                    control(app, ui, side, member, overrides);
                }
            });
            if let Some(pass) = kind {
                response.header_response.on_hover_text(format!("pass type `{}`", pass.kind));
            }
        }
    });
}

fn is_changed(overrides: &Overrides, path: &str) -> bool {
    overrides.0.iter().any(|(known, _)| known == path)
}

/// One setting: its control, and a way back where it was changed.
fn control(app: &mut App, ui: &mut Ui, side: SideId, settable: &Settable, overrides: &Overrides) {
    let setting = &settable.setting;
    let changed = is_changed(overrides, &settable.path);
    let mut value = app.controls.shown(side, settable);
    let before = value.clone();
    let layout = Layout::left_to_right(Align::Center);
    // Vectors alone are as wide as that.
    let layout = layout.with_main_wrap(matches!(value, Value::Vector(_)));
    let size = vec2(ui.available_width(), ui.spacing().interact_size.y);
    ui.allocate_ui_with_layout(size, layout, |ui| {
        ui.push_id((side, &settable.path), |ui| {
            edit(ui, &settable.path, setting, &mut value, changed);
            // Behind the control, which must not move under the mouse.
            let about = format!("{}: back to what the file says", settable.path);
            if changed && ui.small_button("reset").on_hover_text(about).clicked() {
                app.controls.given.remove(&(side, settable.path.clone()));
                app.reset_value(side, &settable.path);
                value.clone_from(&before);
            }
        });
    });
    if value != before {
        app.controls.given.insert((side, settable.path.clone()), (value.clone(), Instant::now()));
        app.set_value(side, &settable.path, value);
    }
}

/// Returns the description of a setting, with its range and default, for a tooltip.
fn about(path: &str, setting: &Setting) -> String {
    let mut text = format!("{path}\n{}", setting.doc);
    let bound = |bound: Option<f64>| bound.map_or("…".to_owned(), |bound| bound.to_string());
    if setting.min.is_some() || setting.max.is_some() {
        text += &format!("\n{} to {} {}", bound(setting.min), bound(setting.max), setting.unit);
    }
    text + &format!("\nDefault of the pass: {}", setting.default)
}

/// The control of a setting behind its name, by its type, range and choices.
fn edit(ui: &mut Ui, path: &str, setting: &Setting, value: &mut Value, changed: bool) {
    let name = path.rsplit('.').next().unwrap_or(path);
    let suffix = if setting.unit.is_empty() { String::new() } else { format!(" {}", setting.unit) };
    let hint = about(path, setting);
    let label = column(ui, name).on_hover_text(&hint);
    // The rest is for the number and the way back.
    let rest = if changed { 125.0 } else { 75.0 };
    ui.spacing_mut().slider_width = (ui.available_width() - rest).clamp(20.0, 220.0);
    let range = (setting.min.unwrap_or(f64::NEG_INFINITY), setting.max.unwrap_or(f64::INFINITY));
    let response = match value {
        _ if !setting.one_of.is_empty() => {
            let list = ComboBox::from_id_salt(path).selected_text(value.to_argument());
            let list = list.width((ui.available_width() - 55.0).clamp(40.0, 140.0)).truncate();
            let list = list.show_ui(ui, |ui| {
                for choice in &setting.one_of {
                    ui.selectable_value(value, choice.clone(), choice.to_argument());
                }
            });
            list.response
        }
        Value::Bool(truth) => ui.add(Checkbox::without_text(truth)),
        Value::U32(number) => {
            let mut wide = f64::from(*number);
            let response = drag(ui, &suffix, &mut wide, (range.0.max(0.0), range.1), true);
            if response.changed() {
                *number = wide.round().clamp(0.0, f64::from(u32::MAX)) as u32;
            }
            response
        }
        Value::I32(number) => {
            let mut wide = f64::from(*number);
            let response = drag(ui, &suffix, &mut wide, range, true);
            if response.changed() {
                *number = wide.round().clamp(f64::from(i32::MIN), f64::from(i32::MAX)) as i32;
            }
            response
        }
        Value::F32(number) => {
            let mut wide = f64::from(*number);
            let response = drag(ui, &suffix, &mut wide, range, false);
            if response.changed() {
                *number = wide as f32;
            }
            response
        }
        Value::Vector(numbers) => {
            let axes = numbers.iter_mut().zip(["x", "y", "z", "w"]);
            let drags = axes.map(|(number, axis)| {
                let drag = DragValue::new(number).speed(0.01).prefix(format!("{axis} ")).suffix(&suffix);
                ui.add(drag).labelled_by(label.id)
            });
            match drags.reduce(|all, one| all | one) {
                Some(response) => response,
                None => return,
            }
        }
        Value::Text(text) => {
            ui.add(TextEdit::singleline(text).desired_width((ui.available_width() - 60.0).clamp(40.0, 160.0)))
        }
    };
    response.labelled_by(label.id).on_hover_text(hint);
    debug_assert!(matches!(setting.ty, ValueType::Vector(_)) || value.ty() == setting.ty, "{path}");
}

/// A name in a column of its own, so that controls begin below each other. A name that is too long is cut.
fn column(ui: &mut Ui, name: &str) -> Response {
    let size = vec2((ui.max_rect().width() * 0.38).clamp(60.0, 150.0), ui.spacing().interact_size.y);
    let layout = Layout::left_to_right(Align::Center);
    let column = ui.allocate_ui_with_layout(size, layout, |ui| {
        ui.set_min_width(size.x);
        ui.add(Label::new(name).truncate())
    });
    column.inner
}

/// A number: a slider where the range has two ends, else a field to drag.
fn drag(ui: &mut Ui, suffix: &str, number: &mut f64, (min, max): (f64, f64), whole: bool) -> Response {
    if min.is_finite() && max.is_finite() {
        let least = if min > 0.0 { min } else { max * 1e-4 };
        let slider = Slider::new(number, min..=max)
            .suffix(suffix)
            .logarithmic(min >= 0.0 && max / least >= DECADES)
            .smallest_positive(if whole { 1.0 } else { least })
            .clamping(SliderClamping::Always);
        ui.add(if whole { slider.integer() } else { slider.max_decimals(5) })
    } else {
        let speed = if whole { 0.2 } else { (number.abs() * 0.01).max(1e-3) };
        let field = DragValue::new(number).range(min..=max).speed(speed).suffix(suffix);
        ui.add(if whole { field.max_decimals(0) } else { field.max_decimals(6) })
    }
}
