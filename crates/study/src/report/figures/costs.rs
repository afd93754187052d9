//! Charts of costs: GPU time of each pass, and memory.

use super::{Figure, Kind, file};
use crate::Memory;
use crate::report::digest::{Digest, Row};
use frame_graph::human_bytes;
use report::{BarChart, BarRow, Ink, MOST_PARTS, Segment, number};

/// The greatest number of rows of a chart; further rows get their own chart.
const MOST_ROWS: usize = 32;

/// Returns charts of the GPU time of a scene's rows, by pass.
pub(super) fn passes(digest: &Digest<'_>, scene: usize) -> Vec<Figure> {
    let inks = Inks::new(digest);
    let rows: Vec<(BarRow, Vec<String>)> = digest
        .of_scene(scene)
        .filter_map(|row| {
            let passes = row.passes();
            let total: f64 = passes.iter().map(|(_, ms)| ms).sum();
            let segment = |(name, ms): &(String, f64)| Segment {
                ink: inks.of(name),
                value: ms.max(0.0),
                tip: format!(
                    "{name}: {} ms, {:.0} % of {}",
                    number::short(*ms, 3),
                    100.0 * ms / total,
                    digest.row_text(row)
                ),
            };
            let bars = vec![passes.iter().map(segment).collect()];
            let row = bar_row(digest, row, bars, format!("{} ms", number::short(total, 3)));
            (total > 0.0).then(|| (row, passes.into_iter().map(|(name, _)| name).collect()))
        })
        .collect();
    let name = digest.scenes[scene];
    charts(rows, |rows, used, choice, part| {
        let about = format!("GPU time of each pass, {name}");
        let chart = BarChart {
            title: "GPU time [ms]".to_owned(),
            legend: inks.legend(&used),
            about: about.clone(),
            rows,
        };
        Figure {
            kind: Kind::Passes,
            choice: vec![name.to_owned(), choice],
            file: file(&[name, "passes", part]),
            caption: format!(
                "{about}: medians over the measured frames, means over seeds, in the plan’s order."
            ),
            drawing: chart.drawing(report::PAGE),
            column: chart.drawing(report::COLUMN),
        }
    })
}

/// Returns charts of the memory of a scene's rows.
pub(super) fn memory(digest: &Digest<'_>, scene: usize) -> Vec<Figure> {
    let most = |row: &Row<'_>| {
        row.done().map(|cell| cell.memory).fold(Memory::default(), |a, b| Memory {
            unshared: a.unshared.max(b.unshared),
            shared: a.shared.max(b.shared),
            bound: a.bound.max(b.bound),
            held: a.held.max(b.held),
        })
    };
    let all: Vec<(&Row<'_>, Memory)> = digest.of_scene(scene).map(|row| (row, most(row))).collect();
    let bytes = |memory: &Memory| kinds(memory).map(|(_, _, bytes)| bytes).into_iter().max().unwrap_or(0);
    let greatest = all.iter().map(|(_, memory)| bytes(memory)).max().unwrap_or(0);
    let (divisor, unit) = number::byte_unit(greatest as f64);
    let rows: Vec<(BarRow, Vec<String>)> = all
        .iter()
        .filter(|(_, memory)| bytes(memory) > 0)
        .map(|(row, memory)| {
            let bar = |(name, ink, bytes): (&str, Ink, u64)| {
                let tip = format!("{name}: {} ({})", human_bytes(bytes), digest.row_text(row));
                vec![Segment { ink, value: bytes as f64 / divisor, tip }]
            };
            let total = human_bytes(memory.shared);
            (bar_row(digest, row, kinds(memory).map(bar).into(), total), Vec::new())
        })
        .collect();
    let name = digest.scenes[scene];
    charts(rows, |rows, _, choice, part| {
        let about = format!("Memory of the plan, {name}");
        let chart = BarChart {
            title: format!("memory [{unit}]"),
            legend: kinds(&Memory::default()).map(|(name, ink, _)| (ink, name.to_owned())).into(),
            about: about.clone(),
            rows,
        };
        Figure {
            kind: Kind::Memory,
            choice: vec![name.to_owned(), choice],
            file: file(&[name, "memory", part]),
            caption: format!(
                "{about}: unshared, with memory of its own for each resource; shared, as it is (the figure beside \
                 the bars); the largest sum alive at once, below which no sharing comes; and all objects that \
                 frames work on."
            ),
            drawing: chart.drawing(report::PAGE),
            column: chart.drawing(report::COLUMN),
        }
    })
}

