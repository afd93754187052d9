//! The plan laid out in the plane: boxes in columns in the order of data, and the curves that join them.

use super::{Fate, PassId, Plan};
use crate::resource::human_bytes;
use data_file::Name;
use std::collections::BTreeMap;

const BOX_WIDTH: f32 = 190.0;
const BOX_HEIGHT: f32 = 62.0;
const COLUMN: f32 = 300.0;
const ROW: f32 = 96.0;
pub(super) const MARGIN: f32 = 40.0;
/// Height of the strip at the bottom for the summary.
const SUMMARY: f32 = 60.0;
/// Width of a character of the text, about.
pub(super) const CHARACTER: f32 = 6.4;

/// Height that a long edge takes where it passes a column, in rows.
const LANE: f32 = 0.3;

/// A plan as a drawing. Positions are in pixels from its upper left corner: x to the right, y down.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// Width and height, with a margin.
    pub size: (f32, f32),
    /// The boxes. None overlaps another.
    pub boxes: Vec<DrawnBox>,
    /// The links between them.
    pub edges: Vec<DrawnEdge>,
    /// Two lines about the whole plan: its id, the size of the frame and the number of passes; the memory. The lowest
    /// 60 pixels are free for them.
    pub summary: [String; 2],
}

/// A box of a [`Drawing`].
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnBox {
    /// What it stands for.
    pub kind: BoxKind,
    /// The name of the pass, or of the output.
    pub name: Name,
    /// The upper left corner.
    pub at: (f32, f32),
    /// Width and height.
    pub size: (f32, f32),
    /// The text in it: the name; the pass type, `culled`, `off` or `output`; bytes written, or why the
    /// pass does not run. Lines may be empty, or longer than the box is wide.
    pub lines: [String; 3],
    /// One sentence more: why the pass runs or does not, or where the output comes from.
    pub title: String,
}

/// What a box of a [`Drawing`] stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoxKind {
    /// A pass that runs.
    Pass(PassId),
    /// A pass that no output needs.
    Culled,
    /// A pass whose switch is off.
    Off,
    /// An output of the pipeline.
    Output,
}

/// An edge of a [`Drawing`]: a link, or what an output shows.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnEdge {
    /// Index into [`Drawing::boxes`]: the box that it leaves on the right.
    pub from: usize,
    /// Index into [`Drawing::boxes`]: the box that it enters on the left.
    pub to: usize,
    /// Whether it is a `prev` link: read in the frame after.
    pub past: bool,
    /// Where it begins.
    pub start: (f32, f32),
    /// Cubic Bézier segments, each from where the one before it ends: two control points and the end.
    pub curves: Vec<[(f32, f32); 3]>,
    /// The ports: `color`, `color → history`, or `past: color → history`; for an output, its interface.
    pub label: String,
    /// The place of the label on its baseline: the beginning of the text where `past` is set, else its end.
    pub label_at: (f32, f32),
}

/// One box, or the place where a long edge passes a column.
struct Tile {
    /// `None` for the place of an edge.
    kind: Option<BoxKind>,
    lines: [String; 3],
    title: String,
    column: usize,
    row: f32,
    /// In rows.
    height: f32,
}

struct Edge {
    from: usize,
    to: usize,
    /// The port of `from`: edges from one port leave it together.
    port: String,
    label: String,
    past: bool,
    /// The places where it passes columns.
    via: Vec<usize>,
}

impl Tile {
    fn new(kind: BoxKind, lines: [String; 3], title: String) -> Tile {
        Tile { kind: Some(kind), lines, title, column: 0, row: 0.0, height: 1.0 }
    }

    /// Returns the upper left corner.
    fn at(&self) -> (f32, f32) {
        (MARGIN + self.column as f32 * COLUMN, MARGIN + self.row * ROW)
    }
}

