//! Figures with their goals.

use super::{Args, Figure};
use crate::output::stdout;
use clap::ValueEnum as _;
use metrics::statistics::median;
use renderer::Gpu;
use report::{Column, Entry, number};
use serde_json::{Value, json};

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
    Below(f64),
}

impl Goal {
    fn met(self, value: f64) -> bool {
        match self {
            Goal::AtLeast(least) => value >= least,
            Goal::AtMost(most) => value <= most,
            Goal::Below(bound) => value < bound,
        }
    }

    fn sign_and_value(self) -> (char, f64) {
        match self {
            Goal::AtLeast(least) => ('≥', least),
            Goal::AtMost(most) => ('≤', most),
            Goal::Below(bound) => ('<', bound),
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

    fn to_json(&self, figure: &str) -> Value {
        let goal = self.goal.map(|goal| {
            let (sign, value) = goal.sign_and_value();
            json!({ "sign": sign.to_string(), "value": value })
        });
        let counts: serde_json::Map<String, Value> =
            self.counts.iter().map(|(name, count)| ((*name).to_owned(), json!(count))).collect();
        json!({
            "figure": figure,
            "name": self.name,
            "median": self.measured.median,
            "least": self.measured.least,
            "greatest": self.measured.greatest,
            "unit": self.unit,
            "goal": goal,
            "met": self.goal.map(|goal| goal.met(self.measured.median)),
            "from": self.from,
            "counts": counts,
        })
    }
}

/// The rows of a figure, and a note on their measurement.
pub(super) struct Section {
    pub(super) figure: Figure,
    pub(super) rows: Vec<Row>,
    pub(super) note: String,
}

/// Whether CPU times are those of a release.
const OPTIMISED: bool = !cfg!(debug_assertions);

/// All measurements, with the machine.
pub(super) struct Table<'a> {
    sections: Vec<Section>,
    adapter: Option<String>,
    cores: usize,
    args: &'a Args,
}

impl Table<'_> {
    pub(super) fn new<'a>(mut sections: Vec<Section>, gpu: Option<&Gpu>, args: &'a Args) -> Table<'a> {
        // What a pass can take at least follows from its size.
        let sized = sections.iter_mut().filter(|section| section.figure != Figure::Roofline && args.quick);
        for row in sized.flat_map(|section| &mut section.rows) {
            (row.goal, row.from) = (None, "");
        }
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        Table { sections, adapter: gpu.map(Gpu::describe), cores, args }
    }

    pub(super) fn print(&self) {
        let titles = ["what", "measured", "goal", "met", "from", "counts"];
        let rows = self.sections.iter().flat_map(|section| &section.rows);
        let table = report::Table {
            columns: titles.map(|title| Column::text(title, "")).into(),
            rows: rows.map(|row| row.cells().map(Entry::Text).into()).collect(),
            ..report::Table::default()
        };
        let text = if self.args.markdown { table.markdown() } else { table.text() };
        stdout!("{}", text.trim_start());
        self.notes().for_each(|(name, note)| stdout!("- `{name}`: {note}"));
        let adapter = self.adapter.as_deref().unwrap_or("no adapter was requested");
        stdout!(
            "\nLightloom {}{}; {adapter}, {} CPU cores. Medians (least–greatest); runs after the first: {}{}.",
            env!("CARGO_PKG_VERSION"),
            if OPTIMISED { "" } else { ", built without full optimisation" },
            self.cores,
            self.args.runs,
            if self.args.quick { "; a quick preview, to which the goals do not apply" } else { "" },
        );
    }

    pub(super) fn to_json(&self) -> Value {
        let rows = self.sections.iter().flat_map(|section| {
            let figure = name(section.figure);
            section.rows.iter().map(move |row| row.to_json(&figure))
        });
        let notes: serde_json::Map<String, Value> =
            self.notes().map(|(name, note)| (name, json!(note))).collect();
        json!({
            "version": env!("CARGO_PKG_VERSION"),
            "optimised": OPTIMISED,
            "adapter": self.adapter,
            "cores": self.cores,
            "runs": self.args.runs,
            "quick": self.args.quick,
            "rows": rows.collect::<Vec<_>>(),
            "notes": notes,
        })
    }

    fn notes(&self) -> impl Iterator<Item = (String, &str)> {
        self.sections.iter().map(|section| (name(section.figure), section.note.as_str()))
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

/// Returns the name that `--only` takes.
fn name(figure: Figure) -> String {
    figure.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
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
        assert!(Goal::Below(1.0).met(0.99) && !Goal::Below(1.0).met(1.0));
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
