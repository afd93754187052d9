//! The charts of a study, each with the values by which a reader selects them.

mod costs;
mod errors;
mod frames;

use std::collections::BTreeSet;

use super::digest::Digest;
use report::{Drawing, escape};

/// A chart.
pub(super) struct Figure {
    pub(super) kind: Kind,
    /// The values by which it is selected among the others of its section: one for each of [`Kind::choices`].
    pub(super) choice: Vec<String>,
    /// Name of its SVG file, without folder; a PDF file has the same.
    pub(super) file: String,
    /// A description for readers.
    pub(super) caption: String,
    /// The chart, for a page.
    pub(super) drawing: Drawing,
    /// The chart, for a column of a paper.
    pub(super) column: Drawing,
}

/// The sections of the report that hold charts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    ErrorTime,
    ErrorAxis,
    Frames,
    Passes,
    Memory,
}

impl Kind {
    /// Returns the names of what a chart is selected by, after its case.
    pub(super) fn choices(self) -> &'static [&'static str] {
        match self {
            Kind::ErrorTime => &["Measure"],
            Kind::ErrorAxis => &["Measure", "Axis", "With"],
            Kind::Frames => &["Measure", "Values"],
            Kind::Passes | Kind::Memory => &["Rows"],
        }
    }
}

/// All charts, and notes on those that were left out.
pub(super) struct Figures {
    pub(super) all: Vec<Figure>,
    pub(super) notes: Vec<String>,
}

impl Figures {
    pub(super) fn new(digest: &Digest<'_>) -> Figures {
        let mut figures = Figures { all: Vec::new(), notes: Vec::new() };
        let mut files = BTreeSet::new();
        for scene in 0..digest.scenes.len() {
            let (against_axes, left_out) = errors::against_axes(digest, scene);
            let parts = [
                errors::against_time(digest, scene),
                against_axes,
                frames::frames(digest, scene),
                costs::passes(digest, scene),
                costs::memory(digest, scene),
            ];
            for mut figure in parts.into_iter().flatten() {
                figure.file = unique(&mut files, &figure.file);
                figures.all.push(figure);
            }
            if left_out > 0 {
                figures.notes.push(format!(
                    "{left_out} charts over axes of {} are left out: at most {} combinations of the other axes \
                     are drawn for each axis and measure. The tables hold all of them.",
                    digest.scenes[scene],
                    errors::MOST_COMBINATIONS,
                ));
            }
        }
        figures
    }
}

/// Returns a file name that is composed of these texts.
fn file(parts: &[&str]) -> String {
    let parts: Vec<String> =
        parts.iter().filter(|part| !part.is_empty()).map(|part| escape::file_name(part)).collect();
    parts.join("-") + ".svg"
}

/// Returns `name`, or `name-2` if that is taken; some file systems ignore case.
pub(super) fn unique(taken: &mut BTreeSet<String>, name: &str) -> String {
    let (stem, ending) = name.rsplit_once('.').unwrap_or((name, ""));
    let mut candidate = name.to_owned();
    let mut number = 1;
    while !taken.insert(candidate.to_lowercase()) {
        number += 1;
        candidate = format!("{stem}-{number}.{ending}");
    }
    candidate
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_differ_only_in_signs_have_files_of_their_own() {
        let mut taken = BTreeSet::new();
        let names = ["a+b", "a b", "A-B"].map(|name| unique(&mut taken, &file(&[name, "", "time"])));
        assert_eq!(names, ["a-b-time.svg", "a-b-time-2.svg", "A-B-time-3.svg"]);
    }
}
