//! The content of a resource: as a picture or as a table.

mod colors;
mod histogram;
mod table;

use crate::app::App;
use crate::edits::counted;
use crate::engine::{Look, Looked, Published, SideId};
use crate::panel::{choose_side, labelled};
use crate::textures::{Shown, Textures};
use crate::viewport::WHOLE;
use colors::{Channel, Coloring, Palette};
use eframe::egui::{
    self, Color32, ComboBox, DragValue, Pos2, Rect, ScrollArea, Sense, Slider, Ui, pos2, vec2,
};
use frame_graph::plan::Fate;
use frame_graph::{Plan, ResourceDesc};
use histogram::Histogram;
use std::sync::Arc;

/// The resource that is shown, and its presentation.
pub(crate) struct Inspector {
    side: SideId,
    name: String,
    layer: u32,
    /// Whether it is drawn over the picture in the middle.
    pub(crate) over_picture: bool,
    opacity: f32,
    coloring: Coloring,
    /// Side of a tile of an atlas in pixels; 0 for the whole texture.
    tile: u32,
    /// Index of the tile.
    index: u32,
    /// The picture that is shown, with its frame, resource, coloring and version.
    shown: Option<(u64, String, Coloring, u64, Arc<egui::ColorImage>)>,
    /// The counts of its values, with its version.
    histogram: Option<(u64, Histogram)>,
    versions: u64,
    seen: Rect,
    first_row: usize,
}

impl Default for Inspector {
    fn default() -> Inspector {
        Inspector {
            side: SideId::A,
            name: "image".to_owned(),
            layer: 0,
            over_picture: false,
            opacity: 0.7,
            coloring: Coloring::default(),
            tile: 0,
            index: 0,
            shown: None,
            histogram: None,
            versions: 0,
            seen: Rect::NOTHING,
            first_row: 0,
        }
    }
}

/// Returns the names that a plan can show: its outputs, then all resources in the order of passes, then the passes that
/// run only on request.
fn names(plan: &Plan) -> Vec<String> {
    let outputs = plan.outputs.iter().map(|output| output.name.to_string());
    let made = plan.passes.iter().flat_map(|pass| pass.outputs.iter().flat_map(|port| &port.members));
    let made = made.map(|(_, id)| plan.resources[id.0 as usize].name.to_string());
    let culled = plan.fates.iter().filter(|(_, fate)| matches!(fate, Fate::Culled { .. }));
    let culled = culled.map(|(name, _)| name.to_string());
    let mut all: Vec<String> = outputs.chain(made).chain(culled).collect();
    let mut known = std::collections::HashSet::new();
    all.retain(|name| known.insert(name.clone()));
    all
}

impl Inspector {
    /// Looks at an output, a resource, or the first resource of a pass.
    pub(crate) fn choose(&mut self, side: SideId, name: &str) {
        (self.side, self.layer, self.first_row) = (side, 0, 0);
        (self.tile, self.index) = (0, 0);
        name.clone_into(&mut self.name);
        self.seen = Rect::NOTHING;
    }

    /// Returns the resource that the engine is to read.
    pub(crate) fn wanted(&self, now: &Published) -> Option<Look> {
        now.side(self.side)?;
        Some(Look { side: self.side, name: self.name.clone(), layer: self.layer })
    }

    /// The picture as it is colored, with its version.
    fn picture(&mut self, looked: &Looked) -> Option<(u64, Arc<egui::ColorImage>)> {
        let image = looked.picture.as_ref()?;
        let same = |shown: &&(u64, String, Coloring, u64, Arc<egui::ColorImage>)| {
            shown.0 == looked.frame
                && shown.1 == looked.resource
                && shown.2 == self.coloring
                && shown.4.size == [image.width(), image.height()]
        };
        if self.shown.as_ref().filter(same).is_none() {
            self.versions += 1;
            let colored = Arc::new(self.coloring.apply(image));
            self.shown = Some((looked.frame, looked.resource.clone(), self.coloring, self.versions, colored));
        }
        self.shown.as_ref().map(|(.., version, picture)| (*version, Arc::clone(picture)))
    }

    /// Draws what is looked at over the picture.
    pub(crate) fn draw_over(&mut self, textures: &mut Textures, ui: &Ui, rect: Rect) {
        let Some((_, _, _, version, picture)) = &self.shown else { return };
        let texture = textures.of(ui.ctx(), Shown::Looked, *version, picture);
        let tint = Color32::WHITE.gamma_multiply(self.opacity);
        ui.painter_at(rect).image(texture.id(), rect, WHOLE, tint);
    }
}

