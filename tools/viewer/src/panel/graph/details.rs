//! What is known of the pass that was clicked in the graph.

use crate::app::App;
use crate::engine::SideView;
use eframe::egui::{ScrollArea, Ui};
use frame_graph::plan::{BoxKind, PassId, ResourceId};

/// Draws the panel beside the graph.
pub(crate) fn show(app: &mut App, ui: &mut Ui) {
    let Some(side) = app.now.side(app.graph.side).cloned() else { return };
    let Some((_, drawing)) = app.graph.drawing.clone() else { return };
    for line in &drawing.summary {
        ui.weak(line);
    }
    ui.separator();
    let chosen = app.graph.chosen.clone();
    let Some(drawn) = drawing.boxes.iter().find(|drawn| Some(drawn.name.as_str()) == chosen.as_deref())
    else {
        ui.label("Click a box for what it reads and writes.");
        return;
    };
    ui.strong(drawn.name.as_str());
    ui.label(&drawn.title);
    for line in drawn.lines.iter().skip(1).filter(|line| !line.is_empty()) {
        ui.weak(line);
    }
    let mut look = None;
    ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| match drawn.kind {
        BoxKind::Pass(id) => look = of_pass(ui, &side, id),
        BoxKind::Output | BoxKind::Culled => {
            if ui.button("Look at it").clicked() {
                look = Some(drawn.name.to_string());
            }
        }
        BoxKind::Off => {}
    });
    if let Some(name) = look {
        app.look_at(app.graph.side, &name);
    }
}

/// The times, inputs and outputs of a pass; returns the resource that is to be looked at.
fn of_pass(ui: &mut Ui, side: &SideView, id: PassId) -> Option<String> {
    let pass = side.plan.passes.get(id.0 as usize)?;
    let ran = side.ran.get(id.0 as usize) == Some(&true);
    let mean = side.times.get(id.0 as usize).and_then(|times| times.mean());
    ui.label(match (ran, mean) {
        (true, Some(ms)) => format!("Ran in the last frame; {ms:.3} ms in the mean"),
        (true, None) => "Ran in the last frame".to_owned(),
        (false, _) => "Did not run in the last frame: what it would write has not changed".to_owned(),
    });
    let mut look = None;
    let mut resource = |ui: &mut Ui, id: ResourceId| {
        let Some(resource) = side.plan.resources.get(id.0 as usize) else { return };
        let about = crate::panel::look::describe(&resource.desc);
        if ui.link(resource.name.as_str()).on_hover_text("Look at it").clicked() {
            look = Some(resource.name.to_string());
        }
        ui.weak(about);
    };
    ui.strong("Reads");
    for input in &pass.inputs {
        let before = if input.history.is_some() { ", of the frame before" } else { "" };
        ui.label(format!("{}: {}{before}", input.port, input.interface));
        input.members.iter().for_each(|(_, id)| resource(ui, *id));
    }
    ui.strong("Writes");
    for output in &pass.outputs {
        ui.label(format!("{}: {}", output.port, output.interface));
        output.members.iter().for_each(|(_, id)| resource(ui, *id));
    }
    look
}
