//! The picture in the middle: one pipeline or two, with handles over it.

mod errors;
mod handles;
mod lights;

use crate::action::View;
use crate::app::App;
use crate::camera;
use crate::engine::{Command, SideId};
use crate::textures::Shown;
use eframe::egui::{
    self, Align2, Color32, CursorIcon, FontId, Key, PointerButton, Pos2, Rect, Response, Sense, Stroke, Ui,
    Vec2, pos2, vec2,
};
use glam::Vec3;
use scene::Camera;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How long the window keeps its size before frames take it.
const SETTLED: Duration = Duration::from_millis(150);

/// How long the newest message is shown.
const NEWS: Duration = Duration::from_secs(8);

/// Radians per point of the screen that the mouse is dragged.
const TURN: f32 = 0.005;

/// The whole of a texture.
pub(crate) const WHOLE: Rect = Rect { min: Pos2::ZERO, max: pos2(1.0, 1.0) };

/// The size that frames are to have, in pixels, once the window rests.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FrameSize {
    wanted: (u32, u32),
    since: Option<Instant>,
    /// What the engine was asked for last; zeros before.
    pub(crate) sent: (u32, u32),
    /// The size that was left with the engine for the next command that moves something.
    left: Option<(u32, u32)>,
}

/// Where a picture is on the screen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    /// The picture.
    pub(crate) rect: Rect,
    /// The size of its frame in pixels.
    pub(crate) size: [u32; 2],
}

impl Placed {
    /// Returns where a point of the scene is on the screen; `None` behind the camera.
    pub(crate) fn project(&self, camera: &Camera, point: Vec3) -> Option<Pos2> {
        let px = camera.project(point, self.size)?;
        let size = self.rect.size();
        Some(self.rect.min + vec2(px.x / self.size[0] as f32 * size.x, px.y / self.size[1] as f32 * size.y))
    }

    /// Returns the ray of a point of the screen: origin and direction.
    pub(crate) fn ray(&self, camera: &Camera, at: Pos2) -> (Vec3, Vec3) {
        let share = (at - self.rect.min) / self.rect.size();
        camera.ray(
            glam::Vec2::new(share.x * 2.0 - 1.0, 1.0 - share.y * 2.0),
            self.size[0] as f32 / self.size[1] as f32,
        )
    }
}

/// Draws the pictures and takes input over them.
pub(crate) fn show(app: &mut App, ui: &mut Ui) {
    let rect = ui.available_rect_before_wrap();
    let view = if app.now.sides.len() > 1 { app.remembered.view } else { View::One };
    let places = match view {
        View::Beside => {
            let (left, right) = rect.split_left_right_at_fraction(0.5);
            vec![(other_of(app, SideId::A), left.with_max_x(left.max.x - 1.0)), (second(app), right)]
        }
        _ => vec![(SideId::A, rect)],
    };
    ask_for_size(app, ui, places[0].1);
    ui.painter().rect_filled(rect, 0.0, Color32::from_gray(16));
    let response = ui.interact(
        rect,
        ui.scope_id().with("picture"),
        Sense::click_and_drag() | Sense::focusable_noninteractive(),
    );
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Picture"));
    let placed: Vec<Placed> =
        places.into_iter().filter_map(|(side, place)| draw(app, ui, side, place, view)).collect();
    let Some(first) = placed.first().copied() else {
        wait(app, ui, rect);
        errors::show(app, ui, rect);
        return;
    };
    if view == View::Split {
        split(app, ui, first.rect);
    }
    let Some(seen) = app.now.camera else { return };
    let camera = app.pilot.camera().unwrap_or(seen);
    let mut over_handle = false;
    for (number, placed) in placed.iter().enumerate() {
        if app.virtual_lights {
            lights::show(app, ui, *placed, &camera);
        }
        let handles = app.remembered.handles && app.snapshots.shown().is_none();
        over_handle |= handles && handles::show(app, ui, number, *placed, &camera);
    }
    let pointer = response.hover_pos().or(response.interact_pointer_pos());
    let under = pointer.and_then(|at| placed.iter().find(|placed| placed.rect.contains(at)));
    let by_mouse = Some(&response).filter(|_| !over_handle);
    fly(app, ui, by_mouse, under.copied().unwrap_or(first), camera);
    if app.now.playing && app.pilot.camera().is_some() {
        let at = rect.left_bottom() - vec2(0.0, 74.0);
        label(&ui.painter_at(rect), at, "This is your camera; C gives it back to the scene");
    }
    if app.pilot.go_on(&app.engine) {
        ui.ctx().request_repaint();
    }
    news(app, ui, rect);
    errors::show(app, ui, rect);
}