pub(crate) fn show(app: &mut App, ui: &mut Ui) {
    let sides: Vec<SideId> = app.now.sides.iter().map(|(id, _)| *id).collect();
    if !sides.contains(&app.inspector.side) {
        app.inspector.side = SideId::A;
    }
    let Some(side) = app.now.side(app.inspector.side).cloned() else { return };
    ui.horizontal_wrapped(|ui| {
        choose_side(ui, &sides, &mut app.inspector.side);
        let mut name = app.inspector.name.clone();
        labelled(ui, "Resource", |ui| {
            let list = ComboBox::from_id_salt("resource").selected_text(&name).height(500.0);
            let list = list.width((ui.available_width() - 20.0).clamp(80.0, 260.0)).truncate();
            let list = list.show_ui(ui, |ui| {
                ui.set_min_width(300.0);
                for known in names(&side.plan) {
                    ui.selectable_value(&mut name, known.clone(), known);
                }
            });
            list.response
        });
        if name != app.inspector.name {
            let side = app.inspector.side;
            app.inspector.choose(side, &name);
        }
    });
    presets(app, ui, &side.plan);
    if let Some(error) = &app.now.look_error {
        ui.colored_label(ui.visuals().error_fg_color, error);
    }
    let Some(looked) = app.now.looked.clone().filter(|looked| looked.look.name == app.inspector.name) else {
        ui.weak("Reading…");
        return;
    };
    ui.weak(format!("{}: {}", looked.resource, describe(&looked.desc)));
    match &looked.desc {
        ResourceDesc::Buffer(_) => {
            table::show(ui, &side, &looked, &mut app.inspector.first_row);
        }
        ResourceDesc::Texture(texture) => {
            if texture.layers > 1 {
                let layer = Slider::new(&mut app.inspector.layer, 0..=texture.layers - 1);
                ui.horizontal(|ui| labelled(ui, "Layer", |ui| ui.add(layer)));
            }
            controls(&mut app.inspector, ui, texture.size);
            texture_picture(app, ui, &looked);
        }
    }
}

/// Buttons for what is looked at most, as far as the plan has it.
fn presets(app: &mut App, ui: &mut Ui, plan: &Plan) {
    let of_interface = |name: &str| {
        let ports = plan.passes.iter().rev().flat_map(|pass| &pass.outputs);
        let port =
            ports.filter(|port| port.interface.as_str() == name).find(|port| !port.members.is_empty())?;
        let (_, id) = port.members.first()?;
        Some(plan.resources[id.0 as usize].name.to_string())
    };
    let output = |name: &str| {
        let known = plan.output(name).is_some() || plan.fates.iter().any(|(pass, _)| pass == name);
        known.then(|| name.to_owned())
    };
    let lights = of_interface("VirtualLights");
    let all: [(&str, &str, Option<String>, Channel); 6] = [
        (
            "importance",
            "What each texel of the light's view brings to the picture",
            of_interface("Importance"),
            Channel::Red,
        ),
        ("clusters", "The cells of clusters over the picture", output("cells"), Channel::Rgb),
        (
            "placement",
            "Where virtual lights were placed in the light's view",
            output("placement"),
            Channel::Rgb,
        ),
        ("clamped", "The irradiance that clamping removed", output("irradiance"), Channel::Alpha),
        ("points", "The points that SMC-IR draws lights from", of_interface("SurfacePoints"), Channel::Rgb),
        ("lights", "The virtual lights as a table", lights, Channel::Rgb),
    ];
    ui.horizontal_wrapped(|ui| {
        for (name, about, resource, channel) in all {
            let Some(resource) = resource else { continue };
            if ui.small_button(name).on_hover_text(about).clicked() {
                let side = app.inspector.side;
                app.inspector.choose(side, &resource);
                app.inspector.coloring.channel = channel;
                app.inspector.coloring.auto = channel != Channel::Rgb;
            }
        }
    });
}

/// Describes a resource in a line: format, size and bytes.
pub(crate) fn describe(desc: &ResourceDesc) -> String {
    match desc {
        ResourceDesc::Texture(texture) => format!(
            "{} {}×{}×{}, {}",
            texture.format.name(),
            texture.size.0,
            texture.size.1,
            texture.layers,
            frame_graph::human_bytes(desc.bytes())
        ),
        ResourceDesc::Buffer(_) => format!("buffer, {}", frame_graph::human_bytes(desc.bytes())),
    }
}

