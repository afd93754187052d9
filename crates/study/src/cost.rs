//! Expected costs of cells and references, from the records of a run; and shards of alike cost.

use crate::error::StudyError;
use crate::folder::{read_json, read_study, row, rows};
use crate::plan::{Plan, PlannedCell, PlannedReference};
use crate::record::{AxisValue, Cell, ReferenceRecord, Results};
use std::collections::{BTreeMap, HashMap};
use std::ops::Range;
use std::path::Path;
use std::time::Duration;

/// Seconds of a cell or reference of which nothing is known.
pub const UNKNOWN_SECONDS: f64 = 10.0;

/// The expected time of a shard of a batch system, in minutes.
pub const SHARD_MINUTES: f64 = 20.0;

/// What cells have in common: scene, pipeline and values; an empty text or `None` is any.
type Like = (String, String, Option<String>);

/// Seconds that cells and references took, by which those of others are estimated.
#[derive(Clone, Debug, Default)]
pub struct Costs {
    cells: HashMap<Like, Measured>,
    /// By scene and source.
    references: HashMap<(String, String), Measured>,
}

/// The sums of what runs took.
#[derive(Clone, Copy, Debug, Default)]
struct Measured {
    seconds: f64,
    /// Pixels × frames × samples; NaN if those of a run are unknown.
    work: f64,
    count: usize,
}

impl Measured {
    fn add(&mut self, other: Measured) {
        self.seconds += other.seconds;
        self.work += other.work;
        self.count += other.count;
    }

    fn one(seconds: f64, work: f64) -> Measured {
        Measured { seconds, work: if work > 0.0 { work } else { f64::NAN }, count: 1 }
    }

    /// Returns how many times the mean work of these is in `work`; 1 if unknown.
    fn times(&self, work: f64) -> f64 {
        let times = work * self.count as f64 / self.work;
        if times > 0.0 && times.is_finite() { times } else { 1.0 }
    }

    /// Returns the expected seconds of a run: in proportion to its work.
    fn of(&self, work: f64) -> f64 {
        self.seconds / self.count as f64 * self.times(work)
    }
}

/// The scene, the pipeline, the values and the work of a cell.
pub(crate) type Kind<'a> = (&'a str, &'a str, &'a BTreeMap<String, AxisValue>, f64);

impl Costs {
    /// Reads the costs of the cells and references in the folder of a study. The records may be of an earlier version, or of
    /// a part of the study.
    ///
    /// # Errors
    /// Where there is no study.
    pub fn read(folder: &Path) -> Result<Costs, StudyError> {
        read_study(folder)?;
        let mut costs = Costs::default();
        for key in rows(folder) {
            if let Ok(cell) = read_json::<Cell>(&row(folder, &key)) {
                costs.add(&cell);
            }
        }
        for reference in Results::references(folder)? {
            costs.add_reference(&reference);
        }
        Ok(costs)
    }

    /// Adds what a cell took.
    pub(crate) fn add(&mut self, cell: &Cell) {
        for like in alike((&cell.scene, &cell.pipeline, &cell.axes, cell.work)) {
            self.cells.entry(like).or_default().add(Measured::one(cell.seconds, cell.work));
        }
    }

    fn add_reference(&mut self, reference: &ReferenceRecord) {
        if reference.seconds > 0.0 {
            let key = (reference.scene.clone(), reference.from.clone());
            self.references.insert(key, Measured::one(reference.seconds, reference.work));
        }
    }

    /// Adds the costs of another study, as far as the work is known by which they count for others.
    pub(crate) fn join(&mut self, other: &Costs) {
        for (like, known) in other.cells.iter().filter(|(_, known)| known.work.is_finite()) {
            self.cells.entry(like.clone()).or_default().add(*known);
        }
        for (source, known) in other.references.iter().filter(|(_, known)| known.work.is_finite()) {
            self.references.entry(source.clone()).or_default().add(*known);
        }
    }

    /// Returns these costs, with those of `others` for cells or references if none of them is known.
    pub(crate) fn or(&self, others: &Costs) -> Costs {
        let cells = if self.cells.is_empty() { &others.cells } else { &self.cells };
        let references = if self.references.is_empty() { &others.references } else { &self.references };
        Costs { cells: cells.clone(), references: references.clone() }
    }

