//! The graph of passes, drawn with what ran and what did not.

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

/// The scale of the drawing at first.
const READABLE: f32 = 0.6;

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

/// The state of the panel.
pub(crate) struct Graph {
    side: SideId,
    drawing: Option<(PlanId, Drawing)>,
    seen: Rect,
}

impl Default for Graph {
    fn default() -> Graph {
        Graph { side: SideId::A, drawing: None, seen: Rect::ZERO }
    }
}

pub(crate) fn show(app: &mut App, ui: &mut Ui) {
    let sides: Vec<SideId> = app.now.sides.iter().map(|(id, _)| *id).collect();
    if !sides.contains(&app.graph.side) {
        app.graph.side = SideId::A;
    }
    let mut whole = false;
    ui.horizontal_wrapped(|ui| {
        choose_side(ui, &sides, &mut app.graph.side);
        whole = ui.button("Whole graph").clicked();
        ui.weak("Ctrl-wheel: zoom; wheel, drag: move; click: look");
    });
    let Some(side) = app.now.side(app.graph.side).cloned() else { return };
    if app.graph.drawing.as_ref().is_none_or(|(id, _)| *id != side.plan.id) {
        let fits = app
            .graph
            .drawing
            .as_ref()
            .is_some_and(|(_, old)| old.boxes.len() == side.plan.drawing().boxes.len());
        app.graph.drawing = Some((side.plan.id, side.plan.drawing()));
        if !fits {
            app.graph.seen = Rect::ZERO;
        }
    }
    let Some((_, drawing)) = app.graph.drawing.clone() else { return };
    ui.weak(&drawing.summary[1]);
    if whole {
        app.graph.seen = Rect::from_min_size(egui::Pos2::ZERO, Vec2::from(drawing.size));
    } else if app.graph.seen == Rect::ZERO {
        // As large as it can be read, from where the frame begins.
        app.graph.seen = Rect::from_min_size(egui::Pos2::ZERO, ui.available_size() / READABLE);
    }
    let mut clicked = None;
    let mut seen = app.graph.seen;
    Scene::new().zoom_range(0.05..=3.0).show(ui, &mut seen, |ui| {
        let (_, area) = ui.allocate_space(Vec2::from(drawing.size));
        let origin = area.min;
        let painter = ui.painter().clone();
        edges(&painter, &drawing, origin.to_vec2(), ui.visuals().weak_text_color());
        for (i, drawn) in drawing.boxes.iter().enumerate() {
            let rect = Rect::from_min_size(origin + Vec2::from(drawn.at), Vec2::from(drawn.size));
            let response = ui.interact(rect, ui.scope_id().with(i), Sense::click());
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, drawn.name.as_str()));
            let hot = response.hovered() || response.has_focus();
            one_box(&painter, drawn, &side, rect, (hot, ui.visuals().dark_mode));
            if response.on_hover_text(&drawn.title).clicked() {
                clicked = Some((drawn.kind, drawn.name.to_string()));
            }
        }
    });
    app.graph.seen = seen;
    if let Some((kind, name)) = clicked
        && matches!(kind, BoxKind::Pass(_) | BoxKind::Output)
    {
        app.inspector.choose(app.graph.side, &name);
        app.remembered.tab = Tab::Look;
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
        painter.text(at, align, &edge.label, FontId::proportional(9.0), color);
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
