//! The report: all cells as JSON, and as a page.

use crate::case::Case;
use crate::cell::{Cell, Verdict};
use crate::seeds::Seeds;
use crate::shown::Shown;
use report::escape::html as escape;
use report::{Column, Entry, Page, Table};
use serde_json::json;
use std::fmt::Write as _;

/// Returns all cells as JSON, with the number of each verdict.
pub fn json(cells: &[Cell]) -> serde_json::Value {
    let count = |verdict: Verdict| cells.iter().filter(|cell| cell.verdict == verdict).count();
    let verdicts: serde_json::Map<_, _> =
        ALL.iter().map(|verdict| (verdict.word().replace(' ', "-"), json!(count(*verdict)))).collect();
    json!({ "verdicts": verdicts, "cells": cells })
}

const ALL: [Verdict; 8] = [
    Verdict::Held,
    Verdict::Refused,
    Verdict::TimedOut,
    Verdict::Off,
    Verdict::Unsteady,
    Verdict::Negative,
    Verdict::NotFinite,
    Verdict::Crashed,
];

const STYLE: &str = include_str!("report.css");

/// Returns the page: a table of cases and pipelines, and below it the details of each cell that did not hold. It needs no
/// other file and no network.
pub fn html(cells: &[Cell], cases: &[Case], about: &str) -> String {
    let mut pipelines: Vec<&str> = Vec::new();
    for cell in cells {
        if !pipelines.contains(&cell.pipeline.as_str()) {
            pipelines.push(&cell.pipeline);
        }
    }
    let mut body =
        format!("<main>\n<h1>At the extremes</h1>\n<p class=lead>{}</p>\n<section>\n<p>", escape(about));
    for verdict in ALL {
        let count = cells.iter().filter(|cell| cell.verdict == verdict).count();
        let _ = write!(body, "<span class={}>{count} {}</span> ", class_of(count, verdict), verdict.word());
    }
    body += "</p>\n<p>A number is the energy of the indirect light as a share of the expected energy: that of the plain \
             scene where only units or the place differ, else that of the path tracer’s, over the same share in the \
             plain scene. Where that is off, it is the mean over further seeds.</p>\n";
    let table = |columns: Vec<Column>, rows| {
        let table = Table { columns, rows, ..Table::default() };
        format!("<div class=scroll>{}</div>\n</section>\n", table.html(false))
    };
    let heads = |first: &str, others: &mut dyn Iterator<Item = &str>| {
        let others = others.map(|title| Column::number(title, ""));
        std::iter::once(Column::text(first, "")).chain(others).collect::<Vec<_>>()
    };
    body += &table(heads("case", &mut pipelines.iter().copied()), by_case(cells, cases, &pipelines));
    let long = long_runs(cells);
    if !long.is_empty() {
        body += "<section><h2>Long runs</h2>\n<p>The last tenth of the frames against the second.</p>\n";
        let titles = ["frames", "energy", "memory", "objects", "time of a frame", "the same from frame"];
        let mut columns = heads("pipeline", &mut titles.into_iter());
        columns.insert(1, Column::text("case", ""));
        body += &table(columns, long);
    }
    let of_table = |cell: &Cell| cases.iter().any(|case| case.name == cell.case);
    if !cells.iter().all(of_table) {
        body += "<section><h2>Settings at the ends of their ranges</h2>\n";
        let row = |pipeline: &&str| {
            let count = |verdict: Verdict| {
                let is =
                    |cell: &&Cell| cell.pipeline == **pipeline && cell.verdict == verdict && !of_table(cell);
                let count = cells.iter().filter(is).count();
                Entry::marked(count.to_string(), class_of(count, verdict), "")
            };
            std::iter::once(Entry::Text((*pipeline).to_owned())).chain(ALL.map(count)).collect()
        };
        body +=
            &table(heads("pipeline", &mut ALL.iter().map(|v| v.word())), pipelines.iter().map(row).collect());
    }
    body += "<section><h2>Cells that did not hold</h2>\n";
    for (i, cell) in cells.iter().enumerate().filter(|(_, cell)| cell.verdict != Verdict::Held) {
        body += &details(i, cell);
    }
    body += "</section>\n</main>\n";
    Page { title: "Lightloom: at the extremes", style: STYLE, body: &body, script: "" }.html()
}

