//! Changes that would be lost are asked about.

use super::{Window, pump, window};
use crate::app::App;
use crate::engine::SideId;
use crate::leave::Leave;
use eframe::egui::{Event, Key, Modifiers, Role, ViewportCommand, ViewportEvent, ViewportId};
use egui_kittest::kittest::Queryable as _;
use frame_graph::{Overrides, Value};
use glam::Vec3;

/// Whether the interface asked in this frame for the window to be closed, or kept open.
fn asked(harness: &Window, command: &ViewportCommand) -> bool {
    harness.output().viewport_output[&ViewportId::ROOT].commands.contains(command)
}

fn pipeline(name: &str) -> Leave {
    Leave::Pipeline(SideId::A, name.to_owned(), Overrides::default())
}

fn shows(harness: &Window, name: &str) -> bool {
    harness.state().edits().settings.iter().any(|(_, shown, _)| shown == name)
}

#[test]
fn nothing_is_asked_where_nothing_is_lost() {
    let Some(mut harness) = window("ism-invtm", "plane") else { return };
    let context = harness.ctx.clone();
    // The values that the program was started with are no changes, nor is the camera, which is remembered.
    let camera = crate::camera::orbit(&harness.state().now.camera.unwrap(), 0.3, 0.0);
    let app: &mut App = harness.state_mut();
    app.pilot.take(&app.engine, camera, false);
    app.leave(Leave::Scene("cornell-box".to_owned()), &context);
    app.leave(pipeline("ism-uniform"), &context);
    assert!(app.leaving.is_none() && shows(&harness, "ism-uniform"));
    // Without the values that it was started with, the first one is as its file says.
    harness.state_mut().leave(pipeline("ism-invtm"), &context);
    assert!(harness.state().leaving.is_none() && shows(&harness, "ism-invtm"));
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Q);
    harness.step();
    assert!(harness.state().quits);
}

#[test]
fn changed_settings_are_asked_about() {
    let Some(mut harness) = window("ism-invtm", "plane") else { return };
    let context = harness.ctx.clone();
    let app: &mut App = harness.state_mut();
    app.set_value(SideId::A, "lights", Value::U32(8));
    // Another scene does not end them, another pipeline does: also before the engine has followed.
    app.leave(pipeline("ism-uniform"), &context);
    assert!(app.leaving.is_some());
    harness.run_steps(2);
    harness.get_by_label_contains("1 changed setting of ism-invtm (A): lights");
    harness.key_press(Key::Escape);
    harness.run_steps(2);
    assert!(harness.state().leaving.is_none() && shows(&harness, "ism-invtm"));
    pump(&mut harness, |app| {
        app.now.settings.first().is_some_and(|(.., o)| o.0.contains(&("lights".to_owned(), Value::U32(8))))
    });
    // The close button of the window and Ctrl-Q are the same.
    let input = harness.input_mut();
    input.viewports.get_mut(&ViewportId::ROOT).unwrap().events.push(ViewportEvent::Close);
    harness.step();
    assert!(asked(&harness, &ViewportCommand::CancelClose) && harness.state().leaving.is_some());
    harness.input_mut().viewports.get_mut(&ViewportId::ROOT).unwrap().events.clear();
    harness.key_press(Key::Escape);
    harness.run_steps(2);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Q);
    harness.run_steps(2);
    assert!(!harness.state().quits);
    harness.get_by_label("Quit without saving").click();
    harness.run_steps(2);
    assert!(harness.state().quits);
}

/// What both sides have is not lost with one of them.
#[test]
fn a_copy_of_what_is_closed_is_enough() {
    let Some(mut harness) = window("ism-invtm", "plane") else { return };
    let context = harness.ctx.clone();
    let app: &mut App = harness.state_mut();
    app.set_value(SideId::A, "lights", Value::U32(8));
    let overrides = app.edits().settings[0].2.clone();
    app.open_pipeline(SideId::B, "ism-invtm", overrides);
    assert!(app.unsaved_settings(&[SideId::A]).is_empty() && app.unsaved_settings(&[SideId::B]).is_empty());
    assert_eq!(app.unsaved_settings(&[SideId::A, SideId::B]).len(), 1);
    app.set_value(SideId::B, "lights", Value::U32(4));
    app.leave(Leave::CloseOther, &context);
    assert!(app.leaving.is_some());
}

/// Saving goes on with what was asked for, and asks for what else is not saved.
#[test]
fn what_is_saved_is_not_asked_about_again() {
    let folder = tempfile::tempdir().unwrap();
    let Some(mut harness) = window("ism-invtm", "plane") else { return };
    let context = harness.ctx.clone();
    pump(&mut harness, |app| !app.now.lights.is_empty());
    let app: &mut App = harness.state_mut();
    app.set_value(SideId::A, "lights", Value::U32(8));
    let mut lights = app.now.lights.clone();
    lights[0].position += Vec3::Y;
    app.pilot.set_lights(&app.engine, lights);
    pump(&mut harness, |app| {
        app.now
            .side(SideId::A)
            .is_some_and(|side| side.overrides.0.contains(&("lights".to_owned(), Value::U32(8))))
    });
    harness.state_mut().leave(Leave::Quit, &context);
    harness.run_steps(2);
    let save_as = |harness: &mut Window, file: &str| {
        harness.get_by_label("Save…").click();
        harness.run_steps(4);
        harness.get_by_role_and_label(Role::TextInput, "File").focus();
        harness.run_steps(1);
        harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
        harness.event(Event::Text(folder.path().join(file).display().to_string()));
        harness.run_steps(1);
        harness.get_by_label("Save").click();
        harness.run_steps(4);
    };
    save_as(&mut harness, "variant.ron");
    assert!(folder.path().join("variant.ron").is_file());
    harness.get_by_label_contains("1 changed light");
    assert!(!harness.state().quits);
    save_as(&mut harness, "scene.ron");
    assert!(folder.path().join("scene.ron").is_file() && harness.state().quits);
}
