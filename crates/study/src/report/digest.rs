//! Groups cells for the report: one row for each scene, pipeline and combination of values, over its seeds. Where several
//! adapters ran the cells, each has rows of its own: times are over the cells of one adapter, errors over those of all.

use std::collections::BTreeMap;

use report::number;

use crate::claim::Seeds;
use crate::phase::SHARE;
use crate::{Axis, AxisValue, Cell, Interval, MeasureInfo, Outcome, Results};

/// The measure that is a pipeline's GPU time; if a study does not have it, the sum of the passes is used.
pub(super) const TIME: &str = "gpu-ms";

/// Returns whether a measure is a GPU time, of a frame or of a phase, or the share of a phase: those of two adapters are not
/// comparable.
pub(crate) fn is_time(key: &str) -> bool {
    key.strip_prefix(TIME).is_some_and(|rest| rest.is_empty() || rest.starts_with(':'))
        || key.starts_with(SHARE)
}

/// Results in the order in which tables and charts show them.
pub(crate) struct Digest<'a> {
    pub(super) results: &'a Results,
    /// Names of the scenes: in the order of the study, then any that only cells name.
    pub(super) scenes: Vec<&'a str>,
    /// Names of the pipelines, likewise; where several adapters ran the cells, each with an adapter.
    pub(super) pipelines: Vec<String>,
    /// Names of the pipelines alone.
    names: Vec<&'a str>,
    /// Number of adapters that ran the cells.
    pub(super) adapters: usize,
    /// Rows by scene, pipeline and values, in the study's order.
    pub(crate) rows: Vec<Row<'a>>,
    /// The values that each axis takes among the rows, in the study's order.
    pub(super) taken: Vec<Vec<&'a AxisValue>>,
}

/// A scene, a pipeline and a value of each axis.
pub(crate) struct Row<'a> {
    /// Index into [`Digest::scenes`].
    pub(super) scene: usize,
    /// Index into [`Digest::pipelines`].
    pub(super) pipeline: usize,
    /// Value of each of the study's axes; `None` if the cells do not have it.
    pub(super) values: Vec<Option<&'a AxisValue>>,
    /// The cells of one adapter, sorted by seed.
    pub(crate) cells: Vec<&'a Cell>,
    /// Cells of other adapters: their errors count as those of this one do.
    others: Vec<&'a Cell>,
}

impl<'a> Digest<'a> {
    pub(crate) fn new(results: &'a Results) -> Digest<'a> {
        let study = &results.study;
        let cells = || results.cells.iter();
        let scenes = study.scenes.iter().map(|scene| &*scene.name);
        let scenes = distinct(scenes.chain(cells().map(|cell| &*cell.scene)));
        let pipelines = study.pipelines.iter().map(|pipeline| &*pipeline.name);
        let pipelines = distinct(pipelines.chain(cells().map(|cell| &*cell.pipeline)));
        let adapters = adapters(results);
        let mut rows: Vec<Row<'_>> = Vec::new();
        for cell in &results.cells {
            let scene = position(&scenes, &cell.scene);
            let adapter = adapters.iter().position(|(own, _)| *own == cell.node.adapter).unwrap_or(0);
            let pipeline = position(&pipelines, &cell.pipeline) * adapters.len() + adapter;
            let values: Vec<_> = study.axes.iter().map(|axis| cell.axes.get(&axis.name)).collect();
            let same =
                |row: &&mut Row<'_>| (row.scene, row.pipeline) == (scene, pipeline) && row.values == values;
            match rows.iter_mut().find(same) {
                Some(row) => row.cells.push(cell),
                None => rows.push(Row { scene, pipeline, values, cells: vec![cell], others: Vec::new() }),
            }
        }
        // What a budget of time gives is of its adapter: lights, frames, and so the error.
        if adapters.len() > 1 && !study.budget_of_time {
            let all: Vec<(usize, usize, Vec<_>, Vec<&Cell>)> = rows
                .iter()
                .map(|row| (row.scene, row.pipeline, row.values.clone(), row.cells.clone()))
                .collect();
            for row in &mut rows {
                let same = all.iter().filter(|(scene, pipeline, values, _)| {
                    *scene == row.scene
                        && *pipeline != row.pipeline
                        && pipeline / adapters.len() == row.pipeline / adapters.len()
                        && *values == row.values
                });
                row.others = same.flat_map(|(_, _, _, cells)| cells.iter().copied()).collect();
            }
        }
        for row in &mut rows {
            row.cells.sort_by_key(|cell| cell.seed);
        }
        let name = |pipeline: &str| -> Vec<String> {
            adapters.iter().map(|(_, suffix)| format!("{pipeline}{suffix}")).collect()
        };
        let names = pipelines;
        let pipelines = names.iter().copied().flat_map(name).collect();
        let adapters = adapters.len();
        // Values that are not in the study come last, in the order of the cells: the sort is stable.
        let rank = |row: &Row<'_>| -> Vec<usize> {
            let places = study.axes.iter().zip(&row.values).map(|(axis, value)| {
                axis.values.iter().position(|v| Some(v) == *value).unwrap_or(usize::MAX)
            });
            [row.scene, row.pipeline].into_iter().chain(places).collect()
        };
        rows.sort_by_cached_key(rank);
        let taken = (0..study.axes.len()).map(|axis| taken(&study.axes[axis], axis, &rows)).collect();
        Digest { results, scenes, pipelines, names, adapters, rows, taken }
    }

