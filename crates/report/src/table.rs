//! Tables in HTML, Markdown and LaTeX.

use crate::escape;
use crate::number::Measured;
use std::fmt::Write;

/// A table, independent of its output format.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// Name of the content; also the name of its file.
    pub name: String,
    /// What it shows, in one line.
    pub caption: String,
    /// The columns.
    pub columns: Vec<Column>,
    /// The rows, with an entry for each column; [`Entry::Failed`] takes the rest of a row.
    pub rows: Vec<Vec<Entry>>,
}

/// A column.
#[derive(Clone, Debug, Default)]
pub struct Column {
    /// The title, with unit.
    pub title: String,
    /// A description; empty if the title suffices.
    pub doc: String,
    /// Whether it is aligned to the right.
    pub is_number: bool,
}

/// An entry of a table.
#[derive(Clone, Debug)]
pub enum Entry {
    /// A name or a value; numbers are sorted as numbers.
    Text(String),
    /// A name with a description that HTML shows under the pointer.
    Named(String, String),
    /// A measured value.
    Measured {
        /// The value, as it is printed.
        value: Measured,
        /// The value by which rows are sorted.
        mean: f64,
        /// Whether it is among the best of its column.
        is_best: bool,
    },
    /// A text with a class of CSS.
    Marked {
        /// The text.
        text: String,
        /// The class; empty for none.
        class: &'static str,
        /// Text that is shown when the pointer is over it.
        tip: String,
        /// Whether it is bold.
        is_bold: bool,
    },
    /// The row has no value in this column.
    Absent,
    /// The reason why the rest of the row is missing.
    Failed(String),
}

impl Column {
    /// Creates a column of text.
    pub fn text(title: &str, doc: &str) -> Column {
        Column { title: title.to_owned(), doc: doc.to_owned(), is_number: false }
    }

    /// Creates a column of numbers.
    pub fn number(title: impl Into<String>, doc: impl Into<String>) -> Column {
        Column { title: title.into(), doc: doc.into(), is_number: true }
    }

    fn class(&self) -> &'static str {
        if self.is_number { " class=number" } else { "" }
    }
}

impl Entry {
    /// Creates a text with a class of CSS and a tip.
    pub fn marked(text: impl Into<String>, class: &'static str, tip: impl Into<String>) -> Entry {
        Entry::Marked { text: text.into(), class, tip: tip.into(), is_bold: false }
    }

    /// Returns the text of the entry.
    fn text(&self) -> String {
        match self {
            Entry::Text(text) | Entry::Named(text, _) | Entry::Marked { text, .. } => text.clone(),
            Entry::Measured { value, .. } => value.text(),
            Entry::Absent => "–".to_owned(),
            Entry::Failed(error) => format!("failed: {error}"),
        }
    }

    fn is_bold(&self) -> bool {
        matches!(self, Entry::Measured { is_best: true, .. } | Entry::Marked { is_bold: true, .. })
    }
}

impl Table {
    /// Returns whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Returns the number of columns that [`Entry::Failed`] takes, from `start`.
    fn rest(&self, start: usize) -> usize {
        self.columns.len().saturating_sub(start).max(1)
    }

    /// Returns a `table` element; with buttons in its head if it is sortable by the page's script.
    pub fn html(&self, is_sortable: bool) -> String {
        let mut out = format!("<table{}>\n<thead><tr>", if is_sortable { " class=sortable" } else { "" });
        for column in &self.columns {
            let (class, doc, title) =
                (column.class(), escape::html(&column.doc), escape::html(&column.title));
            let _ = match is_sortable {
                true => write!(
                    out,
                    "<th scope=col{class}><button type=button title=\"{doc}\">{title}</button></th>"
                ),
                false => write!(out, "<th scope=col{class}{}><span>{title}</span></th>", titled(&column.doc)),
            };
        }
        out.push_str("</tr></thead>\n<tbody>\n");
        for row in &self.rows {
            out.push_str("<tr>");
            for (index, entry) in row.iter().enumerate() {
                out += &self.entry_html(index, entry);
            }
            out.push_str("</tr>\n");
        }
        out + "</tbody></table>\n"
    }

    fn entry_html(&self, index: usize, entry: &Entry) -> String {
        let class = self.columns.get(index).map_or("", Column::class);
        let rest = self.rest(index);
        match entry {
            Entry::Text(text) if index == 0 => format!("<th scope=row>{}</th>", escape::html(text)),
            Entry::Text(text) => format!("<td{class}>{}</td>", escape::html(text)),
            Entry::Named(text, tip) => format!("<th scope=row{}>{}</th>", titled(tip), escape::html(text)),
            Entry::Measured { value, mean, is_best } => {
                let (open, close) = if *is_best { ("<b>", "</b>") } else { ("", "") };
                format!("<td{class} data-value=\"{mean:e}\">{open}{}{close}</td>", value.html())
            }
            Entry::Marked { text, class, tip, is_bold } => {
                let class = match (self.columns.get(index).is_some_and(|column| column.is_number), *class) {
                    (false, "") => String::new(),
                    (false, class) => format!(" class={class}"),
                    (true, "") => " class=number".to_owned(),
                    (true, class) => format!(" class=\"number {class}\""),
                };
                let (open, close) = if *is_bold { ("<b>", "</b>") } else { ("", "") };
                format!("<td{class}{}>{open}{}{close}</td>", titled(tip), escape::html(text))
            }
            Entry::Absent => format!("<td{class}>–</td>"),
            Entry::Failed(error) => {
                format!("<td class=failed colspan={rest}>failed: {}</td>", escape::html(error))
            }
        }
    }

