//! Files that are opened and written.

use super::{pump, window};
use crate::action::{Action, Tab};
use crate::app::App;
use crate::engine::{Command, Job, SideId};
use crate::panel::open::{Opening, What};
use egui_kittest::kittest::Queryable as _;
use metrics::Image;

#[test]
fn a_file_is_opened_from_the_list_of_its_folder() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("mine")).unwrap();
    let file = folder.path().join("mine/own.ron");
    std::fs::write(&file, "Pipeline(extends: \"ism-uniform.ron\", about: \"Own\")").unwrap();
    std::fs::write(folder.path().join("mine/room.ron"), "Scene(geometry: BuiltIn(\"plane\"))").unwrap();
    let Some(mut harness) = window("ism-invtm", "plane") else { return };
    let context = harness.ctx.clone();
    harness.state_mut().act(Action::OpenPipeline, &context);
    assert!(harness.state().opening.is_some());
    harness.state_mut().opening = Some(Opening::new(What::Pipeline(SideId::A), folder.path()));
    harness.run_steps(4);
    harness.get_by_label("mine/").click();
    harness.run_steps(4);
    assert!(harness.query_by_label("room.ron").is_none(), "a scene is no pipeline");
    harness.get_by_label("own.ron").click();
    let name = file.canonicalize().unwrap().display().to_string();
    pump(&mut harness, |app| app.now.side(SideId::A).is_some_and(|side| side.name == name));
    // It is in the list from now on, and at the next start.
    assert_eq!(harness.state().remembered.recent_pipelines, [name]);
    assert!(harness.state().opening.is_none());
}

#[test]
fn pictures_are_written_in_the_size_that_is_set() {
    let folder = tempfile::tempdir().unwrap();
    let Some(mut harness) = window("ism-2008", "plane") else { return };
    harness.state_mut().remembered.tab = Tab::Write;
    harness.run_steps(4);
    harness.get_by_label_contains("As it is shown").click();
    harness.run_steps(4);
    harness.get_by_label_contains("F12 takes it too");
    pump(&mut harness, |app| app.now.side(SideId::A).is_some_and(|side| side.idle));
    // An output, and a resource that nothing keeps.
    for (output, name) in [("image", "a.exr"), ("gather", "b.exr")] {
        let path = folder.path().join(name);
        let size = Some((50, 34));
        let job =
            Job::Picture { side: SideId::A, output: output.to_owned(), layer: 0, path: path.clone(), size };
        harness.state().engine.send(Command::Job(job));
        pump(&mut harness, |app| {
            app.now
                .messages
                .iter()
                .any(|message| message.text.contains(name) && message.text.contains("50×34"))
        });
        let image = Image::read(&path).unwrap();
        assert_eq!((image.width(), image.height()), (50, 34));
    }
    // What is shown has its own size again: that which the window asked for last, as its panels may have moved meanwhile.
    let back = |app: &App| {
        app.now.side(SideId::A).is_some_and(|side| side.plan.frame == app.frame_size.sent && side.idle)
    };
    pump(&mut harness, back);
}
