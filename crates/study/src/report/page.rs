//! The report page.

mod setup;

use std::fmt::Write;
use std::path::{Path, PathBuf};

use super::FIGURES;
use super::digest::{Digest, distinct};
use super::figures::{Figure, Figures, Kind};
use super::pictures::Pictures;
use crate::record::heading;
use crate::{Outcome, Results};
use report::escape::{self, html};
use report::{Page, Table, number};

/// The image viewer, which the script fills.
const VIEWER: &str = include_str!("viewer.html");
const STYLE: &str = include_str!("page.css");
const SCRIPT: &str =
    concat!(include_str!("page.js"), "\n", include_str!("linear.js"), "\n", include_str!("pictures.js"));

/// A section: its id, its name in the table of contents, and its text.
struct Section<'a> {
    id: &'a str,
    name: &'a str,
    body: String,
}

/// Returns the whole file.
pub(super) fn page(
    digest: &Digest<'_>,
    figures: &Figures,
    (more, tables, claims): (&[Table], &[Table], Option<&Table>),
    pictures: &Pictures,
) -> String {
    let results = digest.results;
    let case = heading(&results.study.words.case);
    let charts = |kind: Kind, id: &'static str, name: &'static str, none: &str| {
        let figures: Vec<&Figure> = figures.all.iter().filter(|figure| figure.kind == kind).collect();
        let choices: Vec<&str> = std::iter::once(&*case).chain(kind.choices().iter().copied()).collect();
        Section { id, name, body: chooser(&choices, &figures, none) }
    };
    let errors = vec![
        charts(
            Kind::ErrorTime,
            "time",
            "Error against time",
            "Nothing to draw: this takes an error and a GPU time of the same cell.",
        ),
        charts(
            Kind::ErrorAxis,
            "axes",
            "Error against each axis",
            "Nothing to draw: nothing is varied over two values, or nothing was measured.",
        ),
    ];
    // Sections that few studies have.
    let ids: Vec<String> = more.iter().map(|table| escape::file_name(&table.name)).collect();
    let more =
        more.iter().zip(&ids).map(|(table, id)| Section { id, name: &table.name, body: table_body(table) });
    let claims = claims.map(|table| Section { id: "claims", name: "Claims", body: table_body(table) });
    let claims: Vec<Section<'_>> = more.chain(claims).collect();
    let has_frames = figures.all.iter().any(|figure| figure.kind == Kind::Frames);
    let frames = has_frames.then(|| charts(Kind::Frames, "frames", "Frame by frame", ""));
    let costs = vec![
        charts(Kind::Passes, "passes", "Time per pass", "Nothing to draw: no cell has times of its passes."),
        charts(Kind::Memory, "memory", "Memory", "Nothing to draw: no cell has a record of its memory."),
    ];
    let pictures_section = Section { id: "pictures", name: "Pictures", body: viewer(pictures) };
    let tables_section = Section { id: "tables", name: "Tables", body: tables_body(digest, tables) };
    let mut rest = vec![
        Section { id: "differences", name: "Differences", body: setup::differences(results) },
        Section { id: "references", name: "References", body: setup::references(results) },
        Section { id: "setup", name: "Set-up", body: setup::setup(results) },
        Section { id: "cells", name: "Cells", body: setup::cells(digest) },
    ];
    let (mut errors, mut costs, mut pictures_sections) = (errors, costs, vec![pictures_section]);
    if !digest.has_pictures() {
        // Nothing of them is there.
        errors.retain(|section| section.id == "axes" && !results.study.axes.is_empty());
        costs.clear();
        pictures_sections.clear();
        rest.retain(|section| section.id != "differences" && section.id != "references");
    }

    let mut sections = failures(digest) + &notes(figures, pictures);
    sections.extend(claims.iter().map(section));
    sections += &grid(&errors);
    sections.extend(frames.iter().map(section));
    sections.extend(pictures_sections.iter().map(section));
    sections += &section(&tables_section);
    sections += &grid(&costs);
    sections.extend(rest.iter().map(section));
    let order = claims
        .iter()
        .chain(&errors)
        .chain(&frames)
        .chain(&pictures_sections)
        .chain([&tables_section])
        .chain(&costs)
        .chain(&rest);
    let contents = order.map(|part| format!("<li><a href=\"#{}\">{}</a></li>\n", part.id, part.name));
    let contents: String = contents.collect();

    let body = format!(
        "<a class=skip href=\"#main\">Skip to the results</a>\n<header>\n{}</header>\n<nav aria-label=Sections>\n\
         <ul>\n{contents}</ul>\n<button type=button id=theme>Theme: auto</button>\n</nav>\n<main id=main>\n\
         {sections}</main>\n<footer><p>Written by Lightloom {} from the study’s folder. It needs no other file and no \
         network.</p></footer>\n<div id=tip role=tooltip hidden></div>\n\
         <script type=\"application/json\" id=pictures-data>{}</script>",
        head(digest),
        html(&results.study.version),
        json(pictures),
    );
    let title = format!("{}: study", results.study.heading());
    Page { title: &title, style: STYLE, body: &body, script: SCRIPT }.html()
}