/// Shows the first line of the newest message, or the key that was pressed since, while it is new, over the picture: a line of its
/// own would change the size of frames.
fn news(app: &App, ui: &Ui, rect: Rect) {
    let message = app.now.messages.back().map(|message| {
        let line = message.text.lines().find(|line| !line.trim().is_empty());
        (message.time, line.unwrap_or_default())
    });
    let pressed = app.pressed.as_ref().map(|(time, line)| (*time, line.as_str()));
    let newest = message.into_iter().chain(pressed).max_by_key(|(time, _)| *time);
    let newest = newest.filter(|(time, _)| time.elapsed() < NEWS && !app.bare);
    let Some((_, line)) = newest else { return };
    let (painter, margin) = (ui.painter_at(rect), vec2(9.0, 7.0));
    let width = (rect.width() - 2.0 * margin.x).max(1.0);
    let galley = painter.layout(line.to_owned(), FontId::proportional(13.0), Color32::WHITE, width);
    on_picture(&painter, rect.left_bottom() + vec2(margin.x, -margin.y - galley.size().y), galley);
    ui.ctx().request_repaint_after(NEWS);
}

/// A, except where the view flickers and B is its turn.
fn other_of(app: &App, side: SideId) -> SideId {
    if app.remembered.view == View::Flicker && app.flicked && side == SideId::A { second(app) } else { side }
}

/// What A is compared with on the screen.
fn second(app: &App) -> SideId {
    if app.now.side(SideId::B).is_some() { SideId::B } else { SideId::Reference }
}

/// Tells the engine the size of frames once the window rests.
fn ask_for_size(app: &mut App, ui: &Ui, rect: Rect) {
    if app.now.adapter.is_empty() {
        return;
    }
    let size_of = |scale: f32| {
        let side = |points: f32| ((points * scale * ui.pixels_per_point()).round() as u32).clamp(16, 8192);
        (side(rect.width()), side(rect.height()))
    };
    let size = size_of(app.resolution());
    let small = app.resolution_of_moves().map(size_of);
    let frame = &mut app.frame_size;
    let left = std::mem::replace(&mut *app.engine.small(), small);
    if let (Some(taken), None) = (std::mem::replace(&mut frame.left, small), left) {
        frame.sent = taken;
    }
    if frame.wanted != size {
        (frame.wanted, frame.since) = (size, Some(Instant::now()));
    }
    let rests = frame.sent == (0, 0) || frame.since.is_some_and(|since| since.elapsed() > SETTLED);
    if frame.sent != size {
        if rests {
            app.engine.send(Command::Size(size));
            frame.sent = size;
        } else {
            ui.ctx().request_repaint_after(SETTLED);
        }
    }
}

