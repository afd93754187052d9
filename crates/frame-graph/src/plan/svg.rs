//! The plan as a drawing.

use super::{Fate, Plan};
use crate::resource::{Clear, human_bytes};
use crate::xml::escape;
use std::collections::BTreeMap;
use std::fmt::Write as _;

const BOX_WIDTH: f32 = 190.0;
const BOX_HEIGHT: f32 = 62.0;
const COLUMN: f32 = 300.0;
const ROW: f32 = 96.0;
const MARGIN: f32 = 40.0;
/// Width of a character of the text, about.
const CHARACTER: f32 = 6.4;

const KEPT: &str = "#dcecf7";
const CULLED: &str = "#e8e8e8";
const OFF: &str = "#f7e3c0";
const OUTPUT: &str = "#d9f0d3";

/// Height that a long edge takes where it passes a column, in rows.
const LANE: f32 = 0.3;

/// One box, or the place where a long edge passes a column.
struct Tile {
    lines: [String; 3],
    title: String,
    fill: &'static str,
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
    fn new(lines: [String; 3], title: String, fill: &'static str) -> Tile {
        Tile { lines, title, fill, column: 0, row: 0.0, height: 1.0 }
    }
}

/// What fits into a box.
fn short(text: &str) -> String {
    let most = (BOX_WIDTH / CHARACTER) as usize - 2;
    if text.chars().count() <= most {
        return text.to_owned();
    }
    text.chars().take(most - 1).chain(['…']).collect()
}

pub(super) fn svg(plan: &Plan) -> String {
    let (mut tiles, edges) = tiles(plan);
    arrange(&mut tiles, &edges);
    draw(plan, &tiles, &edges)
}