    /// Returns the number of cells that are known.
    pub fn cell_count(&self) -> usize {
        self.cells.get(&any()).map_or(0, |known| known.count)
    }

    /// Returns the expected seconds of a cell: the mean of those of the same scene, pipeline and values; or else of the same
    /// scene and pipeline; of the same pipeline; of the same scene; of all. Those of another size, or with another number of
    /// frames, count in proportion to pixels × frames. `None` if nothing is known.
    pub(crate) fn cell(&self, kind: Kind<'_>) -> Option<f64> {
        let known = alike(kind).into_iter().find_map(|like| self.cells.get(&like));
        known.map(|known| known.of(kind.3))
    }

    /// Returns the number of cells of a plan of whose scene, pipeline and values a cell of the same work is known: the costs of
    /// the others are estimates.
    pub(crate) fn measured_cells(&self, plan: &Plan) -> usize {
        let is_measured = |kind: Kind<'_>| {
            let [closest, ..] = alike(kind);
            self.cells.get(&closest).is_some_and(|known| known.times(kind.3) == 1.0)
        };
        plan.cells.iter().filter(|cell| is_measured(plan.kind(cell))).count()
    }

    /// Returns the number of references of a plan that are known.
    pub(crate) fn measured_references(&self, plan: &Plan) -> usize {
        let is_measured = |reference: &&PlannedReference| {
            let known = self.references.get(&plan.source_of(reference));
            known.is_some_and(|known| known.times(reference.origin.work()) == 1.0)
        };
        plan.references.iter().filter(is_measured).count()
    }

    /// Returns the expected seconds of each cell of a plan.
    pub fn of_cells(&self, plan: &Plan) -> Vec<f64> {
        let seconds = |cell| self.cell(plan.kind(cell)).unwrap_or(UNKNOWN_SECONDS);
        plan.cells.iter().map(seconds).collect()
    }

    /// Returns the expected seconds of each reference of a plan: of the same one, or else of those of the same scene, or of
    /// all, in proportion to pixels × frames × samples.
    pub fn of_references(&self, plan: &Plan) -> Vec<f64> {
        let sum = |scene: Option<&str>| {
            let of = self.references.iter().filter(|((own, _), _)| scene.is_none_or(|scene| own == scene));
            let mut sum = Measured::default();
            of.for_each(|(_, known)| sum.add(*known));
            (sum.count > 0).then_some(sum)
        };
        let seconds = |reference: &PlannedReference| {
            let source = plan.source_of(reference);
            let own = self.references.get(&source).copied();
            let known = own.or_else(|| sum(Some(&source.0))).or_else(|| sum(None));
            known.map_or(UNKNOWN_SECONDS, |known| known.of(reference.origin.work()))
        };
        plan.references.iter().map(seconds).collect()
    }

    /// Returns an estimate of the time of these cells.
    pub(crate) fn estimate<'a>(&self, cells: impl Iterator<Item = Kind<'a>>) -> Duration {
        let seconds = cells.map(|kind| self.cell(kind).unwrap_or(0.0)).sum();
        Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX)
    }
}

fn any() -> Like {
    (String::new(), String::new(), None)
}

/// Returns what a cell has in common with others, the closest first.
fn alike((scene, pipeline, axes, _): Kind<'_>) -> [Like; 5] {
    let [scene, pipeline] = [scene, pipeline].map(str::to_owned);
    [
        (scene.clone(), pipeline.clone(), Some(format!("{axes:?}"))),
        (scene.clone(), pipeline.clone(), None),
        (String::new(), pipeline, None),
        (scene, String::new(), None),
        any(),
    ]
}

impl Plan {
    /// Returns the shards of a batch system: consecutive cells of about as many minutes. With [`SHARD_MINUTES`], each takes 10 to
    /// 30 where no cell takes more than 5 and all together no less than 10. Where a budget of time searches for a value, the
    /// seeds that share it stay together.
    pub fn shards(&self, costs: &Costs, minutes: f64) -> Vec<Range<usize>> {
        let seconds = costs.of_cells(self);
        cut(&seconds, &self.units(), parts_of(&seconds, minutes))
    }

    /// Returns the same of the references.
    pub fn reference_shards(&self, costs: &Costs, minutes: f64) -> Vec<Range<usize>> {
        let seconds = costs.of_references(self);
        cut(&seconds, &singly(seconds.len()), parts_of(&seconds, minutes))
    }