/// Returns the bars for memory, from the top.
fn kinds(memory: &Memory) -> [(&'static str, Ink, u64); 4] {
    [
        ("unshared", Ink::Rest, memory.unshared),
        ("shared, as it is", Ink::Part(0), memory.shared),
        ("lower bound", Ink::Part(1), memory.bound),
        ("held, with histories", Ink::Part(3), memory.held),
    ]
}

/// Splits rows into charts of limited length. `figure` takes the rows, the passes in them, the name of the
/// chart among the others, and the part of the file name that distinguishes it.
fn charts(
    rows: Vec<(BarRow, Vec<String>)>,
    figure: impl Fn(Vec<BarRow>, Vec<String>, String, &str) -> Figure,
) -> Vec<Figure> {
    let count = rows.len();
    let mut rows = rows.into_iter();
    let chart = |first: usize| {
        let (rows, used): (Vec<BarRow>, Vec<Vec<String>>) = rows.by_ref().take(MOST_ROWS).unzip();
        let choice = if count <= MOST_ROWS {
            "all".to_owned()
        } else {
            format!("{} to {} of {count}", first + 1, first + rows.len())
        };
        let part = if first == 0 { String::new() } else { (first / MOST_ROWS + 1).to_string() };
        figure(rows, used.concat(), choice, &part)
    };
    (0..count).step_by(MOST_ROWS).map(chart).collect()
}

fn bar_row(digest: &Digest<'_>, row: &Row<'_>, bars: Vec<Vec<Segment>>, total: String) -> BarRow {
    BarRow {
        heading: digest.pipelines[row.pipeline].clone(),
        label: digest.values_text(row, &digest.varied()),
        bars,
        total,
    }
}

/// Colors of passes, the same in all charts of a study: the most expensive passes have their own.
struct Inks {
    /// The passes with their own colors, in the order of the plans.
    colored: Vec<String>,
}

impl Inks {
    fn new(digest: &Digest<'_>) -> Inks {
        let mut sums: Vec<(String, f64)> = Vec::new();
        for (name, ms) in digest.rows.iter().flat_map(Row::passes) {
            match sums.iter_mut().find(|(other, _)| *other == name) {
                Some((_, sum)) => *sum += ms,
                None => sums.push((name, ms)),
            }
        }
        let mut costs: Vec<f64> = sums.iter().map(|(_, ms)| *ms).collect();
        costs.sort_by(|a, b| b.total_cmp(a));
        let least = costs.get(MOST_PARTS - 1).copied().unwrap_or(0.0);
        let costly = sums.into_iter().filter(|(_, ms)| *ms >= least).take(MOST_PARTS);
        Inks { colored: costly.map(|(name, _)| name).collect() }
    }

    fn of(&self, pass: &str) -> Ink {
        self.colored.iter().position(|name| name == pass).map_or(Ink::Rest, Ink::Part)
    }

    /// Returns legend entries for the passes in use; those without a color share one.
    fn legend(&self, used: &[String]) -> Vec<(Ink, String)> {
        let own = self.colored.iter().filter(|name| used.contains(name));
        let mut legend: Vec<(Ink, String)> = own.map(|name| (self.of(name), name.clone())).collect();
        let mut others: Vec<&String> = used.iter().filter(|name| self.of(name) == Ink::Rest).collect();
        others.sort();
        others.dedup();
        if !others.is_empty() {
            legend.push((Ink::Rest, format!("{} others", others.len())));
        }
        legend
    }
}
