//! Undo and redo.

use super::{Window, pump, window};
use crate::app::App;
use crate::engine::SideId;
use eframe::egui::{Key, Modifiers, Role};
use egui_kittest::kittest::Queryable as _;
use frame_graph::Value;
use glam::Vec3;
use std::time::{Duration, Instant};

fn lights(app: &App) -> Option<Value> {
    let side = app.now.side(SideId::A)?;
    let own = side.settable.iter().find(|settable| settable.path == "lights")?;
    Some(own.value.clone())
}

/// Makes a step of what was changed, without the time that would otherwise join it with what follows.
fn step(app: &mut App) {
    let (edits, now) = (app.edits(), Instant::now());
    app.history.observe(&edits, false, now);
    app.history.observe(&edits, false, now + Duration::from_secs(1));
}

fn undo(harness: &mut Window) {
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run_steps(2);
}

#[test]
fn settings_lights_and_camera_go_back_and_forward() {
    let Some(mut harness) = window("ism-invtm", "plane") else { return };
    pump(&mut harness, |app| !app.now.lights.is_empty() && app.now.camera.is_some());
    let (own, camera) = (harness.state().now.lights.clone(), harness.state().now.camera.unwrap());
    harness.state_mut().set_value(SideId::A, "lights", Value::U32(8));
    // What follows is another step: the first is recorded.
    pump(&mut harness, |app| lights(app) == Some(Value::U32(8)));
    step(harness.state_mut());
    let mut moved = own.clone();
    moved[0].position += Vec3::Y;
    let app: &mut App = harness.state_mut();
    app.pilot.set_lights(&app.engine, moved.clone());
    step(app);
    let aside = crate::camera::orbit(&camera, 0.4, 0.0);
    app.pilot.take(&app.engine, aside, false);
    step(app);
    pump(&mut harness, |app| app.now.camera == Some(aside) && app.now.lights == moved);

    undo(&mut harness);
    pump(&mut harness, |app| app.now.camera == Some(camera) && app.now.lights == moved);
    assert_eq!(harness.state().pilot.camera(), None, "it is the scene's own again");
    undo(&mut harness);
    pump(&mut harness, |app| app.now.lights == own);
    undo(&mut harness);
    pump(&mut harness, |app| lights(app) == Some(Value::U32(16)));
    // There is nothing before the values that the program was started with.
    undo(&mut harness);
    harness.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    harness.run_steps(2);
    pump(&mut harness, |app| lights(app) == Some(Value::U32(8)));
    // By the mouse.
    harness.get_by_role_and_label(Role::Button, "Redo").click();
    pump(&mut harness, |app| app.now.lights == moved);
    harness.get_by_role_and_label(Role::Button, "Undo").click();
    pump(&mut harness, |app| app.now.lights == own);
}

/// A field takes the keys of its own text.
#[test]
fn a_text_that_is_edited_keeps_its_own_undo() {
    let Some(mut harness) = window("ism-invtm", "plane") else { return };
    let app: &mut App = harness.state_mut();
    app.set_value(SideId::A, "lights", Value::U32(8));
    step(app);
    pump(&mut harness, |app| lights(app) == Some(Value::U32(8)));
    harness.get_by_role(Role::TextInput).focus();
    harness.run_steps(2);
    undo(&mut harness);
    assert!(harness.state().edits().settings[0].2.0.contains(&("lights".to_owned(), Value::U32(8))));
}
