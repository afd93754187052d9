//! The interface by its accessibility tree: what is there has a name, and can be reached by the keyboard.

mod files;
mod graph;
mod history;
mod layout;
mod leave;
mod look;
mod scene;
mod times;

use crate::action::{Action, Tab, View};
use crate::app::App;
use crate::engine::{Command, SideId, Start};
use crate::remembered::Remembered;
use eframe::egui::accessibility::is_input;
use eframe::egui::{Key, Modifiers, Role, Ui, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use frame_graph::{Overrides, Value};
use renderer::{Assets, Catalog, Gpu};
use std::collections::BTreeSet;
use std::ops::{Deref, DerefMut};
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Few lights in small maps, so that a frame takes little time on a processor.
fn few() -> Overrides {
    let values = [("lights", 16), ("map", 16), ("rsm.size", 32), ("interleave_x", 1), ("interleave_y", 1)];
    Overrides(values.map(|(path, value)| (path.to_owned(), Value::U32(value))).to_vec())
}

/// The application, created in the first frame of the interface.
struct Lazy {
    start: Option<(Start, Remembered)>,
    app: Option<App>,
}

impl Lazy {
    fn show(&mut self, ui: &mut Ui) {
        let created = self.start.take().map(|(start, remembered)| App::new(ui.ctx(), start, remembered));
        self.app = self.app.take().or(created);
        self.deref_mut().show(ui);
    }
}

impl Deref for Lazy {
    type Target = App;

    fn deref(&self) -> &App {
        self.app.as_ref().expect("there was a frame")
    }
}

impl DerefMut for Lazy {
    fn deref_mut(&mut self) -> &mut App {
        self.app.as_mut().expect("there was a frame")
    }
}

type Window = Harness<'static, Lazy>;

/// Opens the window with a pipeline and scene, and waits for a picture; `None` where there is no adapter.
fn window(pipeline: &str, scene: &str) -> Option<Window> {
    let mut harness = opened(pipeline, scene)?;
    pump(&mut harness, shows_a_picture);
    Some(harness)
}

/// Opens the window; `None` where there is no adapter.
fn opened(pipeline: &str, scene: &str) -> Option<Window> {
    remembering(pipeline, scene, Remembered { resolution: 0.125, ..Remembered::default() })
}

/// Opens the window with what it remembers; `None` where there is no adapter.
fn remembering(pipeline: &str, scene: &str, remembered: Remembered) -> Option<Window> {
    if Gpu::adapters().is_empty() {
        eprintln!("skipped: no graphics adapter");
        return None;
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let start = Start {
        catalog: Arc::new(Catalog::new(Assets::new(Some(root)))),
        pipeline: pipeline.to_owned(),
        scene: scene.to_owned(),
        overrides: few(),
        size: (64, 48),
        seed: 0,
    };
    let lazy = Lazy { start: Some((start, remembered)), app: None };
    let builder = Harness::builder().with_size([1500.0, 1000.0]).with_step_dt(1.0 / 30.0);
    Some(builder.build_ui_state(|ui, lazy: &mut Lazy| lazy.show(ui), lazy))
}

fn shows_a_picture(app: &App) -> bool {
    app.now.side(SideId::A).is_some_and(|side| side.picture.is_some())
}

/// Longer than anything takes on a busy machine.
const PATIENCE: Duration = Duration::from_secs(600);

/// Draws until something holds; panics after [`PATIENCE`].
fn pump(harness: &mut Window, holds: impl Fn(&App) -> bool) {
    let begun = Instant::now();
    while !holds(harness.state()) {
        assert!(begun.elapsed() < PATIENCE, "waited for too long: {:?}", harness.state().now.troubles);
        harness.step();
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// The names of all controls that can be used.
fn controls(harness: &Window) -> BTreeSet<String> {
    let nodes = harness.root().children_recursive().collect::<Vec<_>>();
    let nodes = nodes.iter().map(|node| node.accesskit_node());
    let inputs = nodes.filter(|node| is_input(node.role()) && !node.is_hidden() && !node.is_disabled());
    inputs.map(|node| format!("{:?} {}", node.role(), node.label().unwrap_or_default())).collect()
}

fn focused(harness: &Window) -> Option<String> {
    let node = harness.root().children_recursive().find(|node| node.accesskit_node().is_focused())?;
    let node = node.accesskit_node();
    Some(format!("{:?} {}", node.role(), node.label().unwrap_or_default()))
}

#[test]
fn every_control_has_a_name_and_is_reached_by_the_keyboard() {
    let Some(mut harness) = window("ism-invtm", "cornell-box-moving") else { return };
    let app = harness.state_mut();
    app.open_pipeline(SideId::B, "ism-uniform", Overrides::default());
    app.remembered.view = View::Split;
    app.engine.send(Command::Value(SideId::B, "lights".to_owned(), Value::U32(16)));
    pump(&mut harness, |app| app.now.side(SideId::B).is_some_and(|side| side.picture.is_some()));
    for tab in Tab::ALL {
        harness.state_mut().remembered.tab = *tab;
        harness.run_steps(4);
        assert_eq!(harness.unnamed_widgets(), Vec::<String>::new(), "{}", tab.name());
        let wanted = controls(&harness);
        assert!(wanted.len() > 15, "{}: {wanted:?}", tab.name());
        let mut reached = BTreeSet::new();
        for _ in 0..wanted.len() * 2 + 20 {
            harness.key_press(Key::Tab);
            harness.step();
            reached.extend(focused(&harness));
        }
        let missed: Vec<_> = wanted.difference(&reached).collect();
        assert!(missed.is_empty(), "{}: not reached by Tab: {missed:?}", tab.name());
    }
}

#[test]
fn the_palette_opens_pipelines_scenes_and_commands_by_the_keyboard() {
    let Some(mut harness) = window("ism-invtm", "cornell-box") else { return };
    pump(&mut harness, |app| !app.library.pipelines().is_empty());
    let by_palette = |harness: &mut Window, text: &str| {
        harness.key_press_modifiers(Modifiers::COMMAND, Key::P);
        harness.run_steps(2);
        assert!(harness.state().palette.is_some(), "the palette is open");
        harness.event(eframe::egui::Event::Text(text.to_owned()));
        harness.run_steps(2);
        harness.key_press(Key::Enter);
        harness.run_steps(2);
        assert!(harness.state().palette.is_none(), "{text} was chosen");
    };
    by_palette(&mut harness, "ism-uniform");
    pump(&mut harness, |app| app.now.side(SideId::A).is_some_and(|side| side.name == "ism-uniform"));
    by_palette(&mut harness, "scene plane");
    pump(&mut harness, |app| app.now.scene.as_ref().is_some_and(|view| view.scene.name == "plane"));
    by_palette(&mut harness, "show or hide the keys");
    assert!(harness.state().help);
}

/// The window has its least size.
#[test]
fn the_palette_fits_into_a_small_window() {
    let Some(mut harness) = opened("ism-invtm", "plane") else { return };
    harness.set_size(vec2(480.0, 320.0));
    pump(&mut harness, |app| !app.library.pipelines().is_empty());
    harness.key_press_modifiers(Modifiers::COMMAND, Key::P);
    harness.run_steps(4);
    let (window, field) =
        (harness.ctx.content_rect(), harness.get_by_role_and_label(Role::TextInput, "Palette").rect());
    assert!(window.contains_rect(field), "{field} of {window}");
}

#[test]
fn what_is_remembered_survives_a_restart() {
    let remembered = Remembered {
        pipeline: "tcas".to_owned(),
        scene: "atrium".to_owned(),
        view: View::Flip,
        split: 0.3,
        dark: Some(false),
        ..Remembered::default()
    };
    let text = serde_json::to_string(&remembered).unwrap();
    let read: Remembered = serde_json::from_str(&text).unwrap();
    assert_eq!(serde_json::to_string(&read).unwrap(), text);
    // What another version has stored is taken as far as it is known.
    let older: Remembered = serde_json::from_str(r#"{ "pipeline": "ism", "forgotten": 1 }"#).unwrap();
    assert_eq!((older.pipeline.as_str(), older.scene.as_str()), ("ism", "cornell-box"));
}

#[test]
fn values_go_to_the_engine_and_back_to_what_the_file_says() {
    let Some(mut harness) = window("ism-invtm", "cornell-box") else { return };
    let lights = |app: &App| {
        let side = app.now.side(SideId::A).unwrap();
        side.settable.iter().find(|settable| settable.path == "lights").unwrap().value.clone()
    };
    assert_eq!(lights(harness.state()), Value::U32(16));
    let version = harness.state().now.side(SideId::A).unwrap().version;
    harness.state().engine.send(Command::Value(SideId::A, "lights".to_owned(), Value::U32(8)));
    pump(&mut harness, |app| {
        lights(app) == Value::U32(8) && app.now.side(SideId::A).unwrap().version > version
    });
    harness.state().engine.send(Command::Reset(SideId::A, "lights".to_owned()));
    pump(&mut harness, |app| lights(app) == Value::U32(1024));
    // A value that is refused is reported, and the one before stays.
    harness.state().engine.send(Command::Value(SideId::A, "lights".to_owned(), Value::Bool(true)));
    pump(&mut harness, |app| !app.now.troubles.is_empty());
    assert_eq!(lights(harness.state()), Value::U32(1024));
    harness.state().engine.send(Command::Value(SideId::A, "lights".to_owned(), Value::U32(4)));
    pump(&mut harness, |app| app.now.troubles.is_empty() && lights(app) == Value::U32(4));
}

#[test]
fn a_still_scene_is_idle_and_a_reference_converges_beside_it() {
    let Some(mut harness) = window("ism-invtm", "plane") else { return };
    pump(&mut harness, |app| app.now.side(SideId::A).is_some_and(|side| side.idle));
    let context = harness.ctx.clone();
    harness.state_mut().act(Action::Reference, &context);
    let step = |app: &App| {
        let side = app.now.side(SideId::Reference)?;
        Some(side.progress?.step)
    };
    // So many that it is seen when they begin again.
    pump(&mut harness, |app| step(app).is_some_and(|step| step > 200));
    pump(&mut harness, |app| app.now.measured.as_ref().is_some_and(|measured| !measured.errors.is_empty()));
    let errors = harness.state().now.measured.clone().unwrap().errors[0];
    assert!((errors.of, errors.to) == (SideId::A, SideId::Reference) && errors.flip < 0.5, "{errors:?}");
    // Movement stops it, and it begins again.
    let camera = harness.state().now.camera.unwrap();
    let moved = crate::camera::orbit(&camera, 0.2, 0.0);
    harness.state().engine.send(Command::Camera(Some(moved), false));
    pump(&mut harness, |app| app.now.camera == Some(moved) && step(app).is_some_and(|step| step < 150));
}

#[test]
fn a_scene_that_is_not_there_at_the_start_is_waited_for() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("late.ron");
    let Some(mut harness) = opened("ism-invtm", &file.display().to_string()) else { return };
    pump(&mut harness, |app| app.now.troubles.iter().any(|trouble| trouble.of == "scene"));
    std::fs::write(&file, "Scene(geometry: BuiltIn(\"plane\"), lights: [").unwrap();
    pump(&mut harness, |app| app.now.troubles.iter().any(|trouble| trouble.text.contains("late.ron:1")));
    std::fs::write(&file, "Scene(geometry: BuiltIn(\"plane\"))").unwrap();
    pump(&mut harness, |app| shows_a_picture(app) && app.now.troubles.is_empty());
    let scene = harness.state().now.scene.clone().unwrap();
    assert_eq!(scene.scene.name, "late");
}

/// Files that lie beside a pipeline and are no part of it are not said to be read: what the window writes itself, logs.
#[test]
fn only_what_takes_part_is_read_again() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    let text = |about: &str| format!("Pipeline(extends: \"ism-invtm.ron\", about: {about:?})");
    std::fs::write(file("own.ron"), text("first")).unwrap();
    let Some(mut harness) = window(&file("own.ron").display().to_string(), "plane") else { return };
    for name in ["state.ron", "a.log", "picture.png"] {
        std::fs::write(file(name), "x").unwrap();
    }
    std::fs::write(file("own.ron"), text("second")).unwrap();
    let read =
        |app: &App| app.now.messages.iter().find(|m| m.text.contains("read again")).map(|m| m.text.clone());
    pump(&mut harness, |app| read(app).is_some());
    let line = read(harness.state()).unwrap();
    assert!(line.starts_with("own.ron read again"), "{line}");
}

#[test]
fn another_scene_can_be_opened_in_place_of_one_that_is_not_there() {
    let Some(mut harness) = opened("ism-invtm", "gone") else { return };
    pump(&mut harness, |app| app.now.troubles.iter().any(|trouble| trouble.of == "scene"));
    harness.state_mut().open_pipeline(SideId::A, "ism-uniform", Overrides::default());
    harness.state_mut().open_scene("plane");
    pump(&mut harness, |app| shows_a_picture(app) && app.now.troubles.is_empty());
    assert_eq!(harness.state().now.side(SideId::A).unwrap().name, "ism-uniform");
}

#[test]
fn a_scene_that_is_not_there_leaves_the_one_before_to_work_on() {
    let Some(mut harness) = window("ism-invtm", "plane") else { return };
    harness.state_mut().open_scene("gone");
    pump(&mut harness, |app| app.now.troubles.iter().any(|trouble| trouble.of == "scene"));
    harness.state_mut().open_pipeline(SideId::A, "ism-uniform", Overrides::default());
    pump(&mut harness, |app| {
        app.now.side(SideId::A).is_some_and(|side| side.name == "ism-uniform" && side.frames > 0)
    });
    assert_eq!(harness.state().now.scene.as_ref().unwrap().scene.name, "plane");
}

#[test]
fn what_plays_goes_on_until_it_is_stopped() {
    let Some(mut harness) = window("ism-invtm", "cornell-box-moving") else { return };
    let context = harness.ctx.clone();
    harness.state_mut().act(Action::Play, &context);
    // Longer than a frame takes: the control of the time is drawn again and again meanwhile.
    for least in [0.2, 0.4, 0.6] {
        pump(&mut harness, |app| app.now.playing && app.now.time > least);
    }
    harness.state_mut().act(Action::Play, &context);
    pump(&mut harness, |app| !app.now.playing);
    harness.state_mut().go_to_time(1.25);
    pump(&mut harness, |app| app.now.time == 1.25);
    assert_eq!(harness.state().time(), 1.25);
}

#[test]
fn of_places_of_a_slider_only_the_last_counts() {
    let value = |path: &str, value| Command::Value(SideId::A, path.to_owned(), Value::U32(value));
    assert!(value("lights", 2).supersedes(&value("lights", 1)));
    assert!(!value("lights", 2).supersedes(&value("map", 1)));
    assert!(Command::Camera(None, false).supersedes(&Command::Camera(None, false)));
    assert!(!Command::Camera(None, false).supersedes(&Command::Camera(None, true)), "a cut is not forgotten");
    assert!(!Command::Play(true).supersedes(&Command::Play(false)));
}

/// An error in the window has the text of `check`; a click on its place opens the user's editor there.
#[cfg(unix)]
#[test]
fn a_click_on_an_error_opens_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let (pipeline, opened_at) = (folder.path().join("broken.ron"), folder.path().join("opened"));
    std::fs::write(&pipeline, "Pipeline(extends: \"ism.ron\",\n    patch: [Remove(\"filtr\")])").unwrap();
    let script = folder.path().join("editor");
    std::fs::write(
        &script,
        format!("#!/bin/sh\necho \"$1\" > {}.new\nmv {0}.new {0}\n", opened_at.display()),
    )
    .unwrap();
    std::fs::set_permissions(&script, std::os::unix::fs::PermissionsExt::from_mode(0o755)).unwrap();
    let name = pipeline.to_string_lossy().into_owned();
    let Some(mut harness) = opened(&name, "cornell-box") else { return };
    harness.step();
    harness.state_mut().editor =
        Some(crate::editor::Editor(format!("{} {{file}}:{{line}}:{{column}}", script.display())));
    pump(&mut harness, |app| !app.now.troubles.is_empty());
    let catalog = harness.state().catalog.clone();
    let checked = frame_graph::resolve(&name, catalog.pipelines(), &Overrides::default()).unwrap_err();
    assert!(harness.state().now.troubles[0].text.contains(&checked.to_string()));
    harness.run_steps(4);
    harness.get_by_label_contains("┌─ ").click();
    pump(&mut harness, |_| opened_at.exists());
    assert_eq!(std::fs::read_to_string(&opened_at).unwrap().trim(), format!("{name}:2:20"));
}

/// A key that someone types who believes to be in a field is taken as an action, and the window says which.
#[test]
fn plain_keys_are_named_as_they_are_taken() {
    let Some(mut harness) = window("ism-invtm", "plane") else { return };
    let named = |harness: &Window| harness.state().pressed.as_ref().map(|(_, line)| line.clone());
    harness.key_press_modifiers(Modifiers::COMMAND, Key::T);
    harness.key_press(Key::F2);
    harness.run_steps(2);
    assert_eq!(named(&harness), None, "these are no letters of a text");
    harness.key_press(Key::K);
    harness.run_steps(2);
    assert_eq!(named(&harness).as_deref(), Some("K: Record a key of the camera at the time shown"));
}
