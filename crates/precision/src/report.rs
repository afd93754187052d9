//! Probes as the cases of a study.

use crate::measure::{Errors, Evaluator, MOST_LOST, Measured, Options, Point, ROUNDING, measure};
use crate::probe::Probe;
use data_file::Value;
use report::{Column, Entry, Table};
use std::path::Path;
use study::{
    Axis, AxisValue, Cell, Claim, Failure, MeasureInfo, Pick, PipelineRecord, Ran, Relation, SceneRecord,
    StudyError, StudyRecord, Words, measure_cases,
};

/// What is compared: results in `f32`, and those that no formula makes more exact.
const SUBJECTS: [(&str, &str); 2] = [
    ("f32", "the function as it is computed"),
    ("unavoidable", "a result in f64 that is rounded, of inputs that are off by the rounding of f32"),
];

const MAGNITUDE: &str = "magnitude";
const ERROR: &str = "error";
const MEDIAN: &str = "median";
const LOST: &str = "lost";

/// Measures probes as the cases of a study in a folder: errors by magnitude, with the claim of each probe where its error is the
/// greatest multiple of the unavoidable one. Calls `begin` with the name of each probe. Returns what was measured, without
/// the probes that failed.
///
/// # Errors
/// Fails if a file cannot be written. A probe that cannot be computed is a failed cell.
pub fn run(
    probes: &[Probe],
    evaluator: &dyn Evaluator,
    options: &Options,
    folder: &Path,
    begin: &mut dyn FnMut(&str),
) -> Result<(Ran, Vec<Measured>), StudyError> {
    let mut all = Vec::with_capacity(probes.len());
    let ran = measure_cases(blank(probes, evaluator, options), folder, &mut |study, case| {
        let probe = &probes[case];
        begin(&probe.name);
        let measured =
            measure(probe, evaluator, options).map_err(|fault| Failure::render(fault.to_string()))?;
        study.claims.extend(claim(&measured));
        let magnitudes = measured.points.iter().map(magnitude);
        study.axes[0].values.extend(magnitudes);
        let cells = measured.points.iter().flat_map(|point| cells(point, options.seed)).collect();
        all.push(measured);
        Ok(cells)
    })?;
    Ok((ran, all))
}

/// Returns the study before anything is measured.
fn blank(probes: &[Probe], evaluator: &dyn Evaluator, options: &Options) -> StudyRecord {
    let case = |probe: &Probe| {
        SceneRecord::case(&probe.name, format!("{} Magnitude: {}.", probe.about, probe.magnitude))
    };
    StudyRecord {
        name: "precision".to_owned(),
        title: "Single precision".to_owned(),
        about: "Errors are relative to the same function of the same inputs in f64. The unavoidable error is that of a result \
                that is rounded to f32, where each input is off by the rounding of f32: the error of the function as it is \
                written, with independent inputs. An error that exceeds it many times can be avoided"
            .to_owned(),
        words: Words { case: "probe".to_owned(), subject: "arithmetic".to_owned() },
        budget: format!("{} samples of each of {} magnitudes", options.samples, options.magnitudes),
        scenes: probes.iter().map(case).collect(),
        pipelines: SUBJECTS.map(|(name, about)| PipelineRecord::subject(name, about)).into(),
        axes: vec![Axis {
            name: MAGNITUDE.to_owned(),
            doc: "Of an input; each probe says of which".to_owned(),
            ..Axis::default()
        }],
        measures: vec![
            MeasureInfo::new(ERROR, "relative error", "99 % of the samples have at most this"),
            MeasureInfo::new(MEDIAN, "median error", "The median of relative errors"),
            MeasureInfo::new(LOST, "lost", "The share of samples whose error is infinite"),
        ],
        adapter: evaluator.name(),
        ..StudyRecord::default()
    }
}

/// Returns a magnitude, which is a number of `f32`, as it is typed.
fn magnitude(point: &Point) -> AxisValue {
    AxisValue::from_value(&Value::F32(point.magnitude as f32))
}

/// Returns the cells of a magnitude.
fn cells(point: &Point, seed: u64) -> [Cell; 2] {
    let known = |value: f64| Some(value).filter(|value| value.is_finite());
    let cell = |(subject, _): (&str, &str), errors: &Errors| Cell {
        pipeline: subject.to_owned(),
        axes: [(MAGNITUDE.to_owned(), magnitude(point))].into(),
        seed: seed as u32,
        measures: [(ERROR, errors.most), (MEDIAN, errors.median)]
            .map(|(key, value)| (key.to_owned(), known(value)))
            .into(),
        ..Cell::default()
    };
    let [mut computed, unavoidable] =
        [cell(SUBJECTS[0], &point.errors), cell(SUBJECTS[1], &point.unavoidable)];
    computed.measures.insert(LOST.to_owned(), Some(point.lost));
    [computed, unavoidable]
}

/// Returns the claim that the error is as demanded where it is the greatest multiple of the unavoidable one, and so everywhere.
fn claim(measured: &Measured) -> Option<Claim> {
    let worst = measured.worst()?;
    let [of, to] = SUBJECTS.map(|(name, _)| Pick::all(name));
    let (measure, relation) = if worst.errors.most.is_finite() {
        (ERROR, Relation::Ratio { of, to, at_least: None, at_most: Some(measured.probe.bound) })
    } else {
        (LOST, Relation::Bound { of, at_least: None, at_most: Some(MOST_LOST) })
    };
    let at = vec![(MAGNITUDE.to_owned().into(), magnitude(worst).into())];
    Some(Claim { at, ..Claim::new(measure, relation, &measured.probe.name, "the probe") })
}

/// Returns a row for each probe, at the magnitude where its error is the greatest multiple of the unavoidable one.
pub fn table(all: &[Measured]) -> Table {
    let numbers = ["worst at", "error", "in roundings", "unavoidable", "error over it", "at most", "lost"];
    let numbers = numbers.into_iter().map(|title| Column::number(title, ""));
    let columns = std::iter::once(Column::text("probe", "")).chain(numbers).collect();
    let row = |measured: &Measured| {
        let worst = measured.worst()?;
        let class = if measured.holds() { "held" } else { "exceeds" };
        let lost = measured.points.iter().map(|point| point.lost).fold(0.0, f64::max);
        Some(vec![
            Entry::Text(measured.probe.name.clone()),
            Entry::Text(format!("{:.1e}", worst.magnitude)),
            Entry::Text(format!("{:.1e}", worst.errors.most)),
            Entry::Text(format!("{:.1}", worst.errors.most / ROUNDING)),
            Entry::Text(format!("{:.1e}", worst.unavoidable.most)),
            Entry::marked(format!("{:.2}", worst.ratio()), class, ""),
            Entry::Text(measured.probe.bound.to_string()),
            Entry::Text(lost.to_string()),
        ])
    };
    Table {
        name: "Probes".to_owned(),
        caption: "Each at the magnitude where its error is the greatest multiple of the unavoidable one."
            .to_owned(),
        columns,
        rows: all.iter().filter_map(row).collect(),
    }
}