/// Draws the picture of a side, or of what differs; returns where.
fn draw(app: &mut App, ui: &Ui, side: SideId, place: Rect, view: View) -> Option<Placed> {
    let side = other_of(app, side);
    let shown = app.now.side(side)?;
    let (picture, version) = (shown.picture.clone()?, shown.version);
    let placed = fit(place, picture.size);
    let texture = app.textures.of(ui.ctx(), Shown::Side(side), version, &picture);
    let painter = ui.painter_at(place);
    let measured = app.now.measured.clone();
    let map = measured.as_ref().and_then(|measured| Some((measured.version, measured.map.as_ref()?)));
    match (view, map) {
        (View::Difference | View::Flip, Some((version, (a, b, map)))) => {
            let texture = app.textures.of(ui.ctx(), Shown::Map, version, map);
            painter.image(texture.id(), placed.rect, WHOLE, Color32::WHITE);
            let gain = match view {
                View::Difference => format!(", times {:.1}", app.remembered.gain),
                _ => String::new(),
            };
            label(
                &painter,
                place.left_top(),
                &format!("{}: {} and {}{gain}", view.name(), a.name(), b.name()),
            );
        }
        (View::Difference | View::Flip, None) => {
            label(&painter, place.left_top(), "comparing…");
        }
        (View::Split, _) => {
            let at = placed.rect.left() + placed.rect.width() * app.remembered.split;
            let (left, right) = placed.rect.split_left_right_at_x(at);
            painter.with_clip_rect(left).image(texture.id(), placed.rect, WHOLE, Color32::WHITE);
            let other = second(app);
            if let Some(shown) = app.now.side(other)
                && let Some(picture) = shown.picture.clone()
            {
                let (version, name) = (shown.version, format!("{}: {}", other.name(), shown.name));
                let texture = app.textures.of(ui.ctx(), Shown::Side(other), version, &picture);
                painter.with_clip_rect(right).image(texture.id(), placed.rect, WHOLE, Color32::WHITE);
                label(&painter.with_clip_rect(right), right.left_top(), &name);
            }
        }
        _ => {
            painter.image(texture.id(), placed.rect, WHOLE, Color32::WHITE);
        }
    }
    if let Some(snapshot) = app.snapshots.shown().filter(|_| side == SideId::A).cloned() {
        let texture = app.textures.of(ui.ctx(), Shown::Snapshot, snapshot.id, &snapshot.picture);
        let rect = fit(place, snapshot.picture.size).rect;
        painter.rect_filled(place, 0.0, Color32::from_gray(16));
        painter.image(texture.id(), rect, WHOLE, Color32::WHITE);
        label(&painter, place.left_top(), &format!("Snapshot {}; G shows what is rendered", snapshot.name));
    } else if app.now.sides.len() > 1 && !matches!(view, View::Difference | View::Flip) {
        let name =
            app.now.side(side).map_or(String::new(), |shown| format!("{}: {}", side.name(), shown.name));
        label(&painter, place.left_top(), &name);
    }
    if app.inspector.over_picture {
        app.inspector.draw_over(&mut app.textures, ui, placed.rect);
    }
    Some(placed)
}

/// The largest place of a picture within another, in its proportions.
fn fit(place: Rect, size: [usize; 2]) -> Placed {
    let picture = vec2(size[0] as f32, size[1] as f32);
    let scale = (place.size() / picture).min_elem();
    let rect = Rect::from_center_size(place.center(), picture * scale);
    Placed { rect, size: [size[0] as u32, size[1] as u32] }
}

/// A line in a corner, readable over any picture.
fn label(painter: &egui::Painter, at: Pos2, text: &str) {
    let galley = painter.layout_no_wrap(text.to_owned(), FontId::proportional(13.0), Color32::WHITE);
    on_picture(painter, at + vec2(6.0, 4.0), galley);
}

/// Text on a ground that makes it readable over any picture.
fn on_picture(painter: &egui::Painter, at: Pos2, galley: Arc<egui::Galley>) {
    let ground = Rect::from_min_size(at, galley.size()).expand(3.0);
    painter.rect_filled(ground, 3.0, Color32::from_black_alpha(160));
    painter.galley(at, galley, Color32::WHITE);
}

/// What is shown before there is a picture.
fn wait(app: &App, ui: &Ui, rect: Rect) {
    let text = match (&app.now.fatal, &app.now.stage) {
        // The error is shown over this.
        (Some(_), _) => String::new(),
        (None, Some(stage)) => stage.describe(),
        (None, None) if app.now.troubles.is_empty() => "Starting…".to_owned(),
        (None, None) => String::new(),
    };
    let color = ui.visuals().strong_text_color();
    ui.painter().text(rect.center(), Align2::CENTER_CENTER, text, FontId::proportional(16.0), color);
}

/// The line between A and B, which can be dragged, or moved by the arrow keys once it has the focus.
fn split(app: &mut App, ui: &mut Ui, rect: Rect) {
    let x = rect.left() + rect.width() * app.remembered.split;
    let line = Rect::from_center_size(pos2(x, rect.center().y), vec2(14.0, rect.height()));
    let response = ui.interact(line, ui.scope_id().with("split"), Sense::click_and_drag());
    let share = app.remembered.split;
    response.widget_info(|| egui::WidgetInfo::slider(true, f64::from(share), "Split between A and B"));
    let mut share = share + response.drag_delta().x / rect.width().max(1.0);
    if response.has_focus() {
        let step = |input: &mut egui::InputState| {
            f32::from(input.key_pressed(Key::ArrowRight)) - f32::from(input.key_pressed(Key::ArrowLeft))
        };
        share += 0.02 * ui.input_mut(step);
    }
    app.remembered.split = share.clamp(0.0, 1.0);
    let hot = response.hovered() || response.dragged() || response.has_focus();
    let width = if hot { 3.0 } else { 1.5 };
    ui.painter().vline(x, rect.y_range(), Stroke::new(width, Color32::WHITE));
    response.on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal);
}

