//! Figures with their goals.

use super::Figure;
use metrics::statistics::median;
use report::{Column, Entry, Table, number};
use serde_json::{Value, json};
use study::{Cell, Claim, MeasureInfo, Pick, PipelineRecord, Relation, SceneRecord, StudyRecord, Words};

/// Median of several runs, with the least and the greatest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spread {
    pub(super) median: f64,
    pub(super) least: f64,
    pub(super) greatest: f64,
}

impl Spread {
    /// Summarizes at least one value.
    pub(super) fn of(mut values: Vec<f64>) -> Spread {
        // Sorted by it.
        let median = median(&mut values).unwrap_or(f64::NAN);
        Spread { median, least: values[0], greatest: values[values.len() - 1] }
    }

    /// Creates the spread of a value without chance.
    pub(super) fn exact(value: f64) -> Spread {
        Spread { median: value, least: value, greatest: value }
    }

    /// Formats the median with its unit, and with the least and the greatest if these differ.
    pub(super) fn with_unit(self, unit: &str) -> String {
        let Spread { median, least, greatest } = self;
        if least == greatest {
            return format!("{} {unit}", number::short(median, 3));
        }
        let [median, least, greatest] = [median, least, greatest].map(|value| number::short(value, 3));
        format!("{median} {unit} ({least}–{greatest})")
    }

    /// Returns `amount` over each value: a rate from times.
    pub(super) fn under(self, amount: f64) -> Spread {
        Spread { median: amount / self.median, least: amount / self.greatest, greatest: amount / self.least }
    }

    /// Returns the ratio of the medians, with the least and the greatest that two runs could give.
    pub(super) fn over(self, other: Spread) -> Spread {
        Spread {
            median: self.median / other.median,
            least: self.least / other.greatest,
            greatest: self.greatest / other.least,
        }
    }
}

/// A goal of the design, or a limit of the adapter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Goal {
    AtLeast(f64),
    AtMost(f64),
}

impl Goal {
    fn met(self, value: f64) -> bool {
        match self {
            Goal::AtLeast(least) => value >= least,
            Goal::AtMost(most) => value <= most,
        }
    }

    fn sign_and_value(self) -> (char, f64) {
        match self {
            Goal::AtLeast(least) => ('≥', least),
            Goal::AtMost(most) => ('≤', most),
        }
    }
}

/// A figure.
pub(super) struct Row {
    pub(super) name: String,
    pub(super) measured: Spread,
    pub(super) unit: &'static str,
    pub(super) goal: Option<Goal>,
    /// The source of the goal.
    pub(super) from: &'static str,
    /// Counts, for programs.
    pub(super) counts: Vec<(&'static str, u64)>,
}

impl Row {
    /// Creates a figure without a goal.
    pub(super) fn new(name: impl Into<String>, measured: Spread, unit: &'static str) -> Row {
        Row { name: name.into(), measured, unit, goal: None, from: "", counts: Vec::new() }
    }

    pub(super) fn goal(mut self, goal: Goal, from: &'static str) -> Row {
        (self.goal, self.from) = (Some(goal), from);
        self
    }

