//! How long studies take on several GPUs, from the costs of a run.

use crate::cost::{Costs, SHARD_MINUTES, cut, parts_of, singly};
use crate::plan::Plan;
use report::{Column, Entry, Table, number};
use std::ops::Range;

/// The numbers of GPUs of the table.
const GPUS: [usize; 3] = [1, 8, 64];

/// What a study takes.
struct Work {
    references: Vec<f64>,
    cells: Vec<f64>,
    units: Vec<Range<usize>>,
}

impl Work {
    fn new(plan: &Plan, costs: &Costs) -> Work {
        Work { references: costs.of_references(plan), cells: costs.of_cells(plan), units: plan.units() }
    }

    /// Returns the same with twice the seeds.
    fn doubled(&self) -> Work {
        let (mut cells, mut units) = (Vec::new(), Vec::new());
        for unit in &self.units {
            let start = cells.len();
            cells.extend(self.cells[unit.clone()].iter().flat_map(|seconds| [*seconds; 2]));
            // Seeds that need not stay together are units of their own.
            match unit.len() {
                1 => units.extend((start..cells.len()).map(|cell| cell..cell + 1)),
                _ => units.push(start..cells.len()),
            }
        }
        Work { references: self.references.clone(), cells, units }
    }

    /// Returns the seconds until the last shard has ended, if each GPU takes the next one as soon as it can: first of the
    /// references, then of the cells.
    fn seconds(&self, gpus: usize) -> f64 {
        let of = |seconds: &[f64], units: &[Range<usize>]| {
            let mut busy = vec![0.0; gpus];
            for shard in cut(seconds, units, parts_of(seconds, SHARD_MINUTES)) {
                if let Some(first) = busy.iter_mut().min_by(|a, b| f64::total_cmp(a, b)) {
                    *first += seconds[shard].iter().sum::<f64>();
                }
            }
            busy.into_iter().fold(0.0, f64::max)
        };
        of(&self.references, &singly(self.references.len())) + of(&self.cells, &self.units)
    }

    /// Returns the exponent with which that grows with the number of cells: that of a power law through it and twice the seeds.
    fn exponent(&self, gpus: usize) -> f64 {
        (self.doubled().seconds(gpus) / self.seconds(gpus)).log2()
    }
}

/// Returns a table of the time that studies take on 1, 8 and 64 GPUs, and of the exponent with which it grows with the cells.
pub fn costs(studies: &[(Plan, Costs)]) -> Table {
    let mut columns = vec![
        Column::text("Study", ""),
        Column::number("Cells".to_owned(), "Of the whole study"),
        Column::number("measured".to_owned(), "Those whose scene, pipeline and values were measured"),
        Column::number("References".to_owned(), ""),
        Column::number("measured".to_owned(), "Those that were rendered"),
    ];
    columns.extend(GPUS.map(|gpus| Column::number(gpus_text(gpus), "Until the last shard has ended")));
    columns.extend(
        GPUS.map(|gpus| Column::number(format!("exponent on {gpus}"), "Time ∝ cellsᵖ, with twice the seeds")),
    );
    let mut all = Costs::default();
    studies.iter().for_each(|(_, costs)| all.join(costs));
    let row = |(plan, costs): &(Plan, Costs)| {
        let work = Work::new(plan, &costs.or(&all));
        let mut row = vec![Entry::Text(plan.study.name.clone())];
        let counts = [
            work.cells.len(),
            costs.measured_cells(plan),
            work.references.len(),
            costs.measured_references(plan),
        ];
        row.extend(counts.map(|count| Entry::Text(count.to_string())));
        row.extend(GPUS.map(|gpus| Entry::Text(duration(work.seconds(gpus)))));
        row.extend(GPUS.map(|gpus| Entry::Text(exponent(work.exponent(gpus)))));
        row
    };
    let caption = "Each GPU takes the next shard of 20 minutes as soon as it is free, references first; without the time in \
                   queues. A cell that was not measured takes as long as those of the same scene and pipeline, or of the \
                   same pipeline, scene or study, or of other studies where none of it was measured: all in proportion to \
                   pixels × frames, and references to samples too. An exponent p is of time ∝ cellsᵖ, where the seeds are \
                   doubled.";
    Table {
        name: "costs".to_owned(),
        caption: caption.to_owned(),
        columns,
        rows: studies.iter().map(row).collect(),
    }
}

/// Formats an exponent: 0 has no sign.
fn exponent(value: f64) -> String {
    format!("{:.2}", (100.0 * value).round() / 100.0 + 0.0)
}

fn gpus_text(gpus: usize) -> String {
    if gpus == 1 { "1 GPU".to_owned() } else { format!("{gpus} GPUs") }
}

/// Formats seconds in the unit that suits them.
fn duration(seconds: f64) -> String {
    let (unit, name) = match seconds {
        s if s < 120.0 => (1.0, "s"),
        s if s < 7200.0 => (60.0, "min"),
        s if s < 172_800.0 => (3600.0, "h"),
        _ => (86400.0, "days"),
    };
    format!("{} {name}", number::short(seconds / unit, 2))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn work(references: &[f64], cells: usize, seconds: f64) -> Work {
        Work { references: references.to_vec(), cells: vec![seconds; cells], units: singly(cells) }
    }

    #[test]
    fn time_is_that_of_the_last_shard() {
        // 96 shards of 20 minutes: 32 hours; 12 rounds of 8; 64 and then 32.
        let whole = work(&[], 96 * 20, 60.0);
        assert_eq!(GPUS.map(|gpus| whole.seconds(gpus) / 1200.0), [96.0, 12.0, 2.0]);
        // A single reference of half an hour is before them all.
        let with = work(&[1800.0], 96 * 20, 60.0);
        assert_eq!(GPUS.map(|gpus| with.seconds(gpus) / 1200.0), [97.5, 13.5, 3.5]);
    }

    #[test]
    fn exponents_are_those_of_twice_the_cells() {
        let whole = work(&[], 96 * 20, 60.0);
        assert_eq!(GPUS.map(|gpus| whole.exponent(gpus)), [1.0, 1.0, (1.5_f64).log2()]);
        // A shard each: the others have room for as many again.
        assert_eq!(work(&[], 64 * 10, 60.0).exponent(64), 0.0);
        let with = work(&[1200.0 * 96.0], 96 * 20, 60.0);
        assert_eq!(with.exponent(1), (1.5_f64).log2(), "references stay");
    }

    #[test]
    fn durations_are_readable() {
        assert_eq!([5.0, 600.0, 36_000.0, 864_000.0].map(duration), ["5 s", "10 min", "10 h", "10 days"]);
        assert_eq!([-0.001, 0.376, -0.5].map(exponent), ["0.00", "0.38", "-0.50"]);
    }
}
