//! Names a file and writes it: a variant of the pipeline, or the scene.

use crate::app::App;
use crate::engine::{SceneView, SideId, SideView};
use crate::terminal;
use anyhow::{Context as _, Result, bail};
use data_file::Source;
use eframe::egui::{Context, Id, Key, Modal, TextEdit};
use frame_graph::{Overrides, resolve, variant};
use scene::SceneEdit;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A file that is about to be written.
pub(crate) struct Saving {
    what: What,
    path: String,
    about: String,
    error: Option<String>,
    opened: bool,
}

enum What {
    Variant(SideId),
    Scene(SceneEdit),
}

impl Saving {
    /// A variant of the pipeline of a side with the values that were changed.
    pub(crate) fn variant(app: &App, id: SideId) -> Option<Saving> {
        let side = app.now.side(id)?;
        let stem = Path::new(&side.name).file_stem()?.to_string_lossy().into_owned();
        let path = free(|number| format!("{stem}-variant{number}.ron"));
        Some(Saving { what: What::Variant(id), path, about: String::new(), error: None, opened: false })
    }

    /// The scene with the camera, lights and keys as they are now.
    pub(crate) fn scene(app: &App) -> Option<Saving> {
        let view = app.now.scene.as_ref()?;
        let edit = app.scene_panel.edit(app);
        let path = match &view.file {
            Some(file) => file.display().to_string(),
            // A scene that is built in, or a bare file of geometry, gets a file of its own.
            None => free(|number| format!("{}-edited{number}.ron", view.scene.name)),
        };
        Some(Saving { what: What::Scene(edit), path, about: String::new(), error: None, opened: false })
    }

    /// The file of a variant.
    fn variant_text(&self, app: &App, side: &SideView) -> Result<String> {
        let base = resolve(&side.name, app.catalog.pipelines(), &Overrides::default())?;
        Ok(variant(&side.name, self.about.trim(), &base, &*app.catalog, &side.overrides))
    }

    fn write(&self, app: &App) -> Result<String> {
        let path = PathBuf::from(self.path.trim());
        match &self.what {
            What::Variant(side) => {
                let side = app.now.side(*side).context("no pipeline is loaded")?;
                if path.file_name().is_some() && path.extension().is_none_or(|ending| ending != "ron") {
                    bail!("{}: expected a name that ends in .ron", path.display());
                }
                let text = self.variant_text(app, side)?;
                write_new(&path, &text)?;
                Ok(format!(
                    "wrote {}: `lightloom study` and every command take it as a pipeline",
                    path.display()
                ))
            }
            What::Scene(edit) => {
                let view = app.now.scene.as_ref().context("no scene is loaded")?;
                if edit.camera.as_ref().is_some_and(|camera| !super::scene::can_be_saved(camera)) {
                    bail!("the camera looks nowhere: its position and target are the same point");
                }
                if view.file.as_deref() == Some(path.as_path()) {
                    scene::save(&path, edit)?;
                } else if let Some(source) = text_of(app, view) {
                    write_new(&path, &scene::edited(&source, edit)?)?;
                } else {
                    let spec = &view.scene.spec;
                    let spec =
                        Path::new(spec).canonicalize().map_or(spec.clone(), |p| p.display().to_string());
                    write_new(&path, &scene::scene_file_for(&view.scene, &spec, edit)?)?;
                }
                Ok(format!("wrote {}", path.display()))
            }
        }
    }
}

/// The first name that no file has: without a number, then with 2 and so on.
fn free(name: impl Fn(String) -> String) -> String {
    let first = name(String::new());
    if !Path::new(&first).exists() {
        return first;
    }
    (2..).map(|n| name(format!("-{n}"))).find(|name| !Path::new(name).exists()).unwrap_or(first)
}

/// The text of the scene's file, on disk or built in; `None` for a bare file of geometry.
fn text_of(app: &App, view: &SceneView) -> Option<Arc<Source>> {
    let spec = &view.scene.spec;
    let text = match &view.file {
        Some(file) => std::fs::read_to_string(file).ok()?,
        None => app.catalog.assets().text(&format!("scenes/{spec}.ron"))?,
    };
    Some(Source::new(spec.clone(), text))
}

/// Writes a new file under a temporary name and gives it its own at the end.
fn write_new(path: &Path, text: &str) -> Result<()> {
    if path.exists() {
        bail!("{} exists already; choose another name", path.display());
    }
    if path.file_name().is_none() {
        bail!("a file needs a name");
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        bail!("there is no folder {}", folder.display());
    }
    whole_file::write_new(path, text).with_context(|| format!("{} was not written", path.display()))
}

/// Asks for the name where something is about to be saved.
pub(crate) fn show(app: &mut App, context: &Context) {
    let Some(mut saving) = app.saving.take() else { return };
    let (mut done, mut saved) = (false, false);
    let modal = Modal::new(Id::unique("save")).show(context, |ui| {
        ui.set_width(520f32.min(context.content_rect().width() - 40.0));
        let heading = match &saving.what {
            What::Variant(_) => "Save the changed settings as a variant",
            What::Scene(_) => "Save camera, lights and keys",
        };
        ui.heading(heading);
        let name = ui.label("File");
        let field = ui.add(TextEdit::singleline(&mut saving.path).desired_width(f32::INFINITY));
        let field = field.labelled_by(name.id);
        if !saving.opened {
            field.request_focus();
            saving.opened = true;
        }
        if let What::Variant(side) = &saving.what {
            let about = ui.label("Summary, in one line (may be empty)");
            ui.add(TextEdit::singleline(&mut saving.about).desired_width(f32::INFINITY))
                .labelled_by(about.id);
            if let Some(side) = app.now.side(*side)
                && let Ok(text) = saving.variant_text(app, side)
            {
                ui.monospace(text.trim_end());
            }
        }
        if let Some(error) = &saving.error {
            ui.colored_label(ui.visuals().error_fg_color, error);
        }
        ui.horizontal(|ui| {
            let enter = ui.input(|input| input.key_pressed(Key::Enter));
            if ui.button("Save").clicked() || enter {
                match saving.write(app) {
                    Ok(line) => {
                        if let What::Variant(side) = saving.what
                            && let Some((name, overrides)) =
                                app.now.side(side).map(|side| (side.name.clone(), side.overrides.clone()))
                        {
                            app.saved.take_settings(&name, &overrides);
                        }
                        if let What::Scene(_) = saving.what {
                            app.scene_panel.saved();
                            app.saved.take_lights(app.pilot.lights.clone());
                            let file = app.now.scene.as_ref().and_then(|view| view.file.as_deref());
                            app.holds_what_is_saved = file == Some(Path::new(saving.path.trim()));
                        }
                        terminal::say(&line);
                        app.engine.published().say(line, false);
                        saved = true;
                    }
                    Err(error) => {
                        saving.error = Some(format!("{error:#}"));
                        // The name is what is mended.
                        saving.opened = false;
                    }
                }
            }
            if ui.button("Cancel").clicked() {
                done = true;
            }
        });
    });
    if saved {
        app.leave_after_save(context);
    } else if !done && !modal.should_close() {
        app.saving = Some(saving);
    } else {
        app.leave_after_save = None;
    }
}
