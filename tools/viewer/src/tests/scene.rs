//! Lights and cameras of the scene.

use super::{pump, window};
use crate::action::{Action, Tab};
use crate::app::App;
use eframe::egui::Role;
use egui_kittest::kittest::Queryable as _;
use scene::LightKind;

#[test]
fn lights_are_added_removed_and_changed_in_kind() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("own.ron");
    let text = "Scene(geometry: BuiltIn(\"plane\"), lights: [Point(name: \"lamp\", intensity: (9, 9, 9), position: (0, 2, 0))])";
    std::fs::write(&file, text).unwrap();
    let Some(mut harness) = window("ism-invtm", &file.display().to_string()) else { return };
    harness.state_mut().remembered.tab = Tab::Scene;
    pump(&mut harness, |app| app.now.lights.len() == 1);
    harness.run_steps(4);
    harness.get_by_label("Add a light").click();
    pump(&mut harness, |app| app.now.lights.len() == 2);
    harness.get_by_role_and_label(Role::ComboBox, "lamp").click();
    harness.run_steps(4);
    harness.get_by_label("directional").click();
    pump(&mut harness, |app| app.now.lights[0].kind == LightKind::Directional);
    // What is written is what is shown.
    harness.run_steps(2);
    let app: &mut App = harness.state_mut();
    let edit = app.scene_panel.edit(app);
    assert_eq!((edit.lights.len(), edit.added.len(), edit.removed.len()), (1, 1, 0));
    scene::save(&file, &edit).unwrap();
    let saved = std::fs::read_to_string(&file).unwrap();
    assert!(
        saved.contains("Directional(name: \"lamp\"") && saved.contains("Point(name: \"new light 1\""),
        "{saved}"
    );
    harness.get_all_by_label("Remove").next().unwrap().click();
    pump(&mut harness, |app| app.now.lights.len() == 1 && app.now.lights[0].name == "new light 1");
    let app: &mut App = harness.state_mut();
    app.undo();
    pump(&mut harness, |app| app.now.lights.len() == 2);
}

#[test]
fn bookmarks_keep_cameras() {
    let Some(mut harness) = window("ism-invtm", "plane") else { return };
    let context = harness.ctx.clone();
    pump(&mut harness, |app| app.now.camera.is_some());
    let first = harness.state().now.camera.unwrap();
    let aside = crate::camera::orbit(&first, 0.7, 0.0);
    let app: &mut App = harness.state_mut();
    app.act(Action::Bookmark, &context);
    app.pilot.take(&app.engine, aside, false);
    app.act(Action::Bookmark, &context);
    app.remembered.tab = Tab::Scene;
    let names: Vec<_> = app.bookmarks().map(|bookmark| bookmark.name.clone()).collect();
    assert_eq!(names, ["view 1", "view 2"]);
    pump(&mut harness, |app| app.now.camera == Some(aside));
    harness.run_steps(4);
    // The second is where the camera is.
    harness.get_all_by_label("Go").next().unwrap().click();
    pump(&mut harness, |app| app.now.camera == Some(first));
    harness.state_mut().go_to_bookmark("view 2");
    pump(&mut harness, |app| app.now.camera == Some(aside));
    // They come back at the next start, and only in their scene.
    let text = serde_json::to_string(&harness.state().remembered).unwrap();
    let read: crate::remembered::Remembered = serde_json::from_str(&text).unwrap();
    assert_eq!(read.bookmarks, harness.state().remembered.bookmarks);
    harness.state_mut().open_scene("cornell-box");
    pump(&mut harness, |app| app.now.scene.as_ref().is_some_and(|view| view.scene.name == "cornell-box"));
    assert_eq!(harness.state().bookmarks().count(), 0);
}
