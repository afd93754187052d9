//! The application: the content of the window, and its reaction to input.

use crate::action::{Action, Entry, Tab, View, table};
use crate::auto::Auto;
use crate::editor::Editor;
use crate::edits::{Saved, Settings};
use crate::engine::{Command, Engine, Look, Measures, Published, SceneView, SideId, Start};
use crate::files::{Beside, remember};
use crate::history::History;
use crate::leave::{Leave, Leaving};
use crate::palette::Palette;
use crate::panel;
use crate::panel::look::Inspector;
use crate::panel::open::{Opening, What};
use crate::panel::settings::Controls;
use crate::pilot::Pilot;
use crate::remembered::Remembered;
use crate::snapshots::Snapshots;
use crate::textures::Textures;
use crate::viewport::{self, FrameSize};
use eframe::egui::{
    self, CentralPanel, Context, FontDefinitions, FontFamily, KeyboardShortcut, Panel, ScrollArea, Ui,
};
use frame_graph::Overrides;
use renderer::Catalog;
use std::sync::Arc;
use std::time::Instant;

/// The application.
pub(crate) struct App {
    pub(crate) engine: Engine,
    pub(crate) catalog: Arc<Catalog>,
    pub(crate) remembered: Remembered,
    /// The state that the engine had published when this frame of the interface began.
    pub(crate) now: Published,
    pub(crate) textures: Textures,
    pub(crate) pilot: Pilot,
    pub(crate) controls: Controls,
    pub(crate) inspector: Inspector,
    pub(crate) palette: Option<Palette>,
    pub(crate) help: bool,
    pub(crate) bare: bool,
    pub(crate) virtual_lights: bool,
    /// Whether passes are timed.
    pub(crate) timing: bool,
    /// Whether all passes run in every frame.
    pub(crate) runs_everything: bool,
    /// The resolution that is chosen by how long frames take.
    pub(crate) auto: Auto,
    /// The size that frames are to have.
    pub(crate) frame_size: FrameSize,
    /// Whether the reference is wanted.
    pub(crate) reference: bool,
    /// Whether B is shown where the view flickers.
    pub(crate) flicked: bool,
    pub(crate) graph: panel::graph::Graph,
    pub(crate) scene_panel: panel::scene::ScenePanel,
    pub(crate) writing: panel::write::Writing,
    /// A file that is to be named: what is saved, and the name so far.
    pub(crate) saving: Option<panel::save::Saving>,
    /// The dialog that opens a file.
    pub(crate) opening: Option<panel::open::Opening>,
    /// The files of the working folder.
    pub(crate) beside: Beside,
    /// The pictures that were kept.
    pub(crate) snapshots: Snapshots,
    /// The pipelines and their values as the user asked for them.
    pub(crate) settings: Vec<Settings>,
    /// What of it is in files.
    pub(crate) saved: Saved,
    /// The way back.
    pub(crate) history: History,
    /// What would lose changes, and is asked about.
    pub(crate) leaving: Option<Leaving>,
    /// The same, while the changes are being saved.
    pub(crate) leave_after_save: Option<Leave>,
    /// Whether the window is being closed, and nothing is asked any more.
    pub(crate) quits: bool,
    /// Whether camera and lights are held as they were written into the scene's file: the scene's own are shown as soon as it
    /// is read again, so that the next change of the file is seen.
    pub(crate) holds_what_is_saved: bool,
    /// Where the places of errors are opened.
    pub(crate) editor: Option<Editor>,
    /// When a plain key was taken last, the key, and what it does: whoever meant to type sees it.
    pub(crate) pressed: Option<(Instant, String)>,
    /// When the window was opened.
    pub(crate) begun: Instant,
    /// Milliseconds that the interface took, averaged.
    pub(crate) interface_ms: f32,
    /// Pipelines and scenes there are, with a line about each.
    pub(crate) library: panel::library::Library,
    measures: Option<Measures>,
    look: Option<Look>,
}