/// Formats JSON for a `script` element: without `<`, which could end it.
fn json(value: &impl serde::Serialize) -> String {
    let text = serde_json::to_string(value).expect("strings and whole numbers make JSON");
    text.replace('<', "\\u003c")
}

fn section(section: &Section<'_>) -> String {
    let Section { id, name, body } = section;
    format!(
        "<section id=\"{id}\" aria-labelledby=\"{id}-title\">\n<h2 id=\"{id}-title\">{name}</h2>\n{body}</section>\n"
    )
}

/// Returns sections beside each other; nothing without any.
fn grid(sections: &[Section<'_>]) -> String {
    if sections.is_empty() {
        return String::new();
    }
    format!("<div class=grid>\n{}</div>\n", sections.iter().map(section).collect::<String>())
}

fn head(digest: &Digest<'_>) -> String {
    let study = &digest.results.study;
    let mut out = format!("<h1>{}</h1>\n", html(study.heading()));
    if !study.about.is_empty() {
        let _ = writeln!(out, "<p class=lead>{}</p>", html(&study.about));
    }
    let seeds: Vec<String> = study.seeds.iter().map(u32::to_string).collect();
    let failed = digest.results.cells.iter().filter(|cell| cell.outcome != Outcome::Done).count();
    let total = study.cell_count.max(digest.results.cells.len());
    let seconds: f64 = digest.results.cells.iter().map(|cell| cell.seconds).sum();
    let name = if study.title.is_empty() { String::new() } else { study.name.clone() };
    let of_pictures = |text: String| if digest.has_pictures() { text } else { String::new() };
    let facts = [
        ("Study", name),
        ("Cells", format!("{} of {total} done", digest.results.cells.len() - failed)),
        ("Took", duration(seconds)),
        ("Frame", of_pictures(format!("{} × {} px", study.size.0, study.size.1))),
        ("Measured output", study.output.clone()),
        ("Budget", study.budget.clone()),
        ("Warm-up", of_pictures(format!("{} frames", study.warm_up))),
        ("Seeds", seeds.join(", ")),
        ("Paper", study.paper.clone()),
        ("Adapter", digest.results.ran_by().join("; ")),
        ("Nodes", nodes(digest.results)),
        ("Started", study.started.clone()),
        ("Lightloom", study.version.clone()),
    ];
    out.push_str("<dl class=facts>\n");
    for (name, value) in facts.iter().filter(|(_, value)| !value.is_empty()) {
        let _ = writeln!(out, "<div><dt>{name}</dt><dd>{}</dd></div>", html(value));
    }
    out + "</dl>\n"
}

/// Returns the machines that ran the cells, each with the number of its cells.
fn nodes(results: &Results) -> String {
    let hosts = distinct(results.cells.iter().map(|cell| cell.node.host.as_str()));
    let count = |host: &str| results.cells.iter().filter(|cell| cell.node.host == host).count();
    let named = hosts.into_iter().filter(|host| !host.is_empty());
    let texts: Vec<String> = named
        .map(|host| match count(host) {
            1 => format!("{host} (1 cell)"),
            cells => format!("{host} ({cells} cells)"),
        })
        .collect();
    texts.join(", ")
}

/// Returns the errors and notes for the top of the page; empty if there are none.
fn failures(digest: &Digest<'_>) -> String {
    let results = digest.results;
    // Each text with its cells.
    let (mut errors, mut notes): (Vec<About<'_>>, Vec<About<'_>>) = Default::default();
    for (row, cell) in digest.rows.iter().flat_map(|row| row.cells.iter().map(move |cell| (row, cell))) {
        let who = || format!("{}, {}, seed {}", cell.scene, digest.row_text(row), cell.seed);
        if let Outcome::Failed { error } = &cell.outcome {
            add(&mut errors, error, who());
        }
        for note in &cell.notes {
            add(&mut notes, note, who());
        }
    }
    let references = results.study.references.iter().filter(|reference| !reference.error.is_empty());
    let mut items: Vec<String> = references
        .map(|reference| format!("No reference of {}: {}", html(&reference.scene), html(&reference.error)))
        .collect();
    items.extend(errors.iter().map(|(error, cells)| format!("Failed: {}", about(error, cells))));
    let missing = results.study.cell_count.saturating_sub(results.cells.len());
    if missing > 0 {
        let of = results.study.cell_count;
        items.push(format!("{missing} of {of} cells have not run yet: what follows is a part of the study."));
    }
    items.extend(notes.iter().map(|(note, cells)| about(note, cells)));
    list("failures", "alert", "What to know first", &items)
}

/// A text with the cells to which it applies.
type About<'a> = (&'a str, Vec<String>);