    /// Returns the table in columns of text.
    pub fn text(&self) -> String {
        let titles = self.columns.iter().map(|column| column.title.clone()).collect();
        let rows = self.rows.iter().map(|row| row.iter().map(Entry::text).collect());
        let rows: Vec<Vec<String>> = std::iter::once(titles).chain(rows).collect();
        let width =
            |column: usize| rows.iter().filter_map(|row| row.get(column)?.chars().count().into()).max();
        let widths: Vec<usize> = (0..self.columns.len()).map(|column| width(column).unwrap_or(0)).collect();
        let line = |row: &Vec<String>| {
            let cells = row.iter().zip(&self.columns).zip(&widths);
            let aligned = cells.map(|((text, column), width)| match column.is_number {
                true => format!("{text:>width$}"),
                false => format!("{text:<width$}"),
            });
            format!("{}\n", aligned.collect::<Vec<_>>().join("  ").trim_end())
        };
        rows.iter().map(line).collect()
    }

    /// Returns a table in GitHub's Markdown, below its caption.
    pub fn markdown(&self) -> String {
        let line = |entries: Vec<String>| format!("| {} |\n", entries.join(" | "));
        let titles = self.columns.iter().map(|column| escape::markdown(&column.title)).collect();
        let aligned = |column: &Column| if column.is_number { "---:" } else { "---" }.to_owned();
        let mut out = format!("{}\n\n{}", escape::markdown(&self.caption), line(titles));
        out += &line(self.columns.iter().map(aligned).collect());
        for row in &self.rows {
            let entry = |(index, entry): (usize, &Entry)| {
                let bold = if entry.is_bold() { "**" } else { "" };
                let rest = match entry {
                    Entry::Failed(_) => " | –".repeat(self.rest(index) - 1),
                    _ => String::new(),
                };
                format!("{bold}{}{bold}{rest}", escape::markdown(&entry.text()))
            };
            out += &line(row.iter().enumerate().map(entry).collect());
        }
        out
    }

    /// Returns a `tabular` that uses booktabs, with its caption in a comment.
    pub fn latex(&self) -> String {
        let aligned = self.columns.iter().map(|column| if column.is_number { 'r' } else { 'l' });
        let mut out = format!("\\begin{{tabular}}{{{}}}\n\\toprule\n", aligned.collect::<String>());
        let titles: Vec<String> = self.columns.iter().map(|column| escape::latex(&column.title)).collect();
        let _ = writeln!(out, "{} \\\\\n\\midrule", titles.join(" & "));
        for row in &self.rows {
            let entry = |(index, entry): (usize, &Entry)| match entry {
                // `\boldmath` applies to ± and the power as well, which `\mathbf` does not.
                Entry::Measured { value, is_best: true, .. } => format!("{{\\boldmath ${}$}}", value.latex()),
                Entry::Measured { value, .. } => format!("${}$", value.latex()),
                Entry::Failed(_) => {
                    format!("\\multicolumn{{{}}}{{l}}{{{}}}", self.rest(index), escape::latex(&entry.text()))
                }
                _ if entry.is_bold() => format!("\\textbf{{{}}}", escape::latex(&entry.text())),
                _ => escape::latex(&entry.text()),
            };
            let entries: Vec<String> = row.iter().enumerate().map(entry).collect();
            let line = entries.join(" & ");
            // After the end of a row, a bracket or a star would belong to that end.
            let apart = if line.starts_with(['[', '*']) { "{}" } else { "" };
            let _ = writeln!(out, "{apart}{line} \\\\");
        }
        out.push_str("\\bottomrule\n\\end{tabular}\n");
        let caption = self.caption.replace(char::is_control, " ");
        let reflected = if out.contains("\\reflectbox") { " and \\usepackage{graphicx}" } else { "" };
        format!("% {caption}\n% Needs \\usepackage{{booktabs}}{reflected}\n{out}")
    }
}

/// Returns a `title` attribute; nothing for an empty text.
fn titled(text: &str) -> String {
    if text.is_empty() { String::new() } else { format!(" title=\"{}\"", escape::html(text)) }
}

/// Returns a plain table whose cells are HTML already.
pub fn plain_table(heads: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let head: String = heads.iter().map(|head| format!("<th scope=col>{head}</th>")).collect();
    let row = |cells: Vec<String>| {
        let cell = |(index, text): (usize, String)| {
            if index == 0 { format!("<th scope=row>{text}</th>") } else { format!("<td>{text}</td>") }
        };
        format!("<tr>{}</tr>\n", cells.into_iter().enumerate().map(cell).collect::<String>())
    };
    let body: String = rows.map(row).collect();
    format!(
        "<div class=scroll><table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{body}</tbody></table></div>\n"
    )
}