/// Boxes and edges: passes, the constants in place of others, outputs; and, by themselves, what does not run.
fn tiles(plan: &Plan) -> (Vec<Tile>, Vec<Edge>) {
    let mut tiles = Vec::new();
    let mut edges = Vec::new();
    for pass in &plan.passes {
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
        tiles.push(Tile::new(lines, title, KEPT));
    }
    let mut constants = vec![None; plan.resources.len()];
    for (id, resource) in plan.constants() {
        constants[id.0 as usize] = Some(tiles.len());
        let value = resource.constant.unwrap_or(Clear::Zero).to_string();
        let lines = [resource.name.to_string(), value, human_bytes(resource.desc.bytes())];
        tiles.push(Tile::new(lines, "in place of a pass that is off".into(), OFF));
    }
    for (to, pass) in plan.passes.iter().enumerate() {
        for link in plan.links(pass) {
            let from = link.producer.map(|p| p.0 as usize).or(constants[link.constant.0 as usize]);
            let port = link.port;
            let label = if port == *link.input { port.clone() } else { format!("{port} → {}", link.input) };
            edges.extend(from.map(|from| Edge { from, to, port, label, past: link.past, via: Vec::new() }));
        }
    }
    for output in &plan.outputs {
        let Some((_, id)) = output.members.first() else { continue };
        let producer = plan.shown_by(output).map(|p| p.0 as usize);
        let Some(from) = producer.or(constants[id.0 as usize]) else { continue };
        let port =
            output.from.rsplit('/').next().and_then(|tail| tail.split('.').nth(1)).unwrap_or("").to_owned();
        let label = output.interface.to_string();
        edges.push(Edge { from, to: tiles.len(), port, label, past: false, via: Vec::new() });
        let lines = [output.name.to_string(), "output".to_owned(), String::new()];
        tiles.push(Tile::new(lines, format!("from {}", output.from), OUTPUT));
    }
    for edge in edges.iter().filter(|edge| !edge.past) {
        // Producers come first in the order, so one sweep over edges by reader is enough.
        tiles[edge.to].column = tiles[edge.to].column.max(tiles[edge.from].column + 1);
    }
    for (name, fate) in &plan.fates {
        let (fill, word) = match fate {
            Fate::Kept { .. } => continue,
            Fate::Culled { .. } => (CULLED, "culled"),
            Fate::Off { .. } => (OFF, "off"),
        };
        let why = match fate {
            Fate::Off { why, .. } => why.clone(),
            Fate::Culled { readers } if readers.is_empty() => "nothing reads it".to_owned(),
            _ => "no output needs it".to_owned(),
        };
        let lines = [name.to_string(), word.to_owned(), why];
        tiles.push(Tile { column: usize::MAX, ..Tile::new(lines, fate.to_string(), fill) });
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
                let lane = Tile::new(Default::default(), String::new(), "");
                tiles.push(Tile { column, height: LANE, ..lane });
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

fn draw(plan: &Plan, tiles: &[Tile], edges: &[Edge]) -> String {
    let columns = tiles.iter().map(|t| t.column + 1).max().unwrap_or(1) as f32;
    let rows = tiles.iter().map(|t| t.row + 1.0).fold(1.0, f32::max);
    let summary = [
        format!("plan {}   {}×{}   {} passes", plan.id, plan.frame.0, plan.frame.1, plan.passes.len()),
        plan.memory.to_string(),
    ];
    let widest =
        summary.iter().map(|line| line.chars().count()).max().unwrap_or(0) as f32 * (CHARACTER + 0.6);
    let width = (MARGIN * 2.0 + (columns - 1.0) * COLUMN + BOX_WIDTH).max(widest + MARGIN * 2.0);
    let height = MARGIN * 2.0 + rows * ROW + 60.0;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <defs><marker id=\"tip\" viewBox=\"0 0 8 8\" refX=\"8\" refY=\"4\" markerWidth=\"8\" markerHeight=\"8\" \
         orient=\"auto\"><path d=\"M0,0 L8,4 L0,8 z\" fill=\"#555\"/></marker></defs>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    let at = |tile: &Tile| (MARGIN + tile.column as f32 * COLUMN, MARGIN + tile.row * ROW);
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
    let mut labels = String::new();
    for (i, edge) in edges.iter().enumerate() {
        let (from, to) = (&ports[&edge.from], &arrivals[&edge.to]);
        let leaves = from.iter().position(|port| *port == (edge.port.as_str(), edge.past)).unwrap_or(0);
        let arrives = to.iter().position(|other| *other == i).unwrap_or(0);
        let ((x0, y0), (x1, y1)) = (at(&tiles[edge.from]), at(&tiles[edge.to]));
        let (x0, y0, y1) = (x0 + BOX_WIDTH, y0 + slot(leaves, from.len()), y1 + slot(arrives, to.len()));
        let dashes = if edge.past { " stroke-dasharray=\"5 4\"" } else { "" };
        // The past goes back around below the boxes.
        let bend = if edge.past { BOX_HEIGHT * 1.4 } else { 0.0 };
        let mut path = format!("M{x0:.1},{y0:.1}");
        let (mut x, mut y) = (x0, y0);
        let mut curve = |x: f32, y: f32, to_x: f32, to_y: f32| {
            let reach = ((to_x - x).abs() / 2.0).max(40.0);
            let (a, b) = ((x + reach, y + bend), (to_x - reach, to_y + bend));
            let _ = write!(path, " C{:.1},{:.1} {:.1},{:.1} {to_x:.1},{to_y:.1}", a.0, a.1, b.0, b.1);
        };
        for lane in &edge.via {
            let (lane_x, lane_y) = at(&tiles[*lane]);
            let lane_y = lane_y + LANE * ROW / 2.0 - (ROW - BOX_HEIGHT) / 2.0;
            curve(x, y, lane_x, lane_y);
            curve(lane_x, lane_y, lane_x + BOX_WIDTH, lane_y);
            (x, y) = (lane_x + BOX_WIDTH, lane_y);
        }
        curve(x, y, x1, y1);
        let _ = writeln!(
            out,
            "<path d=\"{path}\" fill=\"none\" stroke=\"#777\"{dashes} marker-end=\"url(#tip)\"/>"
        );
        let label = if edge.past { format!("past: {}", edge.label) } else { edge.label.clone() };
        let (x, anchor) = if edge.past { (x0 + 6.0, "start") } else { (x1 - 10.0, "end") };
        let y = if edge.past { y0 + bend * 0.6 } else { y1 - 3.0 };
        let _ = writeln!(
            labels,
            "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"10\" fill=\"#333\" text-anchor=\"{anchor}\" \
             paint-order=\"stroke\" stroke=\"white\" stroke-width=\"3\">{}</text>",
            escape(&label)
        );
    }
    for tile in tiles.iter().filter(|tile| !tile.fill.is_empty()) {
        let (x, y) = at(tile);
        let _ = writeln!(
            out,
            "<g><title>{}</title><rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{BOX_WIDTH}\" height=\"{BOX_HEIGHT}\" rx=\"4\" \
             fill=\"{}\" stroke=\"#555\"/>",
            escape(&tile.title),
            tile.fill
        );
        for (i, line) in tile.lines.iter().enumerate() {
            let weight = if i == 0 { " font-weight=\"bold\"" } else { " fill=\"#333\"" };
            let (x, y) = (x + 8.0, y + 19.0 + i as f32 * 17.0);
            let _ = writeln!(out, "<text x=\"{x:.1}\" y=\"{y:.1}\"{weight}>{}</text>", escape(&short(line)));
        }
        out.push_str("</g>\n");
    }
    out.push_str(&labels);
    for (i, line) in summary.iter().enumerate() {
        let y = height - 44.0 + i as f32 * 20.0;
        let _ = writeln!(out, "<text x=\"{MARGIN}\" y=\"{y:.1}\">{}</text>", escape(line));
    }
    out.push_str("</svg>\n");
    out
}
