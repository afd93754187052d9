//! Files to write: pictures of any resource, sequences, videos.

use crate::app::App;
use crate::engine::{Command, Job, Published, SideId};
use crate::panel::{choose_side, labelled};
use eframe::egui::{DragValue, TextEdit, Ui};
use std::path::{Path, PathBuf};

/// The state of the panel.
pub(crate) struct Writing {
    side: SideId,
    output: String,
    layer: u32,
    path: String,
    sequence: String,
    frames: u32,
}

impl Default for Writing {
    fn default() -> Writing {
        Writing {
            side: SideId::A,
            output: "image".to_owned(),
            layer: 0,
            path: "picture.exr".to_owned(),
            sequence: "frames/####.png".to_owned(),
            frames: 60,
        }
    }
}

impl Writing {
    /// The next name for a screenshot that no file has.
    pub(crate) fn next_screenshot(&self, now: &Published) -> PathBuf {
        let stem = |text: &str| {
            Path::new(text).file_stem().map_or(String::new(), |s| s.to_string_lossy().into_owned())
        };
        let pipeline = now.side(SideId::A).map_or(String::new(), |side| stem(&side.name));
        let scene = now.scene.as_ref().map_or(String::new(), |view| stem(&view.scene.name));
        let name = |n: u32| PathBuf::from(format!("{pipeline}-{scene}-{n:03}.png"));
        (1..).map(name).find(|path| !path.exists()).unwrap_or_else(|| name(0))
    }
}

/// The size of what is written, by F12 too.
fn size_field(app: &mut App, ui: &mut Ui) -> Option<(u32, u32)> {
    let shown = app.now.side(SideId::A).map_or((320, 240), |side| side.plan.frame);
    ui.strong("Size");
    let mut as_shown = app.remembered.written_size.is_none();
    if ui.checkbox(&mut as_shown, format!("As it is shown: {}×{}", shown.0, shown.1)).changed() {
        app.remembered.written_size = (!as_shown).then_some((1280, 720));
    }
    if let Some((width, height)) = &mut app.remembered.written_size {
        ui.horizontal(|ui| {
            labelled(ui, "Width", |ui| ui.add(DragValue::new(width).range(1..=8192).suffix(" px")));
            labelled(ui, "Height", |ui| ui.add(DragValue::new(height).range(1..=8192).suffix(" px")));
        });
        ui.weak("The frame is rendered again in this size. F12 takes it too.");
    }
    app.remembered.written_size
}

pub(crate) fn show(app: &mut App, ui: &mut Ui) {
    let sides: Vec<SideId> = app.now.sides.iter().map(|(id, _)| *id).collect();
    let size = size_field(app, ui);
    ui.separator();
    let writing = &mut app.writing;
    choose_side(ui, &sides, &mut writing.side);
    ui.strong("A picture");
    ui.label(
        "EXR and PFM hold linear values, PNG what a screen shows. The record of how it was made is in it.",
    );
    let field = |ui: &mut Ui, name: &str, text: &mut String| {
        ui.horizontal(|ui| {
            labelled(ui, name, |ui| ui.add(TextEdit::singleline(text).desired_width(f32::INFINITY)));
        });
    };
    field(ui, "Output or resource", &mut writing.output);
    field(ui, "File", &mut writing.path);
    ui.horizontal(|ui| {
        labelled(ui, "Layer", |ui| ui.add(DragValue::new(&mut writing.layer).range(0..=4095)));
    });
    let (side, output, layer) = (writing.side, writing.output.trim().to_owned(), writing.layer);
    let mut job = None;
    ui.horizontal_wrapped(|ui| {
        if ui.button("Write the picture").clicked() {
            let path = PathBuf::from(writing.path.trim());
            job = Some(Job::Picture { side, output: output.clone(), layer, path, size });
        }
        if ui.button("Send to tev").on_hover_text(format!("at {}", metrics::tev::ADDRESS)).clicked() {
            job = Some(Job::Tev { side, output, layer });
        }
        let about = "Runs one frame for RenderDoc, where the program was started in it";
        if ui.button("Capture a frame").on_hover_text(about).clicked() {
            job = Some(Job::Capture(side));
        }
    });
    if let Some(job) = job {
        app.engine.send(Command::Job(job));
    }
    let writing = &mut app.writing;
    ui.separator();
    ui.strong("The animation");
    ui.label("Frames from its start: pictures with #### for the number, or .mp4, .webm, .mkv by ffmpeg.");
    field(ui, "Files", &mut writing.sequence);
    ui.horizontal(|ui| {
        labelled(ui, "Frames", |ui| ui.add(DragValue::new(&mut writing.frames).range(1..=100_000)));
    });
    if ui.button("Write the animation").clicked() {
        let path = PathBuf::from(writing.sequence.trim());
        let job = Job::Sequence { side: writing.side, path, frames: writing.frames, size };
        app.engine.send(Command::Job(job));
    }
}