/// Moves the camera by keys, and by the mouse where that is over the picture itself.
fn fly(app: &mut App, ui: &Ui, response: Option<&Response>, placed: Placed, before: Camera) {
    let moved = match response {
        Some(response) => by_mouse(app, ui, response, placed, before),
        None => Some(before),
    };
    let Some(camera) = moved.map(|camera| by_keys(app, ui, camera)) else { return };
    if camera != before {
        app.pilot.take(&app.engine, camera, false);
        ui.ctx().request_repaint();
    }
}

/// The camera as the mouse moves it; `None` where it flies to a point from now on.
fn by_mouse(app: &mut App, ui: &Ui, response: &Response, placed: Placed, before: Camera) -> Option<Camera> {
    let mut camera = before;
    let delta = response.drag_delta();
    let moved = delta != Vec2::ZERO;
    if response.dragged_by(PointerButton::Secondary) && moved {
        camera = camera::look(&camera, delta.x * TURN, delta.y * TURN);
    } else if response.dragged_by(PointerButton::Primary) && moved {
        camera = camera::orbit(&camera, delta.x * TURN, delta.y * TURN);
    } else if response.dragged_by(PointerButton::Middle) && moved {
        let metres = camera::metres_per_pixel(&camera, camera.target, placed.rect.height());
        camera = camera::fly(&camera, Vec3::new(-delta.x, delta.y, 0.0) * metres);
    }
    if response.drag_started() && response.dragged_by(PointerButton::Primary) {
        camera = orbit_around_what_is_seen(app, placed, camera);
    }
    if response.hovered() {
        let wheel = ui.input(|input| input.smooth_scroll_delta.y);
        if wheel != 0.0 {
            camera = camera::approach(&camera, 1.0 - (-wheel * 0.004).exp());
        }
    }
    if response.double_clicked()
        && let Some(at) = response.interact_pointer_pos()
    {
        let (origin, direction) = placed.ray(&camera, at);
        if let Some(hit) = pick(app, origin, direction) {
            app.pilot.fly_to(before, camera::go_to(&camera, hit));
            ui.ctx().request_repaint();
            return None;
        }
    }
    Some(camera)
}

/// The same view, with the target where the middle of the picture meets the scene: that is what is orbited.
fn orbit_around_what_is_seen(app: &App, placed: Placed, camera: Camera) -> Camera {
    let (origin, direction) = placed.ray(&camera, placed.rect.center());
    pick(app, origin, direction).map_or(camera, |target| Camera { target, ..camera })
}

/// What a ray meets first, as the scene is now.
fn pick(app: &App, origin: Vec3, direction: Vec3) -> Option<Vec3> {
    let scene = &app.now.scene.as_ref()?.scene;
    scene.pick(&scene.at(app.now.time), origin, direction).map(|hit| hit.position)
}

fn by_keys(app: &App, ui: &Ui, camera: Camera) -> Camera {
    if ui.memory(|memory| memory.focused().is_some()) || app.asks() {
        return camera;
    }
    let by = ui.input(|input| {
        if input.modifiers.command || input.modifiers.ctrl {
            return Vec3::ZERO;
        }
        let faster = if input.modifiers.shift { 4.0 } else { 1.0 };
        let slower = if input.modifiers.alt { 0.25 } else { 1.0 };
        app.pilot.directions() * faster * slower * input.stable_dt.min(0.1)
    });
    if by == Vec3::ZERO {
        return camera;
    }
    let extent = app.now.scene.as_ref().map_or(1.0, |scene| {
        let (min, max) = scene.scene.bounds();
        (max - min).length()
    });
    // From one end of the scene to the other in five seconds.
    camera::fly(&camera, by * extent * 0.2)
}
