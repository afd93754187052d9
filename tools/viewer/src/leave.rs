//! Asks before changes are lost: where the window is closed, or another pipeline or scene is opened.

use crate::app::App;
use crate::engine::SideId;
use crate::panel::save::Saving;
use eframe::egui::{Context, Id, Modal, ViewportCommand};
use frame_graph::Overrides;

/// Something that ends what is being worked on.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Leave {
    /// The window is closed.
    Quit,
    /// Another pipeline is opened, with these values.
    Pipeline(SideId, String, Overrides),
    /// The comparison ends.
    CloseOther,
    /// Another scene is opened.
    Scene(String),
}

/// The question that is asked.
#[derive(Clone, Debug)]
pub(crate) struct Leaving {
    leave: Leave,
    opened: bool,
}

impl Leave {
    /// Returns the sides that end.
    fn closed(&self) -> Vec<SideId> {
        match self {
            Leave::Quit => vec![SideId::A, SideId::B],
            Leave::Pipeline(side, ..) => vec![*side],
            Leave::CloseOther => vec![SideId::B],
            Leave::Scene(_) => Vec::new(),
        }
    }

    fn ends_scene(&self) -> bool {
        matches!(self, Leave::Quit | Leave::Scene(_))
    }

    /// Returns the words of the button that goes on.
    fn words(&self) -> String {
        match self {
            Leave::Quit => "Quit without saving".to_owned(),
            Leave::Pipeline(_, name, _) | Leave::Scene(name) => format!("Open {name} without saving"),
            Leave::CloseOther => "Close B without saving".to_owned(),
        }
    }
}

impl App {
    /// Ends what is being worked on, or asks first where changes would be lost.
    pub(crate) fn leave(&mut self, leave: Leave, context: &Context) {
        let lost = !self.unsaved_settings(&leave.closed()).is_empty()
            || leave.ends_scene() && !self.unsaved_scene().is_empty();
        if lost {
            self.leaving = Some(Leaving { leave, opened: false });
        } else {
            self.go(leave, context);
        }
    }

    fn go(&mut self, leave: Leave, context: &Context) {
        match leave {
            Leave::Quit => {
                self.quits = true;
                context.send_viewport_cmd(ViewportCommand::Close);
            }
            Leave::Pipeline(side, name, overrides) => self.open_pipeline(side, &name, overrides),
            Leave::CloseOther => self.close_other(),
            Leave::Scene(name) => self.open_scene(&name),
        }
    }

    /// Goes on with what was asked for before a file was saved.
    pub(crate) fn leave_after_save(&mut self, context: &Context) {
        if let Some(leave) = self.leave_after_save.take() {
            self.leave(leave, context);
        }
    }

    /// Holds the window open where its close button was pressed and changes would be lost.
    pub(crate) fn hold_open(&mut self, context: &Context) {
        if self.quits || !context.input(|input| input.viewport().close_requested()) {
            return;
        }
        self.leave(Leave::Quit, context);
        if !self.quits {
            context.send_viewport_cmd(ViewportCommand::CancelClose);
        }
    }
}

/// Asks where something is about to be lost.
pub(crate) fn show(app: &mut App, context: &Context) {
    let Some(mut leaving) = app.leaving.take() else { return };
    let settings = app.unsaved_settings(&leaving.leave.closed());
    let of_scene = if leaving.leave.ends_scene() { app.unsaved_scene() } else { Vec::new() };
    let (mut save, mut discard, mut cancel) = (false, false, false);
    let modal = Modal::new(Id::unique("leave")).show(context, |ui| {
        ui.set_width(440f32.min(context.content_rect().width() - 40.0));
        ui.heading("Changes that are in no file");
        for line in settings.iter().map(|(_, line)| line).chain(&of_scene) {
            ui.label(format!("• {line}"));
        }
        ui.add_space(6.0);
        ui.horizontal_wrapped(|ui| {
            let button = ui.button("Save…");
            if !leaving.opened {
                button.request_focus();
                leaving.opened = true;
            }
            save = button.clicked();
            discard = ui.button(leaving.leave.words()).clicked();
            cancel = ui.button("Cancel").on_hover_text("Escape").clicked();
        });
    });
    if save {
        let saving = match settings.first() {
            Some((side, _)) => Saving::variant(app, *side),
            None => Saving::scene(app),
        };
        app.leave_after_save = saving.is_some().then(|| leaving.leave.clone());
        app.saving = saving;
    } else if discard {
        app.go(leaving.leave, context);
    } else if !cancel && !modal.should_close() {
        app.leaving = Some(leaving);
    }
}