impl App {
    /// Starts the engine and shows what it publishes.
    pub(crate) fn new(context: &Context, start: Start, remembered: Remembered) -> App {
        context.set_fonts(fonts());
        crate::theme::install(context);
        let repaint = context.clone();
        let catalog = Arc::clone(&start.catalog);
        let library = panel::library::Library::load(Arc::clone(&catalog), context.clone());
        let mut remembered = remembered;
        // What was remembered belongs to another scene, or to a pair that is not asked for.
        let same_scene = remembered.scene == start.scene;
        let camera = remembered.camera.filter(|_| same_scene);
        if is_file(&start.scene) {
            remember(&mut remembered.recent_scenes, &start.scene);
        }
        if is_file(&start.pipeline) {
            remember(&mut remembered.recent_pipelines, &start.pipeline);
        }
        remembered.scene.clone_from(&start.scene);
        remembered.pipeline.clone_from(&start.pipeline);
        let other = remembered.other.clone();
        let mut saved = Saved::default();
        saved.take_settings(&start.pipeline, &start.overrides);
        let mut settings = vec![(SideId::A, start.pipeline.clone(), start.overrides.clone())];
        if !other.is_empty() {
            settings.push((SideId::B, other.clone(), Overrides::default()));
        }
        let engine = Engine::start(start, move || repaint.request_repaint());
        if !other.is_empty() {
            engine.send(Command::Pipeline(SideId::B, other, Overrides::default()));
        }
        let mut pilot = Pilot::default();
        if let Some(camera) = camera {
            pilot.take(&engine, camera, true);
        }
        App {
            engine,
            catalog,
            now: Published::default(),
            textures: Textures::default(),
            pilot,
            controls: Controls::default(),
            inspector: Inspector::default(),
            palette: None,
            help: false,
            bare: false,
            virtual_lights: false,
            timing: true,
            runs_everything: false,
            auto: Auto::default(),
            frame_size: FrameSize::default(),
            reference: false,
            flicked: false,
            graph: panel::graph::Graph::default(),
            scene_panel: panel::scene::ScenePanel::default(),
            writing: panel::write::Writing::default(),
            saving: None,
            opening: None,
            beside: Beside::default(),
            snapshots: Snapshots::default(),
            settings,
            saved,
            history: History::default(),
            leaving: None,
            leave_after_save: None,
            quits: false,
            holds_what_is_saved: false,
            editor: None,
            pressed: None,
            begun: Instant::now(),
            interface_ms: 0.0,
            library,
            measures: None,
            look: None,
            remembered,
        }
    }

    /// Draws one frame of the interface.
    pub(crate) fn show(&mut self, ui: &mut Ui) {
        let _span = tracing::trace_span!(target: "frame", "interface").entered();
        let begun = Instant::now();
        let now = self.engine.published().clone();
        let before = std::mem::replace(&mut self.now, now);
        self.take_scene(before.scene.as_ref());
        self.take_settings();
        self.follow_auto(ui.ctx());
        self.hold_open(ui.ctx());
        self.pilot.time.take_if(|time| *time == self.now.time || self.now.playing);
        if let Some(dark) = self.remembered.dark {
            ui.ctx().set_theme(if dark { egui::Theme::Dark } else { egui::Theme::Light });
        }
        self.take_shortcuts(ui.ctx());
        if !self.bare {
            Panel::top("bar").show(ui, |ui| panel::bar::show(self, ui));
            Panel::bottom("status").show(ui, |ui| panel::status::show(self, ui));
            let room = ui.available_width();
            let mut left = 0.0;
            if self.remembered.settings {
                let panel =
                    Panel::left("settings").default_size(290.0).size_range(panel::settings_width(room));
                let shown = panel.show(ui, |ui| {
                    // What is wider wraps: a panel that grew by itself would change the size of frames.
                    ui.set_max_width(ui.available_width());
                    panel::settings::show(self, ui);
                });
                left = shown.response.rect.width();
            }
            if self.remembered.panels {
                let panel =
                    Panel::right("panels").default_size(400.0).size_range(panel::panels_width(room, left));
                panel.show(ui, |ui| {
                    // What does not wrap is scrolled to.
                    let width = ui.available_width();
                    ScrollArea::horizontal().auto_shrink([false, false]).show(ui, |ui| {
                        ui.set_max_width(width);
                        panel::show(self, ui);
                    });
                });
            }
        }
        let frame = egui::Frame::central_panel(ui.style()).inner_margin(0.0);
        CentralPanel::default().frame(frame).show(ui, |ui| {
            if self.shows_graph() { panel::graph::show(self, ui) } else { viewport::show(self, ui) }
        });
        let context = ui.ctx().clone();
        panel::help::show(self, &context);
        crate::palette::show(self, &context);
        panel::save::show(self, &context);
        panel::open::show(self, &context);
        crate::leave::show(self, &context);
        self.remember_steps(&context);
        self.request();
        let ms = begun.elapsed().as_secs_f32() * 1e3;
        self.interface_ms += (ms - self.interface_ms) * 0.1;
    }

    /// Follows a scene that was read again.
    fn take_scene(&mut self, before: Option<&SceneView>) {
        let (Some(before), Some(now)) = (before, &self.now.scene) else { return };
        if Arc::ptr_eq(&before.scene, &now.scene) {
            return;
        }
        if std::mem::take(&mut self.holds_what_is_saved) {
            self.pilot.release(&self.engine);
            self.pilot.release_lights(&self.engine);
        }
        if before.scene.spec == now.scene.spec && before.scene.origin != now.scene.origin {
            // What was moved by hand stays where it is in the file's space.
            let by = (before.scene.origin - now.scene.origin).as_vec3();
            let spec = now.scene.spec.clone();
            self.pilot.shift(&self.engine, by);
            self.shift_bookmarks(&spec, by);
            self.history = History::default();
            self.scene_panel.saved();
        }
    }