fn controls(inspector: &mut Inspector, ui: &mut Ui, size: (u32, u32)) {
    let coloring = &mut inspector.coloring;
    ui.horizontal_wrapped(|ui| {
        labelled(ui, "Channel", |ui| {
            let list = ComboBox::from_id_salt("channel").selected_text(coloring.channel.name()).width(70.0);
            let list = list.show_ui(ui, |ui| {
                for channel in Channel::ALL {
                    ui.selectable_value(&mut coloring.channel, *channel, channel.name());
                }
            });
            list.response
        });
        labelled(ui, "Colors", |ui| {
            let list = ComboBox::from_id_salt("colors").selected_text(coloring.palette.name()).width(80.0);
            let list = list.show_ui(ui, |ui| {
                for palette in Palette::ALL {
                    ui.selectable_value(&mut coloring.palette, *palette, palette.name());
                }
            });
            list.response
        });
        ui.checkbox(&mut coloring.auto, "Fit range").on_hover_text("From the least to the greatest value");
    });
    // Sliders do not wrap with others in a row.
    if !coloring.auto {
        let exposure = Slider::new(&mut coloring.exposure, -16.0..=16.0).suffix(" EV");
        ui.horizontal(|ui| labelled(ui, "Exposure", |ui| ui.add(exposure)));
    }
    if inspector.over_picture {
        let opacity = Slider::new(&mut inspector.opacity, 0.0..=1.0);
        ui.horizontal(|ui| labelled(ui, "Opacity", |ui| ui.add(opacity)));
    }
    ui.horizontal_wrapped(|ui| {
        ui.checkbox(&mut inspector.over_picture, "Over the picture");
        let most = size.0.min(size.1);
        let tile = DragValue::new(&mut inspector.tile).range(0..=most).suffix(" px");
        let response = labelled(ui, "Tile", |ui| ui.add(tile));
        if response.on_hover_text("Side of a tile of an atlas; 0 shows the whole").changed() {
            inspector.seen = Rect::NOTHING;
        }
        let across = |side: u32| side.checked_div(inspector.tile).map(|tiles| tiles.max(1));
        if let Some(tiles) = across(size.0).zip(across(size.1)).map(|(x, y)| x * y)
            && labelled(ui, "Number", |ui| ui.add(DragValue::new(&mut inspector.index).range(0..=tiles - 1)))
                .changed()
        {
            inspector.seen = Rect::NOTHING;
        }
    });
}

/// The texture, with what is under the cursor in numbers.
fn texture_picture(app: &mut App, ui: &mut Ui, looked: &Looked) {
    let Some(image) = looked.picture.clone() else { return };
    let Some((version, picture)) = app.inspector.picture(looked) else { return };
    let size = vec2(image.width() as f32, image.height() as f32);
    if app.inspector.seen == Rect::NOTHING {
        app.inspector.seen = part(app.inspector.tile, app.inspector.index, size);
    }
    let texture = app.textures.of(ui.ctx(), Shown::Looked, version, &picture);
    let channel = app.inspector.coloring.channel;
    if app.inspector.histogram.as_ref().is_none_or(|(of, _)| *of != version) {
        app.inspector.histogram = Some((version, Histogram::of(&image, channel)));
    }
    let mut seen = app.inspector.seen;
    let mut under = String::new();
    let height = (ui.available_height() - 140.0).max(80.0);
    let room = vec2(ui.available_width(), height);
    ui.horizontal(|ui| {
        let scale = (room / seen.size()).min_elem();
        for (name, about, wanted) in SCALES {
            if ui.small_button(name).on_hover_text(about).clicked() {
                seen = match wanted {
                    Some(wanted) => Rect::from_center_size(seen.center(), room / wanted),
                    None => part(app.inspector.tile, app.inspector.index, size),
                };
            }
        }
        ui.weak(format!("{:.0} %", scale * 100.0)).on_hover_text("Ctrl-wheel: zoom; wheel, drag: move");
    });
    ui.allocate_ui(room, |ui| {
        egui::Scene::new().zoom_range(0.01..=64.0).show(ui, &mut seen, |ui| {
            let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
            ui.painter().image(texture.id(), rect, WHOLE, Color32::WHITE);
            if let Some(at) = response.hover_pos() {
                let texel = (at - rect.min).floor();
                let (x, y) = (texel.x.max(0.0) as usize, texel.y.max(0.0) as usize);
                if x < image.width() && y < image.height() {
                    let pixel = image.pixels()[y * image.width() + x];
                    under = format!("({x}, {y}): {}", pixel.map(|value| format!("{value:.6}")).join("  "));
                }
            }
        });
    });
    app.inspector.seen = seen;
    ui.monospace(if under.is_empty() { "Point at a texel for its value".to_owned() } else { under });
    if let Some((_, histogram)) = &app.inspector.histogram {
        histogram.show(ui);
        let not_finite = match histogram.not_finite {
            0 => String::new(),
            n => format!("; {} not finite", counted(n, "texel")),
        };
        let (least, greatest) = (histogram.least, histogram.greatest);
        ui.weak(format!("{}: {least:.4e} to {greatest:.4e}{not_finite}", channel.name()));
    }
}

/// Scales of a texture \[points per texel\], each with its name; `None` shows all of it.
const SCALES: [(&str, &str, Option<f32>); 4] = [
    ("Fit", "Shows all of it, or the tile", None),
    ("1:1", "A texel is a point of the screen", Some(1.0)),
    ("4:1", "A texel is four points wide", Some(4.0)),
    ("16:1", "A texel is sixteen points wide", Some(16.0)),
];

/// The part of a texture that is seen at first: all of it, or a tile.
fn part(tile: u32, index: u32, size: egui::Vec2) -> Rect {
    if tile == 0 {
        return Rect::from_min_size(Pos2::ZERO, size);
    }
    let across = (size.x as u32 / tile).max(1);
    let at = pos2((index % across * tile) as f32, (index / across * tile) as f32);
    Rect::from_min_size(at, egui::Vec2::splat(tile as f32))
}

/// A place to scroll in, for what is longer than the panel.
fn scroll(ui: &mut Ui, content: impl FnOnce(&mut Ui)) {
    ScrollArea::both().auto_shrink([false, false]).show(ui, content);
}
