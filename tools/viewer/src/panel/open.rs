//! Opens a file: by its path, or from the list of a folder.

use crate::app::App;
use crate::engine::SideId;
use crate::files::{Entry, Kind, entries, shortest};
use crate::leave::Leave;
use eframe::egui::{Context, Id, Key, Modal, Role, ScrollArea, TextEdit, WidgetInfo};
use frame_graph::Overrides;
use std::path::{Path, PathBuf};

/// What is to be opened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum What {
    /// A pipeline for a side.
    Pipeline(SideId),
    /// A scene.
    Scene,
}

impl What {
    fn kind(self) -> Kind {
        match self {
            What::Pipeline(_) => Kind::Pipeline,
            What::Scene => Kind::Scene,
        }
    }
}

/// The dialog while it is open.
#[derive(Debug)]
pub(crate) struct Opening {
    what: What,
    folder: PathBuf,
    entries: Vec<Entry>,
    path: String,
    opened: bool,
}

impl Opening {
    /// Begins in a folder.
    pub(crate) fn new(what: What, folder: &Path) -> Opening {
        let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
        Opening { what, entries: entries(&folder), folder, path: String::new(), opened: false }
    }

    fn enter(&mut self, folder: PathBuf) {
        self.entries = entries(&folder);
        self.folder = folder;
    }
}

impl App {
    /// Opens a file, or asks first where changes would be lost.
    pub(crate) fn open(&mut self, what: What, name: String, context: &Context) {
        let leave = match what {
            What::Pipeline(side) => Leave::Pipeline(side, name, Overrides::default()),
            What::Scene => Leave::Scene(name),
        };
        self.leave(leave, context);
    }
}

/// Shows the dialog where it is open.
pub(crate) fn show(app: &mut App, context: &Context) {
    let Some(mut opening) = app.opening.take() else { return };
    let (mut chosen, mut entered, mut cancel) = (None, None, false);
    let modal = Modal::new(Id::unique("open")).show(context, |ui| {
        ui.set_width(520f32.min(context.content_rect().width() - 40.0));
        ui.heading(match opening.what {
            What::Pipeline(side) => format!("Open a pipeline as {}", side.name()),
            What::Scene => "Open a scene".to_owned(),
        });
        let field = TextEdit::singleline(&mut opening.path).desired_width(f32::INFINITY);
        let field = ui.add(field.hint_text("A path, or choose below"));
        field.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, "Path"));
        if !opening.opened {
            field.request_focus();
            opening.opened = true;
        }
        let typed = opening.path.trim().to_owned();
        if !typed.is_empty() && ui.input(|input| input.key_pressed(Key::Enter)) {
            chosen = Some(typed.clone());
        }
        ui.weak(opening.folder.display().to_string());
        let height = (context.content_rect().height() - 220.0).clamp(80.0, 320.0);
        ScrollArea::vertical().max_height(height).min_scrolled_height(height).auto_shrink(false).show(
            ui,
            |ui| {
                if let Some(parent) = opening.folder.parent()
                    && ui.selectable_label(false, "../").clicked()
                {
                    entered = Some(parent.to_owned());
                }
                for entry in &opening.entries {
                    match entry {
                        Entry::Folder(path) => {
                            let name = path.file_name().unwrap_or_default().to_string_lossy();
                            if ui.selectable_label(false, format!("{name}/")).clicked() {
                                entered = Some(path.clone());
                            }
                        }
                        Entry::File(path, kind) if *kind == opening.what.kind() => {
                            let name = path.file_name().unwrap_or_default().to_string_lossy();
                            if ui.selectable_label(false, name).clicked() {
                                chosen = Some(shortest(path));
                            }
                        }
                        Entry::File(..) => {}
                    }
                }
            },
        );
        ui.horizontal(|ui| {
            if ui.add_enabled(!typed.is_empty(), eframe::egui::Button::new("Open")).clicked() {
                chosen = Some(typed.clone());
            }
            cancel = ui.button("Cancel").on_hover_text("Escape").clicked();
        });
    });
    if let Some(folder) = entered {
        opening.enter(folder);
    }
    match chosen {
        Some(name) => app.open(opening.what, name, context),
        None if cancel || modal.should_close() => {}
        None => app.opening = Some(opening),
    }
}
