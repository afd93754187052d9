//! Measures against time, with the Pareto front, and against each axis.

use super::{Figure, Kind, file};
use crate::Interval;
use crate::report::digest::{Digest, Row, TIME, distinct, label_with_unit};
use crate::{AxisValue, Better, MeasureInfo};
use report::{AxisKind, Line, MOST_DASHES, Point, Series, XyAxis, XyChart, number};

/// The greatest number of charts for an axis and a measure of a scene: one for each combination of the other
/// axes.
pub(super) const MOST_COMBINATIONS: usize = 16;

/// The greatest number of values of an axis that each have a tick.
const MOST_TICKS: usize = 16;

/// Returns charts of each error of a scene against GPU time.
pub(super) fn against_time(digest: &Digest<'_>, scene: usize) -> Vec<Figure> {
    let varied = digest.varied();
    let joined = varied.iter().copied().find(|&axis| is_numeric(&digest.taken[axis]));
    let rest: Vec<usize> = varied.iter().copied().filter(|&axis| Some(axis) != joined).collect();
    let measures = digest.measured().filter(|measure| measure.is_error);
    measures.filter_map(|measure| time_chart(digest, scene, measure, joined, &rest)).collect()
}

fn time_chart(
    digest: &Digest<'_>,
    scene: usize,
    measure: &MeasureInfo,
    joined: Option<usize>,
    rest: &[usize],
) -> Option<Figure> {
    let point = |row: &Row<'_>| {
        let (time, error) = (row.time()?, row.summary(&measure.key)?);
        let label = match joined {
            Some(axis) => row.values[axis].map_or_else(String::new, ToString::to_string),
            None => digest.values_text(row, rest),
        };
        Some(Point {
            x: time.mean,
            y: error.mean,
            x_half: time.half.unwrap_or(0.0),
            y_half: error.half.unwrap_or(0.0),
            label,
            tip: tip(
                digest,
                row,
                &[(measure.label.as_str(), &measure.unit, &error), ("GPU time", "ms", &time)],
            ),
        })
    };
    let combinations = combinations(digest.of_scene(scene), rest);
    let are_distinct = joined.is_some() && (2..=MOST_DASHES).contains(&combinations.len());
    let dashes = |row: &Row<'_>| {
        let of = |combination: &Combination<'_>| *combination == group(row, rest);
        if are_distinct { combinations.iter().position(of).unwrap_or(0) } else { 0 }
    };
    let series = series(digest, scene, TIME, &(joined, rest), &dashes, &point);
    let points = points(&series);
    if points.is_empty() {
        return None;
    }
    let floor = digest.noise(scene, measure);
    // An error below that of the reference is no better than that; if all are, there is no front.
    let bounded = |p: &&Point| (p.x, floor.map_or(p.y, |floor| p.y.max(floor)));
    // The times of several adapters have no front in common.
    let has_front = digest.adapters == 1 && points.iter().any(|p| floor.is_none_or(|floor| p.y > floor));
    let front = if has_front {
        pareto(&points.iter().map(bounded).collect::<Vec<_>>(), measure.better)
    } else {
        Vec::new()
    };
    let name = digest.scenes[scene];
    let about = format!("{} against GPU time, {name}", measure.label);
    let mut caption = format!("{about}. {}", intervals(&points));
    if let Some(axis) = joined {
        let axis = &digest.results.study.axes[axis].name;
        caption +=
            &format!(" Lines join the points of a pipeline along {axis}, whose values stand beside them.");
    }
    if !front.is_empty() {
        caption += if points.iter().any(|p| floor.is_some_and(|floor| p.y < floor)) {
            " Nothing that was measured lies beyond the Pareto front, but for errors below the reference’s own."
        } else {
            " Nothing that was measured lies beyond the Pareto front."
        };
    }
    if digest.adapters > 1 {
        caption += &format!(" Each curve has the times of one adapter; {}.", digest.errors_are_of());
    }
    if let Some(floor) = floor {
        caption += &format!(" The reference’s own {} is about {}.", measure.label, number::short(floor, 2));
    }
    let names = combinations.iter().filter_map(|combination| {
        let row = digest.of_scene(scene).find(|row| group(row, rest) == *combination)?;
        are_distinct.then(|| digest.values_text(row, rest))
    });
    let chart = XyChart {
        about,
        dashes: names.collect(),
        floor,
        x: XyAxis::quantity(digest.time_label()),
        y: XyAxis::quantity(label_with_unit(measure)),
        front_rises: measure.better == Better::Higher,
        front,
        series,
    };
    Some(Figure {
        kind: Kind::ErrorTime,
        choice: vec![name.to_owned(), measure.label.clone()],
        file: file(&[name, &measure.key, "time"]),
        caption,
        drawing: chart.drawing(report::PAGE),
        column: chart.drawing(report::COLUMN),
    })
}

