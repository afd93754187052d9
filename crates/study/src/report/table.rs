//! Tables in HTML, Markdown and LaTeX. The table of a scene has a row for each pipeline and combination of
//! values, and a column for each measure.

mod claims;

use std::fmt::Write;

use super::best::Best;
use super::digest::{Digest, Row, label_with_unit};
use super::escape;
use super::number::{self, Measured};
use crate::{Interval, MeasureInfo, Verdict};

/// A table, independent of its output format.
pub(super) struct Table {
    /// Name of the scene, or of the content; also the name of its file.
    pub(super) name: String,
    /// What it shows, in one line.
    pub(super) caption: String,
    columns: Vec<Column>,
    rows: Vec<Vec<Entry>>,
}

struct Column {
    /// The title, with unit.
    title: String,
    /// A description; empty if the title suffices.
    doc: String,
    /// Whether it is aligned to the right.
    is_number: bool,
}

enum Entry {
    /// A name or a value; numbers are sorted as numbers.
    Text(String),
    /// A measure.
    Measured { value: Measured, mean: f64, is_best: bool },
    /// What is said of a claim; `None` if that was not measured.
    Verdict(Option<Verdict>),
    /// The row has no value for this measure.
    Absent,
    /// All seeds failed: the error takes the rest of the row.
    Failed(String),
}

