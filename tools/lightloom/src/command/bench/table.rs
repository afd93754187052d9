//! Figures with their goals.

use super::layout::{Machine, digits, print_columns};
use super::{Args, Figure};
use crate::output::stdout;
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
            return format!("{} {unit}", digits(median));
        }
        format!("{} {unit} ({}–{})", digits(median), digits(least), digits(greatest))
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

/// A goal of the design.
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
    fn cells(&self) -> [String; 5] {
        let median = self.measured.median;
        let (goal, met) = match self.goal {
            Some(goal) => {
                let (sign, value) = goal.sign_and_value();
                let met = if goal.met(median) { "yes" } else { "no" };
                (format!("{sign} {} {}", short(value), self.unit), met)
            }
            None => (String::new(), ""),
        };
        [self.name.clone(), self.measured.with_unit(self.unit), goal, met.to_owned(), self.from.to_owned()]
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

/// The rows of a figure, and a note on their measurement.
pub(super) struct Section {
    pub(super) figure: Figure,
    pub(super) rows: Vec<Row>,
    pub(super) note: String,
}

/// All measurements, with the machine.
pub(super) struct Table {
    sections: Vec<Section>,
    machine: Machine,
}

impl Table {
    pub(super) fn new(mut sections: Vec<Section>, gpu: Option<&Gpu>, args: &Args) -> Table {
        if args.quick {
            sections
                .iter_mut()
                .flat_map(|section| &mut section.rows)
                .for_each(|row| (row.goal, row.from) = (None, ""));
        }
        Table { sections, machine: Machine::new(gpu, args) }
    }

    pub(super) fn print(&self, markdown: bool) {
        if markdown {
            stdout!("{}\n", self.machine.line());
        }
        let rows = self.sections.iter().flat_map(|section| &section.rows).map(Row::cells);
        print_columns(["what", "measured", "goal", "met", "from"], rows, markdown);
        stdout!("");
        if markdown {
            self.notes().for_each(|(name, note)| stdout!("- `{name}`: {note}"));
            return;
        }
        self.notes().for_each(|(name, note)| stdout!("{name}: {note}"));
        stdout!("{}", self.machine.line());
    }

    pub(super) fn to_json(&self) -> Value {
        let rows = self
            .sections
            .iter()
            .flat_map(|section| section.rows.iter().map(|row| row.to_json(section.figure)));
        let notes: serde_json::Map<String, Value> =
            self.notes().map(|(name, note)| (name, json!(note))).collect();
        self.machine.json_with([("rows", rows.collect()), ("notes", notes.into())])
    }

    fn notes(&self) -> impl Iterator<Item = (String, &str)> {
        self.sections.iter().map(|section| (name(section.figure), section.note.as_str()))
    }
}

/// Returns the name that `--only` takes.
fn name(figure: Figure) -> String {
    figure.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
}

/// Formats a number as a goal states it.
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
    fn a_row_says_whether_its_goal_is_met() {
        let spread = Spread { median: 25.0, least: 20.0, greatest: 31.0 };
        let row = Row::new("maps", spread, "×").goal(Goal::AtLeast(30.0), "ISM §5");
        assert_eq!(row.cells(), ["maps", "25.0 × (20.0–31.0)", "≥ 30 ×", "no", "ISM §5"]);
        let row = Row::new("memory", Spread::exact(1.0), "×");
        assert_eq!(row.cells(), ["memory", "1.00 ×", "", "", ""]);
    }
}