fn add<'a>(texts: &mut Vec<About<'a>>, text: &'a str, who: String) {
    match texts.iter_mut().find(|(other, _)| *other == text) {
        Some((_, cells)) => cells.push(who),
        None => texts.push((text, vec![who])),
    }
}

fn about(text: &str, cells: &[String]) -> String {
    let list: String = cells.iter().map(|cell| format!("<li>{}</li>", html(cell))).collect();
    let (count, plural) = (cells.len(), if cells.len() == 1 { "" } else { "s" });
    format!("{} <details><summary>{count} cell{plural}</summary><ul>{list}</ul></details>", html(text))
}

/// Returns a section of items with a class; empty if there are no items. The items are HTML.
fn list(id: &str, class: &str, name: &str, items: &[String]) -> String {
    if items.is_empty() {
        return String::new();
    }
    let items: String = items.iter().map(|item| format!("<li>{item}</li>\n")).collect();
    format!(
        "<section id={id} class={class} aria-labelledby={id}-title>\n<h2 id={id}-title>{name}</h2>\n\
         <ul>\n{items}</ul>\n</section>\n"
    )
}

/// Returns notes on what the page leaves out.
fn notes(figures: &Figures, pictures: &Pictures) -> String {
    let notes: Vec<String> = figures.notes.iter().chain(&pictures.notes).map(|note| html(note)).collect();
    list("notes", "notice", "Left out of this page", &notes)
}

/// Returns charts, one of which is shown at a time, with controls to select it.
fn chooser(names: &[&str], figures: &[&Figure], none: &str) -> String {
    if figures.is_empty() {
        return format!("<p class=note>{none}</p>\n");
    }
    let mut out =
        format!("<div class=chooser data-names=\"{}\">\n<div class=selects></div>\n", html(&json(&names)));
    for figure in figures {
        let _ = writeln!(
            out,
            "<figure class=choice data-choice=\"{}\">\n<div class=drawing>{}</div>\n\
             <figcaption>{} <button type=button class=save data-file=\"{file}\">Save SVG</button> \
             For a column of a paper: <a href=\"figures/{file}\">SVG</a>, <a href=\"figures/{pdf}\">PDF</a></figcaption>\n\
             </figure>",
            html(&json(&figure.choice)),
            figure.drawing.svg(),
            html(&figure.caption),
            file = html(&figure.file),
            pdf = html(&figure.file.replace(".svg", ".pdf")),
        );
    }
    out + "</div>\n"
}

fn tables_body(digest: &Digest<'_>, tables: &[Table]) -> String {
    if tables.is_empty() {
        return "<p class=note>No cell has run yet.</p>\n".to_owned();
    }
    let names = html(&json(&[heading(&digest.results.study.words.case)]));
    let mut out = format!("<div class=chooser data-names=\"{names}\">\n<div class=selects></div>\n");
    for table in tables {
        let choice = html(&json(&[&table.name]));
        let _ = writeln!(out, "<div class=choice data-choice=\"{choice}\">\n{}</div>", table_body(table));
    }
    out.push_str("</div>\n");
    out + &setup::measures(digest)
}

/// Returns a table with buttons to copy it.
fn table_body(table: &Table) -> String {
    let copyable = |name: &str, text: &str| {
        format!(
            "<details><summary>{name}</summary><div class=copyable>\
             <button type=button class=copy>Copy</button><pre>{}</pre></div></details>\n",
            html(text)
        )
    };
    format!(
        "<div class=scroll>{}</div>\n<p class=note>{}</p>\n{}{}",
        table.html(true),
        html(&table.caption),
        copyable("LaTeX", &table.latex()),
        copyable("Markdown", &table.markdown()),
    )
}

fn viewer(pictures: &Pictures) -> String {
    if pictures.count() == 0 {
        return "<p class=note>There are no pictures in this study’s results.</p>\n".to_owned();
    }
    VIEWER.to_owned() + &composed(pictures)
}

/// Returns links to the figures that are composed of the crops, as PDF and for LaTeX; empty where there are none.
fn composed(pictures: &Pictures) -> String {
    let is_pdf = |path: &&PathBuf| path.extension().is_some_and(|extension| extension == "pdf");
    let files = pictures.insets.iter().map(|(path, _)| path).filter(is_pdf);
    let link = |path: &Path| {
        let name = html(&path.to_string_lossy());
        format!("<a href=\"{FIGURES}/{name}\">{name}</a>")
    };
    let items: String =
        files.map(|pdf| format!("<li>{}, {}</li>\n", link(pdf), link(&pdf.with_extension("tex")))).collect();
    match items.is_empty() {
        true => items,
        false => format!(
            "<p>Figures for papers, the crops with the error under each, in the study’s folder:</p>\n<ul id=composed>\n{items}</ul>\n"
        ),
    }
}

fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 120.0 => format!("{} s", number::short(s, 3)),
        s if s < 7200.0 => format!("{} min", number::short(s / 60.0, 3)),
        s => format!("{} h", number::short(s / 3600.0, 3)),
    }
}