    /// Requests measures and resources from the engine, where they differ from those before.
    fn request(&mut self) {
        let comparing = self.now.sides.len() > 1;
        let measures = Measures {
            errors: comparing && self.remembered.errors,
            map: match self.remembered.view {
                View::Difference if comparing => Some(crate::engine::Map::Difference),
                View::Flip if comparing => Some(crate::engine::Map::Flip),
                _ => None,
            },
            gain: self.remembered.gain,
        };
        if self.measures != Some(measures) {
            self.measures = Some(measures);
            self.engine.send(Command::Measure(measures));
        }
        let open = self.remembered.panels && !self.bare && self.remembered.tab == Tab::Look;
        let look = self.inspector.wanted(&self.now).filter(|_| open || self.inspector.over_picture);
        if self.look != look {
            self.look.clone_from(&look);
            self.engine.send(Command::Look(look));
        }
    }

    fn take_shortcuts(&mut self, context: &Context) {
        context.input(|input| self.pilot.hold(input));
        // A widget that has the focus gets plain keys first.
        let typing = context.memory(|memory| memory.focused().is_some()) || self.asks();
        let of_text = context.text_edit_focused();
        let entries = table();
        let is_function = |key: &KeyboardShortcut| {
            key.logical_key.name().starts_with('F') && key.logical_key.name().len() > 1
        };
        let taken: Vec<&Entry> = context.input_mut(|input| {
            let takes = |entry: &&Entry| {
                let Some(key) = entry.key else { return false };
                let function = is_function(&key);
                // A text has its own steps back and forward.
                let own = of_text && matches!(entry.action, Action::Undo | Action::Redo);
                let free = (key.modifiers.command || function || !typing) && !own;
                free && input.consume_shortcut(&key)
            };
            entries.iter().filter(takes).collect()
        });
        for entry in taken {
            if let Some(key) = entry.key.filter(|key| !key.modifiers.command && !is_function(key)) {
                let line = format!("{}: {}", context.format_shortcut(&key), entry.about);
                self.pressed = Some((Instant::now(), line));
            }
            self.act(entry.action, context);
        }
    }

    /// Whether something is asked for over the window, which keys go to.
    pub(crate) fn asks(&self) -> bool {
        self.palette.is_some() || self.saving.is_some() || self.leaving.is_some() || self.opening.is_some()
    }

    /// Does what an action says.
    pub(crate) fn act(&mut self, action: Action, context: &Context) {
        match action {
            Action::Help => self.help = !self.help,
            Action::Palette => {
                self.palette = match self.palette {
                    Some(_) => None,
                    None => Some(Palette::default()),
                }
            }
            Action::Undo => self.undo(),
            Action::Redo => self.redo(),
            Action::Swap => self.swap(),
            Action::Flick => {
                self.remembered.view = View::Flicker;
                self.flicked = !self.flicked;
            }
            Action::Show(view) => self.remembered.view = view,
            Action::Open(tab) => {
                let open = self.remembered.panels && self.remembered.tab == tab && !self.bare;
                self.remembered.panels = !open;
                self.remembered.tab = tab;
                self.bare = false;
            }
            Action::Settings => self.remembered.settings = !self.remembered.settings,
            Action::Bare => self.bare = !self.bare,
            Action::Play => self.engine.send(Command::Play(!self.now.playing)),
            Action::Rewind => self.go_to_time(0.0),
            Action::SceneCamera => {
                self.pilot.release(&self.engine);
                self.remembered.camera = None;
            }
            Action::SceneLights => {
                self.pilot.release_lights(&self.engine);
            }
            Action::Key => {
                if let Some(camera) = self.pilot.camera().or(self.now.camera) {
                    self.scene_panel.record(&self.now, camera, self.time());
                }
            }
            Action::OpenPipeline => self.choose_file(What::Pipeline(SideId::A)),
            Action::OpenScene => self.choose_file(What::Scene),
            Action::Snapshot => self.keep_snapshot(),
            Action::FlickSnapshot => self.snapshots.flick(),
            Action::Bookmark => self.bookmark(),
            Action::SaveScene => self.saving = panel::save::Saving::scene(self),
            Action::SaveVariant => self.saving = panel::save::Saving::variant(self, SideId::A),
            Action::Screenshot => self.screenshot(),
            Action::VirtualLights => {
                self.virtual_lights = !self.virtual_lights;
                self.engine.send(Command::VirtualLights(self.virtual_lights));
            }
            Action::Handles => self.remembered.handles = !self.remembered.handles,
            Action::Reference => {
                self.reference = !self.reference;
                let command = match self.reference {
                    true => {
                        Command::Pipeline(SideId::Reference, "reference".to_owned(), Overrides::default())
                    }
                    false => Command::Close(SideId::Reference),
                };
                self.engine.send(command);
            }
            Action::Theme => {
                self.remembered.dark = Some(!context.theme().default_visuals().dark_mode);
            }
            Action::Quit => self.leave(Leave::Quit, context),
        }
    }