    /// Returns the shards if there are to be `parts` of alike cost; some may be empty.
    pub fn parts(&self, costs: &Costs, parts: u32) -> Vec<Range<usize>> {
        cut(&costs.of_cells(self), &self.units(), parts as usize)
    }

    /// Returns the ranges of cells that belong in one shard.
    pub(crate) fn units(&self) -> Vec<Range<usize>> {
        let mut units: Vec<Range<usize>> = Vec::new();
        for (index, cell) in self.cells.iter().enumerate() {
            let is_same = |first: usize| {
                let first = &self.cells[first];
                cell.search.is_some()
                    && (first.scene, first.pipeline) == (cell.scene, cell.pipeline)
                    && first.axes == cell.axes
            };
            match units.last_mut() {
                Some(unit) if is_same(unit.start) => unit.end = index + 1,
                _ => units.push(index..index + 1),
            }
        }
        units
    }

    pub(crate) fn kind<'a>(&'a self, cell: &'a PlannedCell) -> Kind<'a> {
        let scene = self.scenes[cell.scene].record.name.as_str();
        (scene, &self.pipelines[cell.pipeline].name, &cell.axes, cell.request.work())
    }

    /// Returns the scene and the source of a reference.
    fn source_of(&self, reference: &PlannedReference) -> (String, String) {
        (self.scenes[reference.scene].record.name.clone(), reference.from.clone())
    }
}

pub(crate) fn singly(count: usize) -> Vec<Range<usize>> {
    (0..count).map(|index| index..index + 1).collect()
}

/// Returns the number of shards of about as many minutes: no more than there are items.
pub(crate) fn parts_of(seconds: &[f64], minutes: f64) -> usize {
    let parts = (seconds.iter().sum::<f64>() / (60.0 * minutes)).round() as usize;
    parts.clamp(1, seconds.len().max(1))
}

