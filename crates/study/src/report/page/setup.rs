//! The sections on the setup: what was compared, how the results were obtained, and the source of each
//! number.

use std::fmt::Write;

use crate::record::heading;
use crate::report::digest::Digest;
use crate::{Cell, Outcome, ReferenceRecord, Results, StudyRecord};
use report::escape::html;
use report::{number, plain_table};

/// The greatest number of characters of provenance for all cells together; the rest is only in the study's
/// folder.
const MOST_PROVENANCE: usize = 4_000_000;

/// Returns the section on the differences between the pipelines.
pub(super) fn differences(results: &Results) -> String {
    let mut out = String::new();
    for difference in &results.study.differences {
        let (from, to) = (html(&difference.from), html(&difference.to));
        let _ = writeln!(out, "<h3>{from} → {to}</h3>");
        if difference.lines.is_empty() {
            out.push_str("<p class=note>The same.</p>\n");
        } else {
            let _ = writeln!(out, "<pre>{}</pre>", html(&difference.lines.join("\n")));
        }
    }
    if out.is_empty() { "<p class=note>There is one pipeline.</p>\n".to_owned() } else { out }
}

/// Returns the section on the sources and the noise of the references.
pub(super) fn references(results: &Results) -> String {
    if results.study.references.is_empty() {
        return "<p class=note>This study has no reference.</p>\n".to_owned();
    }
    let row = |reference: &ReferenceRecord| {
        let from = match &*reference.error {
            "" => html(&reference.from),
            error => format!("{}<br><span class=failed>{}</span>", html(&reference.from), html(error)),
        };
        let took = match reference.seconds {
            seconds if seconds > 0.0 => number::short(seconds, 3),
            _ => "was there".to_owned(),
        };
        let noise = reference.noise.map_or_else(|| "unknown".to_owned(), |noise| number::short(noise, 2));
        vec![html(&reference.scene), from, noise, took, provenance(&reference.provenance)]
    };
    let table = plain_table(
        &["Scene", "From", "Noise [relMSE]", "Took [s]", "Provenance"],
        results.study.references.iter().map(row),
    );
    format!("<p>An error near the noise of its reference says nothing.</p>\n{table}")
}

/// Returns the section on scenes, pipelines, axes, and the study file itself.
pub(super) fn setup(results: &Results) -> String {
    let study = &results.study;
    let mut out = if study.output.is_empty() { cases(study) } else { scenes(study) };
    if !study.axes.is_empty() {
        out.push_str("<h3>Axes</h3>\n");
        let axes = study.axes.iter().map(|axis| {
            let values: Vec<String> = axis.values.iter().map(ToString::to_string).collect();
            vec![
                format!("<code>{}</code>", html(&axis.name)),
                html(&values.join(", ")),
                html(&axis.unit),
                html(&axis.doc),
            ]
        });
        out += &plain_table(&["Axis", "Values", "Unit", "Is"], axes);
    }
    if !study.command.is_empty() {
        let _ = writeln!(out, "<h3>Command</h3>\n<pre>{}</pre>", html(&study.command));
    }
    if !study.source.is_empty() {
        let _ = write!(
            out,
            "<h3>Description</h3>\n<div class=copyable><button type=button class=copy>Copy</button><pre>{}</pre></div>\n",
            html(&study.source)
        );
    }
    out
}

/// Returns the tables of scenes and pipelines.
fn scenes(study: &StudyRecord) -> String {
    let scenes = study.scenes.iter().map(|scene| {
        let triangles = scene.triangles.to_string();
        vec![html(&scene.name), html(&scene.about), triangles, format!("<code>{}</code>", html(&scene.hash))]
    });
    let scenes = plain_table(&["Scene", "Shows", "Triangles", "Hash"], scenes);
    let pipelines = study.pipelines.iter().map(|pipeline| {
        let set: Vec<String> =
            pipeline.set.iter().map(|(name, value)| format!("{name} = {}", value)).collect();
        let file = format!("<code>{}</code>", html(&pipeline.pipeline));
        vec![html(&pipeline.name), file, html(&pipeline.about), html(&pipeline.paper), html(&set.join(", "))]
    });
    let pipelines = plain_table(&["Name", "Pipeline", "Renders", "Paper", "With"], pipelines);
    format!("<h3>Scenes</h3>\n{scenes}<h3>Pipelines</h3>\n{pipelines}")
}