/// Returns charts of each measure of a scene against each axis, for each combination of the other axes, and
/// the number of charts that were left out.
pub(super) fn against_axes(digest: &Digest<'_>, scene: usize) -> (Vec<Figure>, usize) {
    let leading = digest.leading();
    let (mut figures, mut left_out) = (Vec::new(), 0);
    for measure in digest.measured() {
        for &(axis, ref rest) in &leading {
            let measured = digest.of_scene(scene).filter(|row| row.summary(&measure.key).is_some());
            let combinations = combinations(measured, rest);
            left_out += combinations.len().saturating_sub(MOST_COMBINATIONS);
            let charts = combinations
                .iter()
                .take(MOST_COMBINATIONS)
                .filter_map(|combination| axis_chart(digest, scene, measure, axis, rest, combination));
            figures.extend(charts);
        }
    }
    (figures, left_out)
}

fn axis_chart(
    digest: &Digest<'_>,
    scene: usize,
    measure: &MeasureInfo,
    axis: usize,
    rest: &[usize],
    combination: &[Option<&AxisValue>],
) -> Option<Figure> {
    let values = &digest.taken[axis];
    let numeric = is_numeric(values);
    let point = |row: &Row<'_>| {
        if group(row, rest) != combination {
            return None;
        }
        let error = row.summary(&measure.key)?;
        let x = match row.values[axis]? {
            AxisValue::Number(number) if numeric => *number,
            value => values.iter().position(|v| *v == value)? as f64,
        };
        Some(Point {
            x,
            y: error.mean,
            y_half: error.half.unwrap_or(0.0),
            tip: tip(digest, row, &[(measure.label.as_str(), &measure.unit, &error)]),
            ..Point::default()
        })
    };
    let series = series(digest, scene, &measure.key, &(Some(axis), rest), &|_| 0, &point);
    let points = points(&series);
    if points.is_empty() {
        return None;
    }
    let example = digest.of_scene(scene).find(|row| group(row, rest) == combination)?;
    let with = digest.values_text(example, rest);
    let (name, info) = (digest.scenes[scene], &digest.results.study.axes[axis]);
    let about = format!("{} against {}, {name}", measure.label, info.name);
    let at = if with.is_empty() { String::new() } else { format!(" with {with}") };
    let caption = format!("{about}{at}. {}", intervals(&points));
    let unit = if info.unit.is_empty() { String::new() } else { format!(" [{}]", info.unit) };
    let kind = if !numeric {
        AxisKind::Choices(values.iter().map(ToString::to_string).collect())
    } else if values.len() > MOST_TICKS {
        AxisKind::Quantity
    } else {
        let numbers =
            values.iter().filter_map(|v| if let AxisValue::Number(n) = v { Some(*n) } else { None });
        AxisKind::Values(numbers.collect())
    };
    let chart = XyChart {
        about,
        x: XyAxis { title: format!("{}{unit}", info.name), kind },
        y: XyAxis::quantity(label_with_unit(measure)),
        series,
        floor: digest.noise(scene, measure),
        ..XyChart::default()
    };
    Some(Figure {
        kind: Kind::ErrorAxis,
        file: file(&[name, &measure.key, "over", &info.name, &with]),
        choice: vec![
            name.to_owned(),
            measure.label.clone(),
            info.name.clone(),
            if with.is_empty() { "nothing else varied".to_owned() } else { with },
        ],
        caption,
        drawing: chart.drawing(report::PAGE),
        column: chart.drawing(report::COLUMN),
    })
}

