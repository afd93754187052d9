//! Figures with their goals, and how they are printed.

use super::{Args, Figure};
use crate::output::say;
use clap::ValueEnum as _;
use metrics::statistics::median;
use renderer::Gpu;
use serde_json::{Value, json};

/// Median of several runs, with the least and the greatest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spread {
    pub(super) median: f64,
    pub(super) least: f64,
    pub(super) greatest: f64,
}

impl Spread {
    /// Of at least one value; of two in the middle, their mean.
    pub(super) fn of(mut values: Vec<f64>) -> Spread {
        // Sorted by it.
        let median = median(&mut values).unwrap_or(f64::NAN);
        Spread { median, least: values[0], greatest: values[values.len() - 1] }
    }

    /// Something that is no matter of chance.
    pub(super) fn exact(value: f64) -> Spread {
        Spread { median: value, least: value, greatest: value }
    }

    /// `amount` over each value: a rate from times.
    pub(super) fn under(self, amount: f64) -> Spread {
        Spread { median: amount / self.median, least: amount / self.greatest, greatest: amount / self.least }
    }

    /// The ratio of the medians, with the least and the greatest that two runs could give.
    pub(super) fn over(self, other: Spread) -> Spread {
        Spread {
            median: self.median / other.median,
            least: self.least / other.greatest,
            greatest: self.greatest / other.least,
        }
    }
}

/// What the design asks for.
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
    /// Where the goal comes from.
    pub(super) from: &'static str,
    /// What was counted, for programs.
    pub(super) counts: Vec<(&'static str, u64)>,
}

impl Row {
    /// A figure without a goal.
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

    /// As the table has it.
    fn cells(&self) -> [String; 5] {
        let Spread { median, least, greatest } = self.measured;
        let spread = if least == greatest {
            String::new()
        } else {
            format!(" ({}–{})", digits(least), digits(greatest))
        };
        let (goal, met) = match self.goal {
            Some(goal) => {
                let (sign, value) = goal.sign_and_value();
                let met = if goal.met(median) { "yes" } else { "no" };
                (format!("{sign} {} {}", short(value), self.unit), met)
            }
            None => (String::new(), ""),
        };
        [
            self.name.clone(),
            format!("{} {}{spread}", digits(median), self.unit),
            goal,
            met.to_owned(),
            self.from.to_owned(),
        ]
    }

    fn to_json(&self, figure: Figure) -> Value {
        let goal = self.goal.map(|goal| {
            let (sign, value) = goal.sign_and_value();
            json!({ "sign": sign.to_string(), "value": value })
        });
        let counts: serde_json::Map<String, Value> =
            self.counts.iter().map(|(name, count)| ((*name).to_owned(), json!(count))).collect();
        json!({
            "figure": name(figure),
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

/// The rows of a figure, and how they were measured.
pub(super) struct Section {
    pub(super) figure: Figure,
    pub(super) rows: Vec<Row>,
    pub(super) note: String,
}

/// All that was measured, with the machine.
pub(super) struct Table {
    sections: Vec<Section>,
    adapter: Option<String>,
    cores: usize,
    runs: u32,
    quick: bool,
}

impl Table {
    pub(super) fn new(mut sections: Vec<Section>, gpu: Option<&Gpu>, args: &Args) -> Table {
        if args.quick {
            sections
                .iter_mut()
                .flat_map(|section| &mut section.rows)
                .for_each(|row| (row.goal, row.from) = (None, ""));
        }
        Table {
            sections,
            adapter: gpu.map(Gpu::describe),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            runs: args.runs,
            quick: args.quick,
        }
    }

    pub(super) fn print(&self, markdown: bool) {
        let rows = self.sections.iter().flat_map(|section| &section.rows).map(Row::cells);
        let heads = ["what", "measured", "goal", "met", "from"].map(str::to_owned);
        if markdown {
            say!("{}\n", self.machine());
            say!("| {} |\n|---|---|---|---|---|", heads.join(" | "));
            rows.for_each(|cells| say!("| {} |", cells.join(" | ")));
            say!("");
            self.notes().for_each(|(name, note)| say!("- `{name}`: {note}"));
            return;
        }
        let rows: Vec<[String; 5]> = std::iter::once(heads).chain(rows).collect();
        let width = |column: usize| rows.iter().map(|cells| cells[column].chars().count()).max().unwrap_or(0);
        let widths: [usize; 5] = std::array::from_fn(width);
        for cells in &rows {
            let line: Vec<String> =
                cells.iter().zip(widths).map(|(cell, width)| format!("{cell:<width$}")).collect();
            say!("{}", line.join("  ").trim_end());
        }
        say!("");
        self.notes().for_each(|(name, note)| say!("{name}: {note}"));
        say!("{}", self.machine());
    }

    pub(super) fn to_json(&self) -> Value {
        let rows = self
            .sections
            .iter()
            .flat_map(|section| section.rows.iter().map(|row| row.to_json(section.figure)));
        let notes: serde_json::Map<String, Value> =
            self.notes().map(|(name, note)| (name, json!(note))).collect();
        json!({
            "version": env!("CARGO_PKG_VERSION"),
            "optimised": OPTIMISED,
            "adapter": self.adapter,
            "cores": self.cores,
            "runs": self.runs,
            "quick": self.quick,
            "rows": rows.collect::<Vec<_>>(),
            "notes": notes,
        })
    }

    fn notes(&self) -> impl Iterator<Item = (String, &str)> {
        self.sections.iter().map(|section| (name(section.figure), section.note.as_str()))
    }

    /// On what, and how.
    fn machine(&self) -> String {
        let adapter = self.adapter.as_deref().unwrap_or("no adapter was requested");
        let build = if OPTIMISED { "" } else { ", built without full optimisation" };
        let quick = if self.quick { "; a quick look, to which the goals do not apply" } else { "" };
        format!(
            "Lightloom {}{build}; {adapter}, {} CPU cores. Medians (least–greatest); runs after the first: {}{quick}.",
            env!("CARGO_PKG_VERSION"),
            self.cores,
            self.runs,
        )
    }
}

/// Whether CPU times are those of a release.
const OPTIMISED: bool = !cfg!(debug_assertions);

/// As `--only` takes it.
fn name(figure: Figure) -> String {
    figure.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
}

/// Three digits that count.
fn digits(value: f64) -> String {
    let before = if value == 0.0 { 0.0 } else { value.abs().log10().floor() };
    let behind = (2.0 - before).clamp(0.0, 6.0) as usize;
    format!("{value:.behind$}")
}

/// A number as one writes a goal.
fn short(value: f64) -> String {
    format!("{value}")
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
    fn numbers_have_three_digits() {
        let cases = [(0.0, "0.00"), (0.01234, "0.0123"), (1.0, "1.00"), (45.67, "45.7"), (14449.2, "14449")];
        cases.iter().for_each(|(value, text)| assert_eq!(digits(*value), *text));
    }

    #[test]
    fn a_row_says_whether_its_goal_is_met() {
        let spread = Spread { median: 25.0, least: 20.0, greatest: 31.0 };
        let row = Row::new("maps", spread, "×").goal(Goal::AtLeast(30.0), "ISM §5");
        assert_eq!(row.cells(), ["maps", "25.0 × (20.0–31.0)", "≥ 30 ×", "no", "ISM §5"]);
        let row = Row::new("memory", Spread::exact(1.0), "×");
        assert_eq!(row.cells(), ["memory", "1.00 ×", "", "", ""]);
    }
}