    pub(super) fn counts(mut self, counts: Vec<(&'static str, u64)>) -> Row {
        self.counts = counts;
        self
    }

    /// Returns the row of the table.
    fn cells(&self) -> [String; 6] {
        let median = self.measured.median;
        let (goal, met) = match self.goal {
            Some(goal) => {
                let (sign, value) = goal.sign_and_value();
                let met = if goal.met(median) { "yes" } else { "no" };
                (format!("{sign} {} {}", number::short(value, 3), self.unit), met)
            }
            None => (String::new(), ""),
        };
        let counts: Vec<String> =
            self.counts.iter().map(|(name, count)| format!("{} {name}", rounded(*count))).collect();
        let measured = self.measured.with_unit(self.unit);
        [self.name.clone(), measured, goal, met.to_owned(), self.from.to_owned(), counts.join(", ")]
    }

    /// Returns the measure of its unit.
    fn info(&self) -> MeasureInfo {
        let (key, label) = match self.unit {
            "×" => ("ratio", "ratio"),
            "s" | "ms" | "µs" => (self.unit, "time"),
            unit => (unit, "rate"),
        };
        let unit = if key == label { "" } else { self.unit };
        MeasureInfo { unit: unit.to_owned(), ..MeasureInfo::new(key, label, "The median of the runs") }
    }

    /// Returns its cell.
    fn cell(&self) -> Cell {
        let Spread { median, least, greatest } = self.measured;
        let counts: serde_json::Map<String, Value> =
            self.counts.iter().map(|(name, count)| ((*name).to_owned(), json!(count))).collect();
        Cell {
            pipeline: self.name.clone(),
            measures: [(self.info().key, Some(median))].into(),
            details: json!({ "least": least, "greatest": greatest, "from": self.from, "counts": counts }),
            ..Cell::default()
        }
    }

    /// Returns its goal in a figure.
    fn claim(&self, figure: &str) -> Option<Claim> {
        let (at_least, at_most) = match self.goal? {
            Goal::AtLeast(least) => (Some(least), None),
            Goal::AtMost(most) => (None, Some(most)),
        };
        let relation = Relation::Bound { of: Pick::all(&self.name), at_least, at_most };
        Some(Claim::new(&self.info().key, relation, figure, self.from))
    }
}

/// The rows of a figure, and a note on their measurement.
pub(super) struct Section {
    pub(super) rows: Vec<Row>,
    pub(super) note: String,
}

impl Section {
    /// Returns the cells of a figure of the study, and adds what is said of them to the study.
    pub(super) fn cells(&self, study: &mut StudyRecord, figure: usize) -> Vec<Cell> {
        let case = &mut study.scenes[figure];
        case.about.clone_from(&self.note);
        study.claims.extend(self.rows.iter().filter_map(|row| row.claim(&case.name)));
        for row in &self.rows {
            let (info, name) = (row.info(), &row.name);
            if study.measures.iter().all(|known| known.key != info.key) {
                study.measures.push(info);
            }
            if study.pipelines.iter().all(|known| known.name != *name) {
                study.pipelines.push(PipelineRecord::subject(name, ""));
            }
        }
        self.rows.iter().map(Row::cell).collect()
    }
}

/// Returns the study of figures before anything is measured.
pub(super) fn blank(figures: &[&Figure], runs: u32, quick: bool) -> StudyRecord {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    StudyRecord {
        name: "bench".to_owned(),
        title: "Costs on this machine".to_owned(),
        about: "Medians of runs, with the least and the greatest, beside the goals".to_owned(),
        words: Words { case: "figure".to_owned(), subject: "what".to_owned() },
        budget: format!(
            "{runs} runs after the first, {cores} CPU cores{}{}",
            // CPU times are not those of a release.
            if cfg!(debug_assertions) { ", built without full optimisation" } else { "" },
            if quick { "; a quick preview, to which the goals do not apply" } else { "" },
        ),
        scenes: figures.iter().map(|figure| SceneRecord::case(figure.name, figure.about)).collect(),
        ..StudyRecord::default()
    }
}

/// Returns the table of all rows.
pub(super) fn of_rows(sections: &[Section]) -> Table {
    let titles = ["what", "measured", "goal", "met", "from", "counts"];
    let rows = sections.iter().flat_map(|section| &section.rows);
    Table {
        name: "Figures".to_owned(),
        caption: "Medians, with the least and the greatest.".to_owned(),
        columns: titles.map(|title| Column::text(title, "")).into(),
        rows: rows.map(|row| row.cells().map(Entry::Text).into()).collect(),
    }
}

/// Formats a count with three significant digits.
fn rounded(count: u64) -> String {
    match count {
        0..1_000 => count.to_string(),
        1_000..1_000_000 => format!("{} k", number::short(count as f64 / 1e3, 3)),
        1_000_000..1_000_000_000 => format!("{} M", number::short(count as f64 / 1e6, 3)),
        _ => format!("{} G", number::short(count as f64 / 1e9, 3)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_and_spreads() {
        let odd = Spread::of(vec![4.0, 1.0, 2.0]);
        assert_eq!(odd, Spread { median: 2.0, least: 1.0, greatest: 4.0 });
        assert_eq!(Spread::of(vec![1.0, 8.0, 3.0, 2.0]).median, 2.5);
        assert_eq!(Spread::of(vec![7.0]), Spread::exact(7.0));
        // Eight rays in 4, 1 and 2 s.
        assert_eq!(odd.under(8.0), Spread { median: 4.0, least: 2.0, greatest: 8.0 });
        let other = Spread { median: 4.0, least: 2.0, greatest: 8.0 };
        assert_eq!(other.over(odd), Spread { median: 2.0, least: 0.5, greatest: 8.0 });
    }

    #[test]
    fn goals_are_met_or_not() {
        assert!(Goal::AtLeast(30.0).met(30.0) && !Goal::AtLeast(30.0).met(29.9));
        assert!(Goal::AtMost(1.05).met(1.05) && !Goal::AtMost(1.05).met(1.06));
    }

    #[test]
    fn a_goal_is_a_claim_of_its_figure() {
        let figures = [&super::super::FIGURES[0]];
        let study = |goal| {
            let row = Row::new("maps", Spread::exact(25.0), "×").goal(goal, "ISM §5");
            let (note, rows) = ("note".to_owned(), vec![row, Row::new("frames", Spread::exact(2.0), "ms")]);
            let folder = tempfile::tempdir().unwrap();
            let section = Section { rows, note };
            let blank = blank(&figures, 3, false);
            let ran =
                study::measure_cases(blank, folder.path(), &mut |study, case| Ok(section.cells(study, case)));
            ran.unwrap().results
        };
        for (goal, verdict) in
            [(Goal::AtLeast(30.0), study::Verdict::Fails), (Goal::AtMost(30.0), study::Verdict::Holds)]
        {
            let results = study(goal);
            let findings = results.findings();
            assert_eq!(findings.iter().map(|finding| finding.verdict).collect::<Vec<_>>(), [Some(verdict)]);
            assert_eq!((findings[0].scenes.as_slice(), results.cells.len()), (&["rays"][..], 2));
        }
    }

    #[test]
    fn a_row_says_whether_its_goal_is_met() {
        let spread = Spread { median: 25.0, least: 20.0, greatest: 31.0 };
        let row = Row::new("maps", spread, "×").goal(Goal::AtLeast(30.0), "ISM §5");
        assert_eq!(row.cells(), ["maps", "25 × (20–31)", "≥ 30 ×", "no", "ISM §5", ""]);
        let counts = vec![("bytes moved", 67_108_864), ("threads", 1_024), ("dispatches", 3)];
        let row = Row::new("memory", Spread::exact(1.5), "×").counts(counts);
        let counts = "67.1 M bytes moved, 1.02 k threads, 3 dispatches";
        assert_eq!(row.cells(), ["memory", "1.50 ×", "", "", "", counts]);
    }
}