    /// The time of the animation that is shown, or that the user asked for since.
    pub(crate) fn time(&self) -> f32 {
        self.pilot.time.unwrap_or(self.now.time)
    }

    /// Shows the animation at a time \[s\].
    pub(crate) fn go_to_time(&mut self, time: f32) {
        self.pilot.time = Some(time);
        self.engine.send(Command::Time(time));
    }

    /// Renders by another pipeline, with values for its parameters and settings.
    pub(crate) fn open_pipeline(&mut self, side: SideId, name: &str, overrides: Overrides) {
        match side {
            SideId::A => name.clone_into(&mut self.remembered.pipeline),
            SideId::B => name.clone_into(&mut self.remembered.other),
            SideId::Reference => {}
        }
        if side == SideId::B && self.now.side(SideId::B).is_none() && self.remembered.view == View::One {
            self.remembered.view = View::Split;
        }
        if is_file(name) {
            remember(&mut self.remembered.recent_pipelines, name);
        }
        self.controls.forget(side);
        if side == SideId::A {
            self.auto = Auto::default();
        }
        if overrides.0.is_empty() {
            // As its file says, whatever was given or saved before.
            self.saved.take_settings(name, &overrides);
        }
        self.settings.retain(|(known, ..)| *known != side);
        self.settings.push((side, name.to_owned(), overrides.clone()));
        self.settings.sort_by_key(|(side, ..)| *side);
        self.engine.send(Command::Pipeline(side, name.to_owned(), overrides));
    }

    /// Ends the comparison.
    pub(crate) fn close_other(&mut self) {
        self.remembered.other.clear();
        self.remembered.view = View::One;
        self.settings.retain(|(side, ..)| *side != SideId::B);
        self.engine.send(Command::Close(SideId::B));
    }

    /// Shows another scene.
    pub(crate) fn open_scene(&mut self, name: &str) {
        name.clone_into(&mut self.remembered.scene);
        if is_file(name) {
            remember(&mut self.remembered.recent_scenes, name);
        }
        self.pilot = Pilot::default();
        self.remembered.camera = None;
        self.scene_panel = panel::scene::ScenePanel::default();
        self.saved.take_lights(None);
        self.auto = Auto::default();
        // Lights and cameras of one scene mean nothing in another.
        self.history = History::default();
        self.engine.send(Command::Scene(name.to_owned()));
    }

    /// Asks for a file to open.
    pub(crate) fn choose_file(&mut self, what: What) {
        self.opening = Some(Opening::new(what, std::path::Path::new(".")));
    }

    fn swap(&mut self) {
        let both = (self.now.side(SideId::A).cloned(), self.now.side(SideId::B).cloned());
        let (Some(a), Some(b)) = both else { return };
        self.open_pipeline(SideId::A, &b.name, b.overrides);
        self.open_pipeline(SideId::B, &a.name, a.overrides);
    }

    fn screenshot(&mut self) {
        let path = self.writing.next_screenshot(&self.now);
        let has_display = self.now.side(SideId::A).is_some_and(|side| side.plan.output("display").is_some());
        let output = if has_display { "display" } else { "image" };
        let job = crate::engine::Job::Picture {
            side: SideId::A,
            output: output.to_owned(),
            layer: 0,
            path,
            size: self.remembered.written_size,
        };
        self.engine.send(Command::Job(job));
    }
}

/// Whether a name is that of a file, not of something that is built in.
fn is_file(name: &str) -> bool {
    std::path::Path::new(name).extension().is_some()
}

/// The fonts that come with egui; what the one for text lacks (arrows, mathematics) is taken from that for code.
fn fonts() -> FontDefinitions {
    let mut fonts = FontDefinitions::default();
    let of_code = fonts.families.get(&FontFamily::Monospace).cloned().unwrap_or_default();
    let of_text = fonts.families.entry(FontFamily::Proportional).or_default();
    of_text.extend(of_code);
    let mut known = std::collections::HashSet::new();
    of_text.retain(|name| known.insert(name.clone()));
    fonts
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut Ui, _: &mut eframe::Frame) {
        self.show(ui);
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        self.remembered.camera = self.pilot.camera();
        self.remembered.save(storage);
    }
}