    /// Returns the groups of rows whose values of a measure are comparable, by their indices: all, or those of each adapter.
    pub(super) fn comparable(&self, rows: &[&Row<'a>], key: &str) -> Vec<Vec<usize>> {
        if !is_time(key) && !self.results.study.budget_of_time {
            return vec![(0..rows.len()).collect()];
        }
        let of = |adapter: usize| {
            (0..rows.len()).filter(|row| rows[*row].pipeline % self.adapters == adapter).collect()
        };
        (0..self.adapters).map(of).collect()
    }

    /// Returns the curves of a measure: the name of each, and the index of its pipeline in `pipelines`. Where the cells of all
    /// adapters count, a pipeline has one.
    pub(super) fn curves(&self, key: &str) -> Vec<(String, Vec<usize>)> {
        if is_time(key) || self.results.study.budget_of_time {
            return self.pipelines.iter().cloned().zip((0..).map(|index| vec![index])).collect();
        }
        let all = |place: usize| (place * self.adapters..(place + 1) * self.adapters).collect();
        self.names.iter().enumerate().map(|(place, name)| ((*name).to_owned(), all(place))).collect()
    }

    /// Says for captions which cells the errors are of, where several adapters ran them.
    pub(super) fn errors_are_of(&self) -> &'static str {
        if self.results.study.budget_of_time {
            "so are errors, since the budget is one of time"
        } else {
            "errors are over the cells of all"
        }
    }

