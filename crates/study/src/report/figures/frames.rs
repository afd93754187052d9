//! Charts of measures over the frames of scenes that move.

use super::errors::{Combination, combinations, group, tip};
use super::{Figure, Kind, file};
use crate::report::digest::{Digest, Row, label_with_unit};
use crate::{Interval, MeasureInfo};
use report::{AxisKind, Line, MOST_COLORS, MOST_DASHES, Point, Series, XyAxis, XyChart};

/// Returns charts of each measure of a scene over the frame number.
pub(super) fn frames(digest: &Digest<'_>, scene: usize) -> Vec<Figure> {
    let measures = digest.results.study.measures.iter();
    measures.flat_map(|measure| Walk::new(digest, scene, measure).figures()).collect()
}

/// A measure of the frames of a scene.
struct Walk<'a> {
    digest: &'a Digest<'a>,
    scene: usize,
    measure: &'a MeasureInfo,
    varied: Vec<usize>,
    curves: Vec<Curve<'a>>,
}

/// A row with the measurements of its frames, by frame number.
type Curve<'a> = (&'a Row<'a>, Vec<(u32, Interval)>);

impl<'a> Walk<'a> {
    fn new(digest: &'a Digest<'a>, scene: usize, measure: &'a MeasureInfo) -> Walk<'a> {
        let curves = digest.of_scene(scene).map(|row| (row, row.frames(&measure.key)));
        let curves = curves.filter(|(_, frames)| !frames.is_empty()).collect();
        Walk { digest, scene, measure, varied: digest.varied(), curves }
    }

    /// Returns charts with as many combinations of values each as can be distinguished: by dashes, or, for a
    /// single pipeline, by colors.
    fn figures(&self) -> Vec<Figure> {
        let combinations = combinations(self.curves.iter().map(|(row, _)| *row), &self.varied);
        let mut pipelines = self.curves.iter().map(|(row, _)| row.pipeline);
        let first = pipelines.next();
        let only = first.filter(|first| combinations.len() > 1 && pipelines.all(|other| other == *first));
        let most = if only.is_some() { MOST_COLORS } else { MOST_DASHES };
        let parts = combinations.chunks(most).enumerate();
        parts
            .map(|(part, shown)| {
                let first = part * most;
                let choice = if combinations.len() <= most {
                    "all".to_owned()
                } else {
                    format!("{} to {} of {}", first + 1, first + shown.len(), combinations.len())
                };
                self.figure(shown, only, part, choice)
            })
            .collect()
    }

    /// Returns the chart of some combinations; `only` is the pipeline of all curves if there is only one.
    fn figure(&self, shown: &[Combination<'_>], only: Option<usize>, part: usize, choice: String) -> Figure {
        let (digest, measure) = (self.digest, self.measure);
        let name = digest.scenes[self.scene];
        let about = format!("{} of each frame, {name}", measure.label);
        let of = only.map(|pipeline| format!(" of {}", digest.pipelines[pipeline])).unwrap_or_default();
        let number = if part == 0 { String::new() } else { (part + 1).to_string() };
        let dashes = if only.is_some() || shown.len() < 2 {
            Vec::new()
        } else {
            shown.iter().map(|values| self.name_of(values)).collect()
        };
        let chart = XyChart {
            about: about.clone(),
            x: XyAxis { title: "frame".to_owned(), kind: AxisKind::Count },
            y: XyAxis::quantity(label_with_unit(measure)),
            series: if only.is_some() { self.by_combination(shown) } else { self.by_pipeline(shown) },
            dashes,
            ..XyChart::default()
        };
        Figure {
            kind: Kind::Frames,
            choice: vec![name.to_owned(), measure.label.clone(), choice],
            file: file(&[name, &measure.key, "frames", &number]),
            caption: format!("{about}. Curves{of} are means over seeds; frames.csv holds every value."),
            drawing: chart.drawing(report::PAGE),
            column: chart.drawing(report::COLUMN),
        }
    }

    /// Returns series whose colors are pipelines and whose dashes are combinations.
    fn by_pipeline(&self, shown: &[Combination<'_>]) -> Vec<Series> {
        let one = |(index, name): (usize, &String)| {
            let own = self.curves.iter().filter(|(row, _)| row.pipeline == index);
            let lines = own.filter_map(|curve| {
                let dashes = shown.iter().position(|values| *values == group(curve.0, &self.varied))?;
                Some(self.lines(curve, dashes))
            });
            let lines: Vec<Line> = lines.flatten().collect();
            (!lines.is_empty()).then(|| Series { name: name.clone(), index, lines })
        };
        self.digest.pipelines.iter().enumerate().filter_map(one).collect()
    }

    /// Returns series whose colors are combinations.
    fn by_combination(&self, shown: &[Combination<'_>]) -> Vec<Series> {
        let one = |(index, values): (usize, &Combination<'_>)| {
            let lines = self.at(values).map(|curve| self.lines(curve, 0)).unwrap_or_default();
            Series { name: self.name_of(values), index, lines }
        };
        shown.iter().enumerate().map(one).collect()
    }

    /// Returns the first curve of a combination.
    fn at(&self, values: &Combination<'_>) -> Option<&Curve<'a>> {
        self.curves.iter().find(|(row, _)| group(row, &self.varied) == *values)
    }

    fn name_of(&self, values: &Combination<'_>) -> String {
        self.at(values).map(|(row, _)| self.digest.values_text(row, &self.varied)).unwrap_or_default()
    }

    /// Returns the lines of a curve, interrupted where a frame has no value.
    fn lines(&self, (row, frames): &Curve<'_>, dashes: usize) -> Vec<Line> {
        let point = |(frame, value): &(u32, Interval)| {
            let values = [(self.measure.label.as_str(), self.measure.unit.as_str(), value)];
            Point {
                x: f64::from(*frame),
                y: value.mean,
                tip: format!("frame {frame}: {}", tip(self.digest, row, &values)),
                // Whiskers at every frame would hide the curves.
                ..Point::default()
            }
        };
        let runs = frames.chunk_by(|(before, _), (frame, _)| before + 1 == *frame);
        runs.map(|run| Line { points: run.iter().map(point).collect(), dashes }).collect()
    }
}