/// Returns a row for each case, with an entry for each pipeline, below the headings of their groups.
fn by_case(cells: &[Cell], cases: &[Case], pipelines: &[&str]) -> Vec<Vec<Entry>> {
    let mut rows = Vec::new();
    let mut group = "";
    for case in cases {
        if case.group != group {
            group = &case.group;
            rows.push(vec![Entry::Heading(group.to_owned())]);
        }
        let found = |pipeline: &&str| {
            let cell = cells.iter().find(|cell| cell.pipeline == *pipeline && cell.case == case.name);
            cell.map_or_else(|| Entry::Text(String::new()), entry)
        };
        let name = Entry::Named(case.name.clone(), case.about.clone());
        rows.push(std::iter::once(name).chain(pipelines.iter().map(found)).collect());
    }
    rows
}

/// Returns a row for each long run.
fn long_runs(cells: &[Cell]) -> Vec<Vec<Entry>> {
    let row = |cell: &Cell| {
        let long = cell.long.as_ref()?;
        let known = |value: Option<f64>, unit: &str, digits| {
            value.map_or_else(|| "not known".to_owned(), |value| format!("{value:+.digits$}{unit}"))
        };
        let numbers = [
            long.frames.to_string(),
            format!("{:.4}", long.energy),
            known(long.growth.map(|bytes| bytes / (1024.0 * 1024.0)), " MiB", 2),
            known(long.objects, "", 0),
            format!("×{:.2}", long.time),
            long.same_from.map_or_else(|| "none".to_owned(), |from| from.to_string()),
        ];
        let case = Entry::marked(&*cell.case, class(cell.verdict), "");
        let names = [Entry::Text(cell.pipeline.clone()), case];
        Some(names.into_iter().chain(numbers.map(Entry::Text)).collect())
    };
    cells.iter().filter_map(row).collect()
}

fn class(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Held => "held",
        Verdict::Refused | Verdict::TimedOut => "refused",
        _ => "defect",
    }
}

fn class_of(count: usize, verdict: Verdict) -> &'static str {
    if count == 0 { "none" } else { class(verdict) }
}

fn entry(cell: &Cell) -> Entry {
    let text = match (cell.verdict, cell.energy) {
        (Verdict::Held | Verdict::Off | Verdict::Unsteady, Some(energy)) => format!("{energy:.2}"),
        (verdict, _) => verdict.word().to_owned(),
    };
    let seeds = cell.seeds.map_or(String::new(), |seeds| format!("; {}", by_seeds(seeds)));
    let error = cell.error.map_or(String::new(), |error| format!("; relMSE {error:.1e}"));
    let guards: String =
        cell.guards.iter().map(|guard| format!("; {}: {}", guard.name, guard.value)).collect();
    let title = format!("{}{seeds}{error}{guards}", cell.verdict.word());
    Entry::marked(text, class(cell.verdict), title)
}

fn by_seeds(seeds: Seeds) -> String {
    let Seeds { count, energy, half_width, first } = seeds;
    format!(
        "{energy:.3} ± {half_width:.3} is the mean of {count} seeds (95 % interval); the first picture has {first:.3}"
    )
}

fn details(number: usize, cell: &Cell) -> String {
    let mut out = format!(
        "<div id=\"cell-{number}\"><h3><span class={}>{}</span> {} · {}</h3>\n<pre>{}</pre>\n<ul>\n",
        class(cell.verdict),
        cell.verdict.word(),
        escape(&cell.pipeline),
        escape(&cell.case),
        escape(&cell.command)
    );
    let mut line = |text: String| {
        let _ = writeln!(out, "<li>{}</li>", escape(&text));
    };
    if !cell.message.is_empty() {
        line(cell.message.clone());
    }
    if let Some(energy) = cell.energy {
        line(format!("{energy:.3} of the energy expected"));
    }
    if let Some(seeds) = cell.seeds {
        line(by_seeds(seeds));
    }
    if cell.not_finite + cell.negative > 0 {
        line(format!("{} pixels not finite, {} negative", cell.not_finite, cell.negative));
    }
    for guard in &cell.guards {
        line(format!("{}: {}", guard.name, guard.value));
    }
    line(format!("{:.1} s", cell.seconds));
    out += "</ul>\n";
    for Shown { about, png } in &cell.pictures {
        let about = escape(about);
        let _ = writeln!(
            out,
            "<figure><img alt=\"{about}\" src=\"data:image/png;base64,{png}\"><figcaption>{about}</figcaption></figure>"
        );
    }
    out + "</div>\n"
}
