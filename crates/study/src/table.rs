//! Tables in CSV: `cells.csv`, tidy, with one row per cell and measure; `summary.csv`, with intervals over
//! seeds, a row for each adapter that ran cells of it; `frames.csv`, tidy, with one row per frame of scenes that move.

use crate::error::StudyError;
use crate::folder::write as write_file;
use crate::record::{Cell, MeasureInfo, Outcome, Results};
use crate::report::Digest;
use std::path::Path;

/// Writes the three tables into a folder.
///
/// # Errors
/// Fails if a file cannot be written.
pub fn write(results: &Results, folder: &Path) -> Result<(), StudyError> {
    write_file(&folder.join("cells.csv"), cells(results).as_bytes())?;
    write_file(&folder.join("summary.csv"), summary(results).as_bytes())?;
    write_file(&folder.join("frames.csv"), frames(results).as_bytes())
}

/// Formats one row per cell and measure; the GPU time of each pass is the measure `gpu-ms/PASS`. The record of a cell
/// is `cells/KEY.json`; its pictures are `image`,
/// `reference` and `flip`, relative to the folder.
fn cells(results: &Results) -> String {
    let columns = [
        "seed",
        "measure",
        "value",
        "unit",
        "outcome",
        "chosen",
        "note",
        "key",
        "image",
        "reference",
        "flip",
        "node",
        "adapter",
    ];
    let mut lines = Lines::new(results, &columns);
    for cell in &results.cells {
        // The rest of a diagnostic is in the cell's own file.
        let outcome = match &cell.outcome {
            Outcome::Done => "done".to_owned(),
            Outcome::Failed { error } => format!("failed: {}", error.lines().next().unwrap_or_default()),
        };
        let images = &cell.images;
        let [image, reference, flip] =
            [&images.image, &images.reference, &images.flip].map(|path| path.as_deref().unwrap_or(""));
        let chosen: Vec<String> = cell.chosen.iter().map(|(name, value)| format!("{name}={value}")).collect();
        let (seed, chosen, note) = (cell.seed.to_string(), chosen.join(" "), cell.notes.join("; "));
        let measures = results.study.measures.iter().map(|info| {
            let value = cell.measures.get(&info.key).copied().flatten();
            (info.key.clone(), value, info.unit.as_str())
        });
        let passes =
            cell.passes.iter().map(|time| (format!("gpu-ms/{}", time.pass), Some(time.gpu_ms), "ms"));
        for (measure, value, unit) in measures.chain(passes) {
            let value = value.map(|value| value.to_string()).unwrap_or_default();
            let node = &cell.node;
            let own = [cell.key.as_str(), image, reference, flip, &node.host, &node.adapter];
            lines.push(
                cell,
                &[[&seed, &measure, &value, unit, &outcome, &chosen, &note].as_slice(), &own].concat(),
            );
        }
    }
    lines.text
}

fn summary(results: &Results) -> String {
    let mut lines = Lines::new(results, &["measure", "unit", "seeds", "mean", "half_width_95", "adapter"]);
    for row in Digest::new(results).rows {
        for info in &results.study.measures {
            let figure = row.summary(&info.key);
            let text = |value: Option<f64>| value.map(|value| value.to_string()).unwrap_or_default();
            let seeds = figure.map_or(0, |figure| figure.seeds).to_string();
            let mean = text(figure.map(|figure| figure.mean));
            let half = text(figure.and_then(|figure| figure.half));
            if let Some(cell) = row.cells.first() {
                let adapter = &cell.node.adapter;
                lines.push(cell, &[&info.key, &info.unit, &seeds, &mean, &half, adapter]);
            }
        }
    }
    lines.text
}

/// Formats one row per finished cell, frame and measure, for scenes that move.
fn frames(results: &Results) -> String {
    let mut lines = Lines::new(results, &["seed", "frame", "measure", "value", "unit"]);
    for cell in results.cells.iter().filter(|cell| cell.outcome == Outcome::Done) {
        let seed = cell.seed.to_string();
        let measures = results.study.measures.iter();
        let columns: Vec<(&MeasureInfo, &Vec<Option<f64>>)> =
            measures.filter_map(|info| Some((info, cell.series.values.get(&info.key)?))).collect();
        let count = columns.iter().map(|(_, column)| column.len()).max().unwrap_or(0);
        for index in 0..count {
            let frame = (cell.series.first as usize + index).to_string();
            for (info, column) in &columns {
                let value = column.get(index).copied().flatten().map(|value| value.to_string());
                lines.push(cell, &[&seed, &frame, &info.key, &value.unwrap_or_default(), &info.unit]);
            }
        }
    }
    lines.text
}

/// Formats rows that begin with scene, pipeline and axes.
struct Lines<'a> {
    axes: Vec<&'a str>,
    text: String,
}

impl<'a> Lines<'a> {
    fn new(results: &'a Results, columns: &[&str]) -> Lines<'a> {
        let axes: Vec<&str> = results.study.axes.iter().map(|axis| axis.name.as_str()).collect();
        let head: Vec<&str> = ["scene", "pipeline"].iter().chain(&axes).chain(columns).copied().collect();
        let mut lines = Lines { axes, text: String::new() };
        lines.line(&head);
        lines
    }

    fn push(&mut self, cell: &Cell, fields: &[&str]) {
        let value = |axis: &&str| cell.axes.get(*axis).map(ToString::to_string).unwrap_or_default();
        let axes: Vec<String> = self.axes.iter().map(value).collect();
        let head = [cell.scene.as_str(), cell.pipeline.as_str()];
        let row: Vec<&str> =
            head.into_iter().chain(axes.iter().map(String::as_str)).chain(fields.iter().copied()).collect();
        self.line(&row);
    }

    fn line(&mut self, fields: &[&str]) {
        let fields: Vec<String> = fields.iter().map(|field| quoted(field)).collect();
        self.text.push_str(&fields.join(","));
        self.text.push('\n');
    }
}

/// Formats a field of a CSV file (RFC 4180); line breaks become spaces, so that each row is one line. A text that a
/// spreadsheet would take for a formula begins with an apostrophe.
fn quoted(field: &str) -> String {
    let mut field = field.replace(['\r', '\n'], " ");
    if field.starts_with(['=', '+', '-', '@', '\t']) && field.parse::<f64>().is_err() {
        field.insert(0, '\'');
    }
    if field.contains([',', '"']) { format!("\"{}\"", field.replace('"', "\"\"")) } else { field }
}

#[cfg(test)]
mod tests {
    use super::quoted;

    #[test]
    fn fields_that_need_quotes_have_them() {
        assert_eq!(quoted("W/(m² sr)"), "W/(m² sr)");
        assert_eq!(quoted("a, \"b\"\nc"), "\"a, \"\"b\"\" c\"");
    }

    #[test]
    fn no_text_is_a_formula() {
        assert_eq!(quoted("=cmd|' /C calc'!A0"), "'=cmd|' /C calc'!A0");
        assert_eq!(["+a", "-b", "@c", "-0.5", "-inf"].map(quoted), ["'+a", "'-b", "'@c", "-0.5", "-inf"]);
    }
}