/// Returns the table of cases that are no scenes.
fn cases(study: &StudyRecord) -> String {
    let rows = study.scenes.iter().map(|case| vec![html(&case.name), html(&case.about)]);
    let case = html(&heading(&study.words.case));
    format!("<h3>{case}s</h3>\n{}", plain_table(&[&case, "Is"], rows))
}

/// Returns the section on the measures.
pub(super) fn measures(digest: &Digest<'_>) -> String {
    let rows = digest.results.study.measures.iter().map(|measure| {
        vec![html(&measure.label), html(&measure.unit), measure.better.word().to_owned(), html(&measure.doc)]
    });
    let table = plain_table(&["Measure", "Unit", "Better", "Is"], rows);
    format!("<details><summary>What the measures are</summary>\n{table}</details>\n")
}

/// Returns the section on all cells, with their provenance.
pub(super) fn cells(digest: &Digest<'_>) -> String {
    let results = digest.results;
    if results.cells.is_empty() {
        return "<p class=note>No cell has run yet.</p>\n".to_owned();
    }
    let [case, subject] =
        [&results.study.words.case, &results.study.words.subject].map(|word| html(&heading(word)));
    let mut out = format!(
        "<details>\n<summary>All cells and their provenance</summary>\n<div class=filter>\
         <label>Filter <input type=search id=cell-filter placeholder=\"words, in any order\"></label>\
         <label><input type=checkbox id=cell-failed> only failed</label>\
         <output id=cell-count></output></div>\n<div class=scroll><table id=cell-table>\n<thead><tr>\
         <th scope=col>{case}</th><th scope=col>{subject}</th><th scope=col>Values</th>\
         <th scope=col class=number>Seed</th><th scope=col>Outcome</th><th scope=col class=number>Frames</th>\
         <th scope=col class=number>Took [s]</th><th scope=col>Cell</th></tr></thead>\n",
    );
    let (mut left, mut left_out) = (MOST_PROVENANCE, 0);
    for (row, cell) in digest.rows.iter().flat_map(|row| row.cells.iter().map(move |cell| (row, cell))) {
        let shown = if cell.provenance.len() > left {
            left_out += 1;
            "<p class=note>In the cell’s file.</p>".to_owned()
        } else {
            left -= cell.provenance.len();
            provenance(&cell.provenance)
        };
        let axes: Vec<usize> = (0..results.study.axes.len()).collect();
        let (data, outcome) = outcome(cell);
        let _ = writeln!(
            out,
            "<tbody{data}><tr><th scope=row>{}</th><td>{}</td><td>{}</td><td class=number>{}</td>{outcome}\
             <td class=number>{}</td><td class=number>{}</td><td><code>cells/{}.json</code></td></tr>\n\
             <tr><td class=record colspan=8>{shown}</td></tr></tbody>",
            html(&cell.scene),
            html(&cell.pipeline),
            html(&digest.values_text(row, &axes)),
            cell.seed,
            cell.frames,
            number::short(cell.seconds, 3),
            html(&cell.key),
        );
    }
    out.push_str("</table></div>\n");
    if left_out > 0 {
        let _ = writeln!(
            out,
            "<p class=note>Provenance of {left_out} cells is left out here to keep the page small; it stands in \
             their files.</p>"
        );
    }
    out + "</details>\n"
}

fn outcome(cell: &Cell) -> (&'static str, String) {
    match &cell.outcome {
        Outcome::Done => ("", "<td>done</td>".to_owned()),
        Outcome::Failed { error } => {
            (" data-failed", format!("<td class=failed>failed: {}</td>", html(error)))
        }
    }
}

/// Returns provenance that can be expanded: JSON by member, other text as it is.
fn provenance(text: &str) -> String {
    if text.is_empty() {
        return String::new();
    }
    let body = match serde_json::from_str::<serde_json::Value>(text) {
        Ok(serde_json::Value::Object(members)) => {
            let member = |(name, value): (&String, &serde_json::Value)| {
                let shown = match value {
                    serde_json::Value::String(text) => text.clone(),
                    value @ (serde_json::Value::Object(_) | serde_json::Value::Array(_)) => {
                        serde_json::to_string_pretty(value).unwrap_or_default()
                    }
                    value => value.to_string(),
                };
                let shown = html(&shown);
                let shown = if shown.contains('\n') { format!("<pre>{shown}</pre>") } else { shown };
                format!("<dt>{}</dt><dd>{shown}</dd>", html(name))
            };
            format!("<dl class=provenance>{}</dl>", members.iter().map(member).collect::<String>())
        }
        _ => format!("<pre>{}</pre>", html(text)),
    };
    format!("<details><summary>Provenance</summary>{body}</details>")
}