pub(super) fn drawing(plan: &Plan) -> Drawing {
    let (mut tiles, edges) = tiles(plan);
    arrange(&mut tiles, &edges);
    let columns = tiles.iter().map(|t| t.column + 1).max().unwrap_or(1) as f32;
    let rows = tiles.iter().map(|t| t.row + 1.0).fold(1.0, f32::max);
    let summary = [
        format!("plan {}   {}×{}   {} passes", plan.id, plan.frame.0, plan.frame.1, plan.passes.len()),
        plan.memory.to_string(),
    ];
    let widest =
        summary.iter().map(|line| line.chars().count()).max().unwrap_or(0) as f32 * (CHARACTER + 0.6);
    let width = (MARGIN * 2.0 + (columns - 1.0) * COLUMN + BOX_WIDTH).max(widest + MARGIN * 2.0);
    let height = MARGIN * 2.0 + rows * ROW + SUMMARY;
    let edges = curves(&tiles, &edges);
    // The places of long edges come after all boxes, so the indices of boxes stay.
    let boxes = tiles.into_iter().filter_map(|tile| {
        let (at, size) = (tile.at(), (BOX_WIDTH, BOX_HEIGHT));
        let name = Name::from(tile.lines[0].as_str());
        Some(DrawnBox { kind: tile.kind?, name, at, size, lines: tile.lines, title: tile.title })
    });
    Drawing { size: (width, height), boxes: boxes.collect(), edges, summary }
}

/// Boxes and edges: passes, outputs; and, by themselves, what does not run.
fn tiles(plan: &Plan) -> (Vec<Tile>, Vec<Edge>) {
    let mut tiles = Vec::new();
    let mut edges = Vec::new();
    for (i, pass) in plan.passes.iter().enumerate() {
        let fate = plan.fates.iter().find(|(name, _)| *name == pass.name).map(|(_, fate)| fate.to_string());
        let written = pass.outputs.iter().flat_map(|port| &port.members);
        let written: u64 = written.map(|(_, id)| plan.resources[id.0 as usize].desc.bytes()).sum();
        let hands = pass.outputs.iter().any(|port| !port.handed.is_empty());
        let holds = match (written, hands) {
            (0, true) => "hands on".to_owned(),
            (written, true) => format!("{}, hands on", human_bytes(written)),
            (written, false) => human_bytes(written),
        };
        let lines = [pass.name.to_string(), pass.kind.to_string(), holds];
        let title = fate.unwrap_or_default();
        tiles.push(Tile::new(BoxKind::Pass(PassId(i as u32)), lines, title));
    }
    for (to, pass) in plan.passes.iter().enumerate() {
        for link in plan.links(pass) {
            let from = link.producer.0 as usize;
            let port = link.port;
            let label = if port == *link.input { port.clone() } else { format!("{port} → {}", link.input) };
            edges.push(Edge { from, to, port, label, past: link.past, via: Vec::new() });
        }
    }
    for output in &plan.outputs {
        let Some(from) = plan.shown_by(output).map(|p| p.0 as usize) else { continue };
        let port =
            output.from.rsplit('/').next().and_then(|tail| tail.split('.').nth(1)).unwrap_or("").to_owned();
        let label = output.interface.to_string();
        edges.push(Edge { from, to: tiles.len(), port, label, past: false, via: Vec::new() });
        let lines = [output.name.to_string(), "output".to_owned(), String::new()];
        tiles.push(Tile::new(BoxKind::Output, lines, format!("from {}", output.from)));
    }
    for edge in edges.iter().filter(|edge| !edge.past) {
        // Producers come first in the order, so one sweep over edges by reader is enough.
        tiles[edge.to].column = tiles[edge.to].column.max(tiles[edge.from].column + 1);
    }
    for (name, fate) in &plan.fates {
        let (kind, word) = match fate {
            Fate::Kept { .. } => continue,
            Fate::Culled { .. } => (BoxKind::Culled, "culled"),
            Fate::Off { .. } => (BoxKind::Off, "off"),
        };
        let why = match fate {
            Fate::Off { why, .. } => why.clone(),
            Fate::Culled { readers } if readers.is_empty() => "nothing reads it".to_owned(),
            _ => "no output needs it".to_owned(),
        };
        let lines = [name.to_string(), word.to_owned(), why];
        tiles.push(Tile { column: usize::MAX, ..Tile::new(kind, lines, fate.to_string()) });
    }
    add_lanes(&mut tiles, &mut edges);
    (tiles, edges)
}

/// Gives long edges places in the columns that they pass, so that they run between boxes and not behind them.
/// Edges of one port share them.
fn add_lanes(tiles: &mut Vec<Tile>, edges: &mut [Edge]) {
    let mut lanes: BTreeMap<(usize, String, usize), usize> = BTreeMap::new();
    for edge in edges.iter_mut().filter(|edge| !edge.past) {
        for column in tiles[edge.from].column + 1..tiles[edge.to].column {
            let lane = *lanes.entry((edge.from, edge.port.clone(), column)).or_insert_with(|| {
                let (lines, title) = Default::default();
                tiles.push(Tile { kind: None, lines, title, column, row: 0.0, height: LANE });
                tiles.len() - 1
            });
            edge.via.push(lane);
        }
    }
}