/// Cuts units of consecutive items into `parts` ranges of items, each with the units whose middle lies in its share of all
/// seconds: the cost of a range differs from the mean by no more than that of its largest unit.
pub(crate) fn cut(seconds: &[f64], units: &[Range<usize>], parts: usize) -> Vec<Range<usize>> {
    let total: f64 = seconds.iter().sum();
    let mut ranges = vec![0..0; parts];
    let mut before = 0.0;
    let mut end = 0;
    let mut part = 0;
    for unit in units {
        let cost: f64 = seconds[unit.clone()].iter().sum();
        let middle = (before + cost / 2.0) / total.max(f64::MIN_POSITIVE) * parts as f64;
        before += cost;
        let own = (middle as usize).clamp(part, parts - 1);
        while part < own {
            part += 1;
            ranges[part] = end..end;
        }
        end = unit.end;
        ranges[part].end = end;
    }
    for range in &mut ranges[part + 1..] {
        *range = end..end;
    }
    ranges
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn cell(pipeline: &str, lights: f64, seconds: f64) -> Cell {
        let axes = BTreeMap::from([("lights".to_owned(), AxisValue::Number(lights))]);
        let (scene, pipeline) = ("box".to_owned(), pipeline.to_owned());
        Cell { scene, pipeline, axes, seconds, ..Cell::default() }
    }

    #[test]
    fn cells_take_as_long_as_their_like_or_as_all() {
        let mut costs = Costs::default();
        let axes = |lights: f64| BTreeMap::from([("lights".to_owned(), AxisValue::Number(lights))]);
        assert_eq!(costs.estimate([("box", "slow", &axes(1.0), 0.0)].into_iter()), Duration::ZERO);
        for (pipeline, lights, seconds) in
            [("slow", 1.0, 10.0), ("slow", 1.0, 14.0), ("slow", 9.0, 24.0), ("fast", 1.0, 4.0)]
        {
            costs.add(&cell(pipeline, lights, seconds));
        }
        // The same values; then the mean of the same pipeline; of another scene too; and of another pipeline that of all.
        let (one, two) = (axes(1.0), axes(2.0));
        assert_eq!(costs.cell(("box", "slow", &one, 100.0)), Some(12.0));
        assert_eq!(costs.cell(("box", "slow", &two, 100.0)), Some(16.0));
        assert_eq!(costs.cell(("hall", "slow", &two, 100.0)), Some(16.0));
        assert_eq!(costs.cell(("hall", "new", &two, 100.0)), Some(13.0));
        let left = costs.estimate([("box", "slow", &one, 100.0), ("box", "fast", &two, 100.0)].into_iter());
        assert_eq!(left, Duration::from_secs(16));
    }

    #[test]
    fn more_work_takes_longer() {
        let mut costs = Costs::default();
        costs.add(&Cell { work: 100.0, ..cell("slow", 1.0, 10.0) });
        costs.add(&Cell { work: 300.0, ..cell("slow", 2.0, 20.0) });
        let axes = |lights: f64| BTreeMap::from([("lights".to_owned(), AxisValue::Number(lights))]);
        let of = |lights: f64, work: f64| costs.cell(("box", "slow", &axes(lights), work));
        assert_eq!([of(1.0, 100.0), of(1.0, 400.0)], [Some(10.0), Some(40.0)]);
        // The mean is 15 seconds for 200; that of an unknown amount of work stays.
        assert_eq!([of(3.0, 200.0), of(3.0, 400.0), of(3.0, 0.0)], [Some(15.0), Some(30.0), Some(15.0)]);
        // A record of an earlier version does not have its work.
        costs.add(&cell("slow", 1.0, 30.0));
        assert_eq!(costs.cell(("box", "slow", &axes(1.0), 400.0)), Some(20.0));
    }

    #[test]
    fn a_study_without_costs_takes_those_of_others() {
        let (mut own, mut other, mut all) = (Costs::default(), Costs::default(), Costs::default());
        other.add(&Cell { work: 100.0, ..cell("slow", 1.0, 10.0) });
        other.references.insert(("box".to_owned(), "truth".to_owned()), Measured::one(40.0, 8.0));
        all.join(&other);
        all.join(&other);
        let axes = BTreeMap::new();
        let kind = ("box", "slow", &axes, 200.0);
        assert_eq!(own.or(&all).cell(kind), Some(20.0));
        assert_eq!(own.or(&all).references.values().next().map(|known| known.of(4.0)), Some(20.0));
        // Of a study whose cells a time ends.
        let mut timed = Costs::default();
        timed.add(&cell("slow", 1.0, 1000.0));
        all.join(&timed);
        assert_eq!(own.or(&all).cell(kind), Some(20.0));
        own.add(&Cell { work: 100.0, ..cell("fast", 1.0, 1.0) });
        assert_eq!(own.or(&all).cell(kind), Some(2.0), "its own are nearer");
        assert_eq!(own.or(&all).references.len(), 1);
    }

    proptest! {
        /// Every cell is in one shard, in order; none differs from the mean by more than its largest unit.
        #[test]
        fn shards_are_alike(seconds in prop::collection::vec(0.01_f64..300.0, 1..200), parts in 1_usize..20) {
            let ranges = cut(&seconds, &singly(seconds.len()), parts);
            prop_assert_eq!(ranges.len(), parts);
            let all: Vec<usize> = ranges.iter().cloned().flatten().collect();
            prop_assert_eq!(all, (0..seconds.len()).collect::<Vec<_>>());
            let mean = seconds.iter().sum::<f64>() / parts as f64;
            let largest = seconds.iter().copied().fold(0.0, f64::max);
            for range in ranges {
                let sum: f64 = seconds[range].iter().sum();
                prop_assert!((sum - mean).abs() <= largest + 1e-6, "{} of {}", sum, mean);
            }
        }

        /// Where cells take at most 5 minutes, shards take 10 to 30.
        #[test]
        fn shards_take_ten_to_thirty_minutes(seconds in prop::collection::vec(1.0_f64..300.0, 600..700)) {
            for range in cut(&seconds, &singly(seconds.len()), parts_of(&seconds, SHARD_MINUTES)) {
                let minutes = seconds[range].iter().sum::<f64>() / 60.0;
                prop_assert!((10.0..=30.0).contains(&minutes), "{}", minutes);
            }
        }
    }

    #[test]
    fn units_are_not_cut() {
        let seconds = [1.0; 6];
        assert_eq!(cut(&seconds, &singly(6), 2), [0..3, 3..6]);
        assert_eq!(cut(&seconds, &[0..2, 2..4, 4..6], 2), [0..2, 2..6]);
        assert_eq!(cut(&[], &[], 2), [0..0, 0..0]);
        assert_eq!(cut(&[5.0], &singly(1), 3), [0..0, 0..1, 1..1]);
    }
}
