//! The graph of passes, drawn in the middle of the window with what ran and what did not.

mod details;

pub(crate) use details::show as show_details;

use crate::action::Tab;
use crate::app::App;
use crate::engine::{SideId, SideView};
use crate::panel::choose_side;
use eframe::egui::epaint::{CubicBezierShape, PathStroke};
use eframe::egui::{
    self, Align2, Color32, CornerRadius, FontId, Painter, Rect, Scene, Sense, Stroke, StrokeKind, Ui, Vec2,
    pos2, vec2,
};
use frame_graph::plan::{BoxKind, Drawing, DrawnBox, PlanId};

/// The least scale at which the whole drawing is shown at first: below it, text is too small.
const READABLE: f32 = 1.0;

/// The factor by which a button changes the scale.
const ZOOM: f32 = 1.25;

/// The ink of text on boxes: of the dark theme and of the light one.
pub(crate) const INK: [Color32; 2] = [Color32::from_gray(240), Color32::from_gray(20)];

/// The colors of boxes: of the dark theme and of the light one.
pub(crate) const FILLS: [(&str, [Color32; 2]); 5] = [
    ("a pass that ran", [Color32::from_rgb(28, 78, 118), Color32::from_rgb(190, 220, 245)]),
    ("a pass that did not run", [Color32::from_rgb(58, 66, 74), Color32::from_rgb(215, 222, 228)]),
    ("a culled pass", [Color32::from_gray(44), Color32::from_gray(170)]),
    ("a pass that is off", [Color32::from_rgb(92, 68, 24), Color32::from_rgb(247, 227, 192)]),
    ("an output", [Color32::from_rgb(34, 84, 44), Color32::from_rgb(205, 235, 200)]),
];

/// The state of the view.
pub(crate) struct Graph {
    side: SideId,
    drawing: Option<(PlanId, Drawing)>,
    /// The part of the drawing that is seen; without a size where it is to be chosen.
    seen: Rect,
    /// The name of the box that was clicked.
    chosen: Option<String>,
}

impl Default for Graph {
    fn default() -> Graph {
        Graph { side: SideId::A, drawing: None, seen: Rect::ZERO, chosen: None }
    }
}

impl Graph {
    /// Takes over the drawing of a plan. Where its boxes are others, all of it is seen again.
    fn take(&mut self, side: &SideView) {
        if self.drawing.as_ref().is_some_and(|(id, _)| *id == side.plan.id) {
            return;
        }
        let drawing = side.plan.drawing();
        let fits = self.drawing.as_ref().is_some_and(|(_, old)| old.boxes.len() == drawing.boxes.len());
        self.drawing = Some((side.plan.id, drawing));
        if !fits {
            self.seen = Rect::ZERO;
        }
    }
}

/// Returns the part of a drawing that is seen at first in a view of this size: all of it if it can be read then, else as
/// much as can be read, from where the frame begins.
fn at_first(drawing: Vec2, view: Vec2) -> Rect {
    let whole = (view / drawing).min_elem();
    if whole >= READABLE {
        return Rect::from_center_size((drawing * 0.5).to_pos2(), view / whole.min(1.5));
    }
    let size = view / READABLE.max(whole);
    let top = if drawing.y < size.y { (drawing.y - size.y) * 0.5 } else { 0.0 };
    Rect::from_min_size(pos2(0.0, top), size)
}

/// Returns a part of a drawing, larger or smaller by a factor, with the same middle.
fn zoomed(seen: Rect, by: f32) -> Rect {
    Rect::from_center_size(seen.center(), seen.size() / by)
}

/// Draws the graph in the middle of the window.
pub(crate) fn show(app: &mut App, ui: &mut Ui) {
    let sides: Vec<SideId> = app.now.sides.iter().map(|(id, _)| *id).collect();
    if !sides.contains(&app.graph.side) {
        app.graph.side = SideId::A;
    }
    let Some(side) = app.now.side(app.graph.side).cloned() else {
        ui.label("No pipeline is loaded.");
        return;
    };
    app.graph.take(&side);
    let Some((_, drawing)) = app.graph.drawing.clone() else { return };
    let (mut whole, mut by) = (false, 1.0);
    ui.horizontal_wrapped(|ui| {
        ui.add_space(6.0);
        choose_side(ui, &sides, &mut app.graph.side);
        whole = ui.button("Whole graph").clicked();
        for (name, about, factor) in [("+", "Larger", ZOOM), ("-", "Smaller", 1.0 / ZOOM)] {
            let button = ui.button(name).on_hover_text(about);
            button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, about));
            if button.clicked() {
                by = factor;
            }
        }
        ui.weak("Ctrl-wheel: zoom; wheel, drag: move; click: details; double click: look");
    });
    let room = ui.available_size();
    if whole {
        app.graph.seen = Rect::from_min_size(egui::Pos2::ZERO, Vec2::from(drawing.size));
    } else if app.graph.seen.size() == Vec2::ZERO {
        app.graph.seen = at_first(Vec2::from(drawing.size), room);
    }
    let (mut clicked, mut looked) = (None, None);
    let mut seen = zoomed(app.graph.seen, by);
    Scene::new().zoom_range(0.05..=4.0).show(ui, &mut seen, |ui| {
        let (_, area) = ui.allocate_space(Vec2::from(drawing.size));
        let origin = area.min;
        let painter = ui.painter().clone();
        edges(&painter, &drawing, origin.to_vec2(), ui.visuals().weak_text_color());
        for (i, drawn) in drawing.boxes.iter().enumerate() {
            let rect = Rect::from_min_size(origin + Vec2::from(drawn.at), Vec2::from(drawn.size));
            let response = ui.interact(rect, ui.scope_id().with(i), Sense::click());
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, drawn.name.as_str()));
            let chosen = app.graph.chosen.as_deref() == Some(drawn.name.as_str());
            let hot = response.hovered() || response.has_focus() || chosen;
            one_box(&painter, drawn, &side, rect, (hot, ui.visuals().dark_mode));
            if response.double_clicked() {
                looked = Some(drawn.name.to_string());
            }
            if response.on_hover_text(&drawn.title).clicked() {
                clicked = Some(drawn.name.to_string());
            }
        }
    });
    app.graph.seen = seen;
    app.graph.chosen = clicked.or(app.graph.chosen.take());
    if let Some(name) = looked {
        app.look_at(app.graph.side, &name);
    }
}