    /// Returns the rows of a scene.
    pub(super) fn of_scene(&self, scene: usize) -> impl Iterator<Item = &Row<'a>> {
        self.rows.iter().filter(move |row| row.scene == scene)
    }

    /// Returns the error of the reference of a scene itself, in a measure: see [`crate::StudyRecord::noise`].
    pub(super) fn noise(&self, scene: usize, measure: &MeasureInfo) -> Option<f64> {
        self.results.study.noise(self.scenes[scene], &measure.key)
    }

    /// Returns the axes that have at least two values among the rows.
    pub(super) fn varied(&self) -> Vec<usize> {
        (0..self.taken.len()).filter(|&axis| self.taken[axis].len() > 1).collect()
    }

    /// Returns the axes to plot over, each with the axes that vary independently of it. Of axes that vary
    /// together, as those of `Paired` do, only the one that determines the others is plotted over.
    pub(super) fn leading(&self) -> Vec<(usize, Vec<usize>)> {
        let varied = self.varied();
        let follows = |axis: usize| {
            varied.iter().any(|&other| {
                other != axis
                    && self.determines(other, axis)
                    && (other < axis || !self.determines(axis, other))
            })
        };
        let leads = varied.iter().copied().filter(|&axis| !follows(axis));
        leads
            .map(|axis| {
                let free = |&other: &usize| other != axis && !self.determines(axis, other);
                (axis, varied.iter().copied().filter(free).collect())
            })
            .collect()
    }

    /// Returns whether the value of one axis determines that of another, in each pipeline.
    fn determines(&self, axis: usize, other: usize) -> bool {
        let mut said = BTreeMap::new();
        self.rows.iter().all(|row| {
            let place =
                |axis: usize| row.values[axis].and_then(|v| self.taken[axis].iter().position(|t| *t == v));
            *said.entry((row.pipeline, place(axis))).or_insert(place(other)) == place(other)
        })
    }

    /// Formats the values of a row on some of the axes: `lights = 64, filter = true`.
    pub(super) fn values_text(&self, row: &Row<'_>, axes: &[usize]) -> String {
        let text = |&axis: &usize| {
            let value = row.values[axis].map_or_else(|| "–".to_owned(), ToString::to_string);
            let axis = &self.results.study.axes[axis];
            let unit = if axis.unit.is_empty() { String::new() } else { format!(" {}", axis.unit) };
            format!("{} = {value}{unit}", axis.name)
        };
        axes.iter().map(text).collect::<Vec<_>>().join(", ")
    }

    /// Formats a row as a line of text: `ISM, lights = 64`.
    pub(super) fn row_text(&self, row: &Row<'_>) -> String {
        match self.values_text(row, &self.varied()) {
            values if values.is_empty() => self.pipelines[row.pipeline].clone(),
            values => format!("{}, {values}", self.pipelines[row.pipeline]),
        }
    }

    /// Returns the label of the axis of GPU time.
    pub(super) fn time_label(&self) -> String {
        let info = self.results.study.measures.iter().find(|measure| measure.key == TIME);
        info.map_or_else(|| "GPU time [ms]".to_owned(), label_with_unit)
    }

    /// Returns the measures that have a value in some row.
    pub(super) fn measured(&self) -> impl Iterator<Item = &'a MeasureInfo> {
        let measures = self.results.study.measures.iter();
        measures.filter(|measure| self.rows.iter().any(|row| row.summary(&measure.key).is_some()))
    }

    /// Returns the measures of the columns of some rows: of pictures, all that have a value anywhere; otherwise those that have one
    /// there, since each case may have its own.
    pub(super) fn measured_in(&self, rows: &[&Row<'a>]) -> impl Iterator<Item = &'a MeasureInfo> {
        let is_there = |measure: &&MeasureInfo| rows.iter().any(|row| row.summary(&measure.key).is_some());
        self.measured().filter(move |measure| self.has_pictures() || is_there(measure))
    }

    /// Returns whether the cells are pictures.
    pub(super) fn has_pictures(&self) -> bool {
        !self.results.study.output.is_empty()
    }
}

impl Row<'_> {
    /// Returns the finished cells of the row's adapter.
    pub(super) fn done(&self) -> impl Iterator<Item = &Cell> {
        self.cells.iter().copied().filter(|cell| cell.outcome == Outcome::Done)
    }

    /// Returns the finished cells whose values of a measure are comparable: those of all adapters, unless it is a time.
    fn comparable(&self, key: &str) -> impl Iterator<Item = &Cell> {
        let others = if is_time(key) { &[] } else { &self.others[..] };
        self.done().chain(others.iter().copied().filter(|cell| cell.outcome == Outcome::Done))
    }

    /// Returns the first error, and the number of failed cells.
    pub(super) fn failure(&self) -> Option<(&str, usize)> {
        let mut errors = self.cells.iter().filter_map(|cell| match &cell.outcome {
            Outcome::Failed { error } => Some(&**error),
            Outcome::Done => None,
        });
        let first = errors.next()?;
        Some((first, 1 + errors.count()))
    }

    /// Returns mean and interval of a measure over the seeds; `None` if no seed has it. Failed cells are left out, even if
    /// they have measurements: those are only in `cells.csv`.
    pub(crate) fn summary(&self, key: &str) -> Option<Interval> {
        over(self.comparable(key), |cell| cell.measures.get(key).copied().flatten())
    }

    /// Returns the value of a measure of each seed; `None` if no seed has it.
    pub(super) fn seeds(&self, key: &str) -> Option<Seeds> {
        let value = |cell: &Cell| cell.measures.get(key).copied().flatten().filter(|value| value.is_finite());
        let seeds: Seeds = self.comparable(key).filter_map(|cell| Some((cell.seed, value(cell)?))).collect();
        (!seeds.is_empty()).then_some(seeds)
    }

    /// Returns mean and interval of a measure over the seeds in each frame that has it, by frame number.
    pub(super) fn frames(&self, key: &str) -> Vec<(u32, Interval)> {
        let mut found: BTreeMap<u32, Vec<f64>> = BTreeMap::new();
        for series in self.comparable(key).map(|cell| &cell.series) {
            let column = series.values.get(key).into_iter().flatten();
            for (frame, value) in (series.first..).zip(column) {
                found.entry(frame).or_default().extend(value.filter(|value| value.is_finite()));
            }
        }
        found.into_iter().filter_map(|(frame, values)| Some((frame, Interval::of(&values)?))).collect()
    }

    /// Returns the GPU time of a frame [ms] over the seeds.
    pub(super) fn time(&self) -> Option<Interval> {
        self.summary(TIME).or_else(|| {
            over(self.done(), |cell| {
                let sum: f64 = cell.passes.iter().map(|pass| pass.gpu_ms).sum();
                (sum > 0.0).then_some(sum)
            })
        })
    }

    /// Returns the mean GPU time of each pass [ms], in the order of the plan.
    pub(super) fn passes(&self) -> Vec<(String, f64)> {
        let mut sums: Vec<(String, f64)> = Vec::new();
        for pass in self.done().flat_map(|cell| &cell.passes) {
            if !pass.gpu_ms.is_finite() {
                continue;
            }
            match sums.iter_mut().find(|(name, _)| *name == pass.pass) {
                Some((_, sum)) => *sum += pass.gpu_ms,
                None => sums.push((pass.pass.clone(), pass.gpu_ms)),
            }
        }
        let timed = self.done().filter(|cell| !cell.passes.is_empty()).count().max(1) as f64;
        sums.into_iter().map(|(name, sum)| (name, sum / timed)).collect()
    }

    /// Formats the value that the budget determined: `lights = 480`; a range if the seeds differ.
    pub(super) fn chosen(&self, name: &str) -> Option<String> {
        let values = distinct(self.done().filter_map(|cell| cell.chosen.get(name)));
        let numbers: Option<Vec<f64>> = values
            .iter()
            .map(|value| if let AxisValue::Number(number) = value { Some(*number) } else { None })
            .collect();
        match (numbers, values.as_slice()) {
            (_, []) => None,
            (_, [only]) => Some(only.to_string()),
            (Some(numbers), _) => {
                let (low, high) =
                    numbers.iter().fold((f64::MAX, f64::MIN), |(l, h), n| (l.min(*n), h.max(*n)));
                Some(format!("{}–{}", number::plain(low), number::plain(high)))
            }
            (None, values) => Some(values.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")),
        }
    }
}

/// Returns the mean of a value over cells, with its interval.
fn over<'a>(cells: impl Iterator<Item = &'a Cell>, value: impl Fn(&Cell) -> Option<f64>) -> Option<Interval> {
    let values: Vec<f64> = cells.filter_map(value).filter(|value| value.is_finite()).collect();
    Interval::of(&values)
}