/// Returns a series for each curve of a measure, with a line for each combination of its values on `rest`, along `axis`
/// in ascending order.
fn series(
    digest: &Digest<'_>,
    scene: usize,
    key: &str,
    &(axis, rest): &(Option<usize>, &[usize]),
    dashes: &dyn Fn(&Row<'_>) -> usize,
    point: &dyn Fn(&Row<'_>) -> Option<Point>,
) -> Vec<Series> {
    let one = |(index, (name, pipelines)): (usize, (String, Vec<usize>))| {
        let mut lines: Vec<(Combination<'_>, Vec<(&Row<'_>, Point)>)> = Vec::new();
        let mut seen = Vec::new();
        for row in digest.of_scene(scene).filter(|row| pipelines.contains(&row.pipeline)) {
            // Of rows that adapters share, the first stands for all.
            if pipelines.len() > 1 && seen.contains(&&row.values) {
                continue;
            }
            seen.push(&row.values);
            let Some(mut point) = point(row) else { continue };
            if pipelines.len() > 1 {
                point.tip = point.tip.replacen(&digest.pipelines[row.pipeline], &name, 1);
            }
            let key = group(row, rest);
            // Without an axis along which to join points, each point is its own line.
            match lines.iter_mut().find(|(other, _)| axis.is_some() && *other == key) {
                Some((_, line)) => line.push((row, point)),
                None => lines.push((key, vec![(row, point)])),
            }
        }
        for (_, line) in &mut lines {
            if let Some(axis) = axis {
                let number = |row: &Row<'_>| match row.values[axis] {
                    Some(AxisValue::Number(number)) => *number,
                    _ => 0.0,
                };
                line.sort_by(|(a, _), (b, _)| number(a).total_cmp(&number(b)));
            }
        }
        let line = |(_, line): (_, Vec<(&Row<'_>, Point)>)| Line {
            dashes: line.first().map_or(0, |(row, _)| dashes(row)),
            points: line.into_iter().map(|(_, point)| point).collect(),
        };
        let lines: Vec<Line> = lines.into_iter().map(line).collect();
        (!lines.is_empty()).then_some(Series { name, index, lines })
    };
    digest.curves(key).into_iter().enumerate().filter_map(one).collect()
}

/// Returns the corners of the Pareto front in ascending order of x: smaller x is better; for y, `better`
/// decides.
fn pareto(points: &[(f64, f64)], better: Better) -> Vec<(f64, f64)> {
    let sign = match better {
        Better::Lower => 1.0,
        Better::Higher => -1.0,
        Better::One | Better::Neither => return Vec::new(),
    };
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0).then((sign * a.1).total_cmp(&(sign * b.1))));
    let mut front: Vec<(f64, f64)> = Vec::new();
    for point in sorted {
        if front.last().is_none_or(|last| sign * point.1 < sign * last.1) {
            front.push(point);
        }
    }
    front
}

/// Values on some axes.
pub(super) type Combination<'a> = Vec<Option<&'a AxisValue>>;

/// Returns the values of a row on some axes.
pub(super) fn group<'a>(row: &Row<'a>, axes: &[usize]) -> Combination<'a> {
    axes.iter().map(|&axis| row.values[axis]).collect()
}

/// Returns the combinations of values of rows on some axes, in order.
pub(super) fn combinations<'a: 'b, 'b>(
    rows: impl Iterator<Item = &'b Row<'a>>,
    axes: &[usize],
) -> Vec<Combination<'a>> {
    distinct(rows.map(|row| group(row, axes)))
}

fn points(series: &[Series]) -> Vec<&Point> {
    series.iter().flat_map(|series| &series.lines).flat_map(|line| &line.points).collect()
}

fn is_numeric(values: &[&AxisValue]) -> bool {
    values.iter().all(|value| matches!(value, AxisValue::Number(_)))
}

fn intervals(points: &[&Point]) -> &'static str {
    if points.iter().any(|p| p.x_half > 0.0 || p.y_half > 0.0) {
        "Points are means over seeds, whiskers their 95\u{a0}% intervals (Student’s t)."
    } else {
        "Points are means over seeds; there are no intervals, as no point has two seeds that differ."
    }
}

pub(super) fn tip(digest: &Digest<'_>, row: &Row<'_>, values: &[(&str, &str, &Interval)]) -> String {
    let mut tip = digest.row_text(row);
    let mut seeds = 0;
    for (label, unit, summary) in values {
        tip += &format!("\n{label}: {} {unit}", summary.measured().text());
        seeds = seeds.max(summary.seeds);
    }
    tip + &format!("\n{seeds} seed{}", if seeds == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_holds_what_nothing_beats() {
        let points = [(3.0, 1.0), (1.0, 5.0), (2.0, 6.0), (2.0, 2.0), (2.0, 2.0), (4.0, 1.0)];
        assert_eq!(pareto(&points, Better::Lower), [(1.0, 5.0), (2.0, 2.0), (3.0, 1.0)]);
        assert_eq!(pareto(&points, Better::Higher), [(1.0, 5.0), (2.0, 6.0)]);
        assert_eq!(pareto(&points, Better::One), []);
        assert_eq!(pareto(&[], Better::Lower), []);
    }
}
