//! The table of what became of all cells: as JSON, and as a page.

use crate::case::Case;
use crate::cell::{Cell, Verdict};
use crate::seeds::Seeds;
use crate::shown::Shown;
use frame_graph::xml::{escape, page};
use serde_json::json;
use std::fmt::Write as _;

/// Returns all cells as JSON, with how many of each verdict there are.
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

/// Returns the page: a table of cases and pipelines, and below what is known of each cell that did not hold. It needs no
/// other file and no network.
pub fn html(cells: &[Cell], cases: &[Case], about: &str) -> String {
    let mut pipelines: Vec<&str> = Vec::new();
    for cell in cells {
        if !pipelines.contains(&cell.pipeline.as_str()) {
            pipelines.push(&cell.pipeline);
        }
    }
    let mut body = format!("<h1>At the extremes</h1>\n<p>{}</p>\n<p>", escape(about));
    for verdict in ALL {
        let count = cells.iter().filter(|cell| cell.verdict == verdict).count();
        let class = if count == 0 { "none" } else { class(verdict) };
        let _ = write!(body, "<span class=\"{class}\">{count} {}</span> ", verdict.word());
    }
    body += "</p>\n<p>A number is the energy of the indirect light as a share of what is expected: of the plain scene's where \
             only units or the place differ, else of the path tracer’s, over the same share in the plain scene. Where that is off, it is \
             the mean over further seeds.</p>\n";
    body += "<table>\n<thead><tr><th scope=\"col\">case</th>";
    for pipeline in &pipelines {
        let _ = write!(body, "<th scope=\"col\"><span>{}</span></th>", escape(pipeline));
    }
    body += "</tr></thead>\n<tbody>\n";
    let mut group = "";
    for case in cases {
        if case.group != group {
            group = case.group;
            let columns = pipelines.len() + 1;
            let _ =
                writeln!(body, "<tr><th class=\"group\" colspan=\"{columns}\">{}</th></tr>", escape(group));
        }
        let name = escape(&case.name);
        let _ = write!(body, "<tr><th scope=\"row\" title=\"{}\">{name}</th>", escape(&case.about));
        for pipeline in &pipelines {
            let found = cells.iter().find(|cell| cell.pipeline == *pipeline && cell.case == case.name);
            body += &found.map_or_else(|| "<td></td>".to_owned(), entry);
        }
        body += "</tr>\n";
    }
    body += "</tbody>\n</table>\n";
    body += &long_runs(cells);
    body += &own(cells, cases, &pipelines);
    body += "<h2>What did not hold</h2>\n";
    for (i, cell) in cells.iter().enumerate().filter(|(_, cell)| cell.verdict != Verdict::Held) {
        body += &details(i, cell);
    }
    page("Lightloom: at the extremes", STYLE, &body)
}

/// What the long runs came to.
fn long_runs(cells: &[Cell]) -> String {
    let runs: Vec<_> = cells.iter().filter_map(|cell| Some((cell, cell.long.as_ref()?))).collect();
    if runs.is_empty() {
        return String::new();
    }
    let mut out =
        "<h2>Long runs</h2>\n<p>The last tenth of the frames against the second.</p>\n<table>\n<thead><tr>"
            .to_owned();
    for column in [
        "pipeline",
        "case",
        "frames",
        "energy",
        "memory",
        "objects",
        "time of a frame",
        "the same from frame",
    ] {
        let _ = write!(out, "<th scope=\"col\">{column}</th>");
    }
    out += "</tr></thead>\n<tbody>\n";
    for (cell, long) in runs {
        let known = |value: Option<f64>, unit: &str, digits| {
            value.map_or_else(|| "not known".to_owned(), |value| format!("{value:+.digits$}{unit}"))
        };
        let _ = writeln!(
            out,
            "<tr><th scope=\"row\">{}</th><td class=\"{}\">{}</td><td>{}</td><td>{:.4}</td><td>{}</td><td>{}</td>\
             <td>×{:.2}</td><td>{}</td></tr>",
            escape(&cell.pipeline),
            class(cell.verdict),
            escape(&cell.case),
            long.frames,
            long.energy,
            known(long.growth.map(|bytes| bytes / (1024.0 * 1024.0)), " MiB", 2),
            known(long.objects, "", 0),
            long.time,
            long.same_from.map_or_else(|| "none".to_owned(), |from| from.to_string()),
        );
    }
    out + "</tbody>\n</table>\n"
}

/// How many cases of its own each pipeline has, by verdict.
fn own(cells: &[Cell], cases: &[Case], pipelines: &[&str]) -> String {
    let of_table = |cell: &Cell| cases.iter().any(|case| case.name == cell.case);
    if cells.iter().all(of_table) {
        return String::new();
    }
    let mut out =
        "<h2>Settings at the ends of their ranges</h2>\n<table>\n<thead><tr><th scope=\"col\">pipeline</th>"
            .to_owned();
    for verdict in ALL {
        let _ = write!(out, "<th scope=\"col\"><span>{}</span></th>", verdict.word());
    }
    out += "</tr></thead>\n<tbody>\n";
    for pipeline in pipelines {
        let _ = write!(out, "<tr><th scope=\"row\">{}</th>", escape(pipeline));
        for verdict in ALL {
            let is = |cell: &&Cell| cell.pipeline == *pipeline && cell.verdict == verdict && !of_table(cell);
            let count = cells.iter().filter(is).count();
            let class = if count == 0 { "none" } else { class(verdict) };
            let _ = write!(out, "<td class=\"{class}\">{count}</td>");
        }
        out += "</tr>\n";
    }
    out + "</tbody>\n</table>\n"
}

fn class(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Held => "held",
        Verdict::Refused | Verdict::TimedOut => "told",
        _ => "defect",
    }
}

fn entry(cell: &Cell) -> String {
    let text = match (cell.verdict, cell.energy) {
        (Verdict::Held | Verdict::Off | Verdict::Unsteady, Some(energy)) => format!("{energy:.2}"),
        (verdict, _) => verdict.word().to_owned(),
    };
    let seeds = cell.seeds.map_or(String::new(), |seeds| format!("; {}", by_seeds(seeds)));
    let error = cell.error.map_or(String::new(), |error| format!("; relMSE {error:.1e}"));
    let guards: String =
        cell.guards.iter().map(|guard| format!("; {}: {}", guard.name, guard.value)).collect();
    let title = format!("{}{seeds}{error}{guards}", cell.verdict.word());
    format!("<td class=\"{}\" title=\"{}\">{text}</td>", class(cell.verdict), escape(&title))
}

fn by_seeds(seeds: Seeds) -> String {
    let Seeds { count, energy, half_width, first } = seeds;
    format!(
        "{energy:.3} ± {half_width:.3} is the mean of {count} seeds (95 % interval); the first picture has {first:.3}"
    )
}

fn details(number: usize, cell: &Cell) -> String {
    let mut out = format!(
        "<section id=\"cell-{number}\"><h3><span class=\"{}\">{}</span> {} · {}</h3>\n<pre>{}</pre>\n<ul>\n",
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
    out + "</section>\n"
}