impl Table {
    pub(super) fn new(digest: &Digest<'_>, scene: usize) -> Table {
        let study = &digest.results.study;
        let varied = digest.varied();
        let rows: Vec<&Row<'_>> = digest.of_scene(scene).collect();
        let mut chosen: Vec<&str> = Vec::new();
        for name in rows.iter().flat_map(|row| row.done()).flat_map(|cell| cell.chosen.keys()) {
            if !chosen.contains(&&**name) {
                chosen.push(name);
            }
        }
        let measures: Vec<&MeasureInfo> = digest.measured().collect();
        let best_of = |measure: &&MeasureInfo| {
            let values: Vec<Interval> = rows.iter().filter_map(|row| row.summary(&measure.key)).collect();
            Best::of(measure.better, &values, digest.noise(scene, measure))
        };
        let bests: Vec<Option<Best>> = measures.iter().map(best_of).collect();

        let mut columns = vec![Column { title: "Pipeline".into(), doc: String::new(), is_number: false }];
        columns.extend(varied.iter().map(|&axis| {
            let axis = &study.axes[axis];
            let unit = if axis.unit.is_empty() { String::new() } else { format!(" [{}]", axis.unit) };
            Column { title: format!("{}{unit}", axis.name), doc: axis.doc.clone(), is_number: true }
        }));
        columns.extend(chosen.iter().map(|name| Column {
            title: format!("{name}*"),
            doc: "Chosen by the budget".to_owned(),
            is_number: true,
        }));
        columns.push(Column { title: "Seeds".into(), doc: "Finished cells".into(), is_number: true });
        columns.extend(measures.iter().map(|measure| Column {
            title: label_with_unit(measure),
            doc: measure.doc.clone(),
            is_number: true,
        }));

        let entries = |row: &&Row<'_>| {
            let mut entries = vec![Entry::Text(digest.pipelines[row.pipeline].to_owned())];
            let values = varied.iter().map(|&axis| row.values[axis].map(ToString::to_string));
            let budget = chosen.iter().map(|name| row.chosen(name));
            entries.extend(values.chain(budget).map(|text| text.map_or(Entry::Absent, Entry::Text)));
            let (done, failure) = (row.done().count(), row.failure());
            if let (0, Some((error, count))) = (done, failure) {
                entries.push(Entry::Text(format!("0 of {count}")));
                entries.push(Entry::Failed(error.to_owned()));
                return entries;
            }
            entries.push(Entry::Text(match failure {
                Some(_) => format!("{done} of {}", row.cells.len()),
                None => done.to_string(),
            }));
            entries.extend(measures.iter().zip(&bests).map(
                |(measure, best)| match row.summary(&measure.key) {
                    Some(summary) => {
                        let is_best = best.as_ref().is_some_and(|best| best.includes(&summary));
                        Entry::Measured { value: Measured::new(&summary), mean: summary.mean, is_best }
                    }
                    None => Entry::Absent,
                },
            ));
            entries
        };
        let mut caption = format!("{}: means over seeds", digest.scenes[scene]);
        if study.seeds.len() > 1 {
            caption +=
                " and half the width of their 95 % intervals (Student’s t; none where all seeds agree)";
        }
        caption += if study.seeds.len() > 1 {
            "; in bold, the best of each column and all whose intervals overlap its own, unless that is all of them."
        } else {
            "; in bold, the best of each column. One seed has no interval that tells it from chance."
        };
        for measure in &measures {
            if let Some(noise) = digest.noise(scene, measure) {
                caption += &format!(
                    " {} below {}, the reference’s own, is no gain, and counts as alike.",
                    measure.label,
                    number::short(noise, 2)
                );
            }
        }
        if !chosen.is_empty() {
            caption += " Columns with * are what the budget chose.";
        }
        let rows = rows.iter().map(entries).collect();
        Table { name: digest.scenes[scene].to_owned(), caption, columns, rows }
    }

    /// Returns whether there are no rows.
    pub(super) fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Returns the number of columns that [`Entry::Failed`] takes, from `start`.
    fn rest(&self, start: usize) -> usize {
        self.columns.len().saturating_sub(start).max(1)
    }

    /// Returns a `table` element with buttons for sorting.
    pub(super) fn html(&self) -> String {
        let mut out = String::from("<table class=sortable>\n<thead><tr>");
        for column in &self.columns {
            let class = if column.is_number { " class=number" } else { "" };
            let _ = write!(
                out,
                "<th scope=col{class}><button type=button title=\"{}\">{}</button></th>",
                escape::html(&column.doc),
                escape::html(&column.title)
            );
        }
        out.push_str("</tr></thead>\n<tbody>\n");
        for row in &self.rows {
            out.push_str("<tr>");
            for (index, entry) in row.iter().enumerate() {
                let class = if self.columns.get(index).is_some_and(|column| column.is_number) {
                    " class=number"
                } else {
                    ""
                };
                let _ = match entry {
                    Entry::Text(text) if index == 0 => {
                        write!(out, "<th scope=row>{}</th>", escape::html(text))
                    }
                    Entry::Text(text) => write!(out, "<td{class}>{}</td>", escape::html(text)),
                    Entry::Measured { value, mean, is_best: true } => {
                        write!(out, "<td{class} data-value=\"{mean:e}\"><b>{}</b></td>", value.html())
                    }
                    Entry::Measured { value, mean, .. } => {
                        write!(out, "<td{class} data-value=\"{mean:e}\">{}</td>", value.html())
                    }
                    Entry::Verdict(verdict @ Some(Verdict::Fails)) => {
                        write!(out, "<td class=failed><b>{}</b></td>", verdict_text(*verdict))
                    }
                    Entry::Verdict(verdict) => write!(out, "<td>{}</td>", verdict_text(*verdict)),
                    Entry::Absent => write!(out, "<td{class}>–</td>"),
                    Entry::Failed(error) => write!(
                        out,
                        "<td class=failed colspan={}>failed: {}</td>",
                        self.rest(index),
                        escape::html(error)
                    ),
                };
            }
            out.push_str("</tr>\n");
        }
        out + "</tbody></table>\n"
    }

    /// Returns a table in GitHub's Markdown, below its caption.
    pub(super) fn markdown(&self) -> String {
        let mut out = format!("{}\n\n|", escape::markdown(&self.caption));
        for column in &self.columns {
            let _ = write!(out, " {} |", escape::markdown(&column.title));
        }
        out.push_str("\n|");
        for column in &self.columns {
            out.push_str(if column.is_number { " ---: |" } else { " --- |" });
        }
        out.push('\n');
        for row in &self.rows {
            out.push('|');
            for (index, entry) in row.iter().enumerate() {
                let _ = match entry {
                    Entry::Text(text) => write!(out, " {} |", escape::markdown(text)),
                    Entry::Measured { value, is_best: true, .. } => write!(out, " **{}** |", value.text()),
                    Entry::Measured { value, .. } => write!(out, " {} |", value.text()),
                    Entry::Verdict(verdict @ Some(Verdict::Fails)) => {
                        write!(out, " **{}** |", verdict_text(*verdict))
                    }
                    Entry::Verdict(verdict) => write!(out, " {} |", verdict_text(*verdict)),
                    Entry::Absent => write!(out, " – |"),
                    Entry::Failed(error) => {
                        let others = " – |".repeat(self.rest(index) - 1);
                        write!(out, " failed: {} |{others}", escape::markdown(error))
                    }
                };
            }
            out.push('\n');
        }
        out
    }

    /// Returns a `tabular` that uses booktabs, with its caption in a comment.
    pub(super) fn latex(&self) -> String {
        let aligned = self.columns.iter().map(|column| if column.is_number { 'r' } else { 'l' });
        let mut out = format!("\\begin{{tabular}}{{{}}}\n\\toprule\n", aligned.collect::<String>());
        let titles: Vec<String> = self.columns.iter().map(|column| escape::latex(&column.title)).collect();
        let _ = writeln!(out, "{} \\\\\n\\midrule", titles.join(" & "));
        for row in &self.rows {
            let entry = |(index, entry): (usize, &Entry)| match entry {
                Entry::Text(text) => escape::latex(text),
                // `\boldmath` applies to ± and the power as well, which `\mathbf` does not.
                Entry::Measured { value, is_best: true, .. } => format!("{{\\boldmath ${}$}}", value.latex()),
                Entry::Measured { value, .. } => format!("${}$", value.latex()),
                Entry::Verdict(verdict @ Some(Verdict::Fails)) => {
                    format!("\\textbf{{{}}}", verdict_text(*verdict))
                }
                Entry::Verdict(verdict) => verdict_text(*verdict).to_owned(),
                Entry::Absent => "--".to_owned(),
                Entry::Failed(error) => {
                    let columns = self.rest(index);
                    format!("\\multicolumn{{{columns}}}{{l}}{{failed: {}}}", escape::latex(error))
                }
            };
            let entries: Vec<String> = row.iter().enumerate().map(entry).collect();
            let _ = writeln!(out, "{} \\\\", entries.join(" & "));
        }
        out.push_str("\\bottomrule\n\\end{tabular}\n");
        let caption = self.caption.replace(char::is_control, " ");
        let reflected = if out.contains("\\reflectbox") { " and \\usepackage{graphicx}" } else { "" };
        format!("% {caption}\n% Needs \\usepackage{{booktabs}}{reflected}\n{out}")
    }
}

fn verdict_text(verdict: Option<Verdict>) -> &'static str {
    match verdict {
        Some(Verdict::Holds) => "holds",
        Some(Verdict::Fails) => "does not hold",
        Some(Verdict::Undecided) => "not decided",
        None => "not measured",
    }
}