/// Returns the adapters of the finished cells, each with what is added to the names of its pipelines: nothing where there is
/// one adapter; otherwise its name, with its driver where others have the same name.
fn adapters(results: &Results) -> Vec<(&str, String)> {
    let all = results.adapters();
    if all.len() < 2 {
        return vec![(all.first().copied().unwrap_or_default(), String::new())];
    }
    let short = |adapter: &'_ str| adapter.split(" (").next().unwrap_or_default().to_owned();
    let suffix = |adapter: &&str| {
        let own = short(adapter);
        let is_single = all.iter().filter(|other| short(other) == own).count() == 1;
        format!(" · {}", if is_single { own } else { (*adapter).to_owned() })
    };
    all.iter().map(|adapter| (*adapter, suffix(adapter))).collect()
}

/// Formats a label with its unit: `relMSE`, `GPU time [ms]`.
pub(super) fn label_with_unit(measure: &MeasureInfo) -> String {
    if measure.unit.is_empty() {
        measure.label.clone()
    } else {
        format!("{} [{}]", measure.label, measure.unit)
    }
}

/// Returns the values of an axis that rows have: first those that it declares, then others.
fn taken<'a>(declared: &'a Axis, axis: usize, rows: &[Row<'a>]) -> Vec<&'a AxisValue> {
    let mut found = distinct(rows.iter().filter_map(|row| row.values[axis]));
    let place = |value: &&AxisValue| declared.values.iter().position(|v| v == *value).unwrap_or(usize::MAX);
    found.sort_by_key(place);
    found
}

/// Returns each element once, in the order of its first place.
pub(crate) fn distinct<T: PartialEq>(all: impl IntoIterator<Item = T>) -> Vec<T> {
    let mut found = Vec::new();
    for one in all {
        if !found.contains(&one) {
            found.push(one);
        }
    }
    found
}

fn position(names: &[&str], name: &str) -> usize {
    names.iter().position(|n| *n == name).unwrap_or(names.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_that_failed_take_no_part_in_means() {
        let cell = |value: f64, outcome| Cell {
            outcome,
            measures: BTreeMap::from([("rmse".to_owned(), Some(value))]),
            ..Cell::default()
        };
        let failed = Outcome::Failed { error: "1 pixel is NaN".into() };
        let cells = [cell(1.0, Outcome::Done), cell(3.0, Outcome::Done), cell(1e9, failed)];
        let row = Row {
            scene: 0,
            pipeline: 0,
            values: Vec::new(),
            cells: cells.iter().collect(),
            others: Vec::new(),
        };
        let mean = row.summary("rmse").unwrap();
        assert_eq!((mean.seeds, mean.mean), (2, 2.0));
    }
}