/// Rows within each column, near the rows of what is read; what does not run comes below in rows of its own.
fn arrange(tiles: &mut [Tile], edges: &[Edge]) {
    let columns = tiles.iter().filter(|t| t.column != usize::MAX).map(|t| t.column + 1).max().unwrap_or(1);
    // What comes before each tile on the edges that lead to it.
    let mut before: Vec<Vec<usize>> = vec![Vec::new(); tiles.len()];
    for edge in edges.iter().filter(|edge| !edge.past) {
        let mut from = edge.from;
        for at in edge.via.iter().copied().chain([edge.to]) {
            before[at].push(from);
            from = at;
        }
    }
    let mut bottom = 0.0f32;
    for column in 0..columns {
        let mut inside: Vec<(f32, usize)> = Vec::new();
        for (i, _) in tiles.iter().enumerate().filter(|(_, t)| t.column == column) {
            let middle = |at: &usize| tiles[*at].row + tiles[*at].height / 2.0;
            let sum: f32 = before[i].iter().map(middle).sum();
            let count = before[i].len();
            inside.push((if count == 0 { 0.0 } else { sum / count as f32 - tiles[i].height / 2.0 }, i));
        }
        inside.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut next = 0.0;
        for (wanted, i) in inside {
            tiles[i].row = wanted.max(next);
            next = tiles[i].row + tiles[i].height;
            bottom = bottom.max(next);
        }
    }
    let across = columns.max(4);
    for (at, tile) in tiles.iter_mut().filter(|t| t.column == usize::MAX).enumerate() {
        tile.column = at % across;
        tile.row = bottom + 0.5 + (at / across) as f32;
    }
}

/// Returns the edges from box to box, by the columns that they pass.
fn curves(tiles: &[Tile], edges: &[Edge]) -> Vec<DrawnEdge> {
    // Edges arrive at heights of their own, and leave by ports.
    let slot = |mine: usize, of: usize| BOX_HEIGHT * (mine as f32 + 1.0) / (of as f32 + 1.0);
    let mut ports: BTreeMap<usize, Vec<(&str, bool)>> = BTreeMap::new();
    let mut arrivals: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (i, edge) in edges.iter().enumerate() {
        let from = ports.entry(edge.from).or_default();
        if !from.contains(&(&edge.port, edge.past)) {
            from.push((&edge.port, edge.past));
        }
        arrivals.entry(edge.to).or_default().push(i);
    }
    let drawn = |(i, edge): (usize, &Edge)| {
        let (from, to) = (&ports[&edge.from], &arrivals[&edge.to]);
        let leaves = from.iter().position(|port| *port == (edge.port.as_str(), edge.past)).unwrap_or(0);
        let arrives = to.iter().position(|other| *other == i).unwrap_or(0);
        let ((x0, y0), (x1, y1)) = (tiles[edge.from].at(), tiles[edge.to].at());
        let (x0, y0, y1) = (x0 + BOX_WIDTH, y0 + slot(leaves, from.len()), y1 + slot(arrives, to.len()));
        // The past goes back around below the boxes.
        let bend = if edge.past { BOX_HEIGHT * 1.4 } else { 0.0 };
        let mut curves = Vec::new();
        let mut curve = |x: f32, y: f32, to_x: f32, to_y: f32| {
            let reach = ((to_x - x).abs() / 2.0).max(40.0);
            curves.push([(x + reach, y + bend), (to_x - reach, to_y + bend), (to_x, to_y)]);
        };
        let (mut x, mut y) = (x0, y0);
        for lane in &edge.via {
            let (lane_x, lane_y) = tiles[*lane].at();
            let lane_y = lane_y + LANE * ROW / 2.0 - (ROW - BOX_HEIGHT) / 2.0;
            curve(x, y, lane_x, lane_y);
            curve(lane_x, lane_y, lane_x + BOX_WIDTH, lane_y);
            (x, y) = (lane_x + BOX_WIDTH, lane_y);
        }
        curve(x, y, x1, y1);
        let label = if edge.past { format!("past: {}", edge.label) } else { edge.label.clone() };
        let label_at = if edge.past { (x0 + 6.0, y0 + bend * 0.6) } else { (x1 - 10.0, y1 - 3.0) };
        let (from, to, past) = (edge.from, edge.to, edge.past);
        DrawnEdge { from, to, past, start: (x0, y0), curves, label, label_at }
    };
    edges.iter().enumerate().map(drawn).collect()
}