impl App {
    /// Returns whether the graph is in the middle of the window, in place of the picture.
    pub(crate) fn shows_graph(&self) -> bool {
        self.remembered.panels && self.remembered.tab == Tab::Graph
    }

    /// Opens the content of an output, a resource, or the first resource of a pass.
    pub(crate) fn look_at(&mut self, side: SideId, name: &str) {
        self.inspector.choose(side, name);
        (self.remembered.panels, self.remembered.tab) = (true, Tab::Look);
    }
}

fn edges(painter: &Painter, drawing: &Drawing, origin: Vec2, color: Color32) {
    for edge in &drawing.edges {
        let mut from = pos2(edge.start.0, edge.start.1) + origin;
        for curve in &edge.curves {
            let [a, b, to] = curve.map(|(x, y)| pos2(x, y) + origin);
            let width = if edge.past { 0.7 } else { 1.2 };
            painter.add(CubicBezierShape {
                points: [from, a, b, to],
                closed: false,
                fill: Color32::TRANSPARENT,
                stroke: PathStroke::new(width, color),
            });
            from = to;
        }
        let at = pos2(edge.label_at.0, edge.label_at.1) + origin;
        let align = if edge.past { Align2::LEFT_BOTTOM } else { Align2::RIGHT_BOTTOM };
        painter.text(at, align, &edge.label, FontId::proportional(11.0), color);
    }
}

fn one_box(painter: &Painter, drawn: &DrawnBox, side: &SideView, rect: Rect, (hot, dark): (bool, bool)) {
    let pass = match drawn.kind {
        BoxKind::Pass(id) => Some(id.0 as usize),
        _ => None,
    };
    let ran = pass.is_some_and(|pass| side.ran.get(pass) == Some(&true));
    let fill = match drawn.kind {
        BoxKind::Pass(_) if ran => 0,
        BoxKind::Pass(_) => 1,
        BoxKind::Culled => 2,
        BoxKind::Off => 3,
        BoxKind::Output => 4,
    };
    let theme = usize::from(!dark);
    let (fill, ink) = (FILLS[fill].1[theme], INK[theme]);
    let stroke = Stroke::new(if hot { 2.5 } else { 1.0 }, Color32::from_gray(120));
    painter.rect(rect, CornerRadius::same(4), fill, stroke, StrokeKind::Inside);
    let clip = painter.with_clip_rect(rect.shrink(3.0).intersect(painter.clip_rect()));
    for (i, line) in drawn.lines.iter().enumerate() {
        let at = rect.min + vec2(8.0, 6.0 + i as f32 * 17.0);
        clip.text(at, Align2::LEFT_TOP, line, FontId::proportional(if i == 0 { 13.0 } else { 11.0 }), ink);
    }
    if let Some(times) = pass.and_then(|pass| side.times.get(pass)) {
        let text = match (ran, times.mean()) {
            (true, Some(ms)) => format!("{ms:.2} ms"),
            (true, None) => String::new(),
            (false, _) => "kept".to_owned(),
        };
        clip.text(
            rect.right_bottom() - vec2(8.0, 6.0),
            Align2::RIGHT_BOTTOM,
            text,
            FontId::proportional(11.0),
            ink,
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_graph_can_be_read_at_first() {
        let view = vec2(600.0, 400.0);
        let scale = |seen: Rect| view.x / seen.width();
        // A small one is seen whole, and not blown up without end.
        let small = at_first(vec2(500.0, 300.0), view);
        assert!(small.expand(0.01).contains_rect(Rect::from_min_size(egui::Pos2::ZERO, vec2(500.0, 300.0))));
        assert!((1.0..=1.5).contains(&scale(at_first(vec2(50.0, 30.0), view))));
        // A large one from its beginning, at a scale at which text can be read.
        let large = at_first(vec2(4000.0, 200.0), view);
        assert_eq!((large.left(), large.center().y, scale(large)), (0.0, 100.0, READABLE));
    }

    #[test]
    fn the_middle_stays_where_it_is() {
        let seen = Rect::from_min_size(pos2(10.0, 20.0), vec2(100.0, 50.0));
        let larger = zoomed(seen, 2.0);
        assert_eq!((larger.center(), larger.width()), (seen.center(), 50.0));
    }
}
