//! Charts of points with intervals over two axes, joined by lines, with the Pareto front.

use super::axis::{Axis, BELOW, Frame};
use super::drawing::{Anchor, Drawing, Path, SMALL, Style, TINY, Text, shortened, text_width};
use super::labels::{self, Rect, Wanted};
use super::legend::{self, FLOOR, FRONT, Mark};
use super::palette::{self, Ink};
use super::scale::{Label, Scale, Tick};

/// Height of the chart without legend and notes, as a share of its width.
const HEIGHT: f64 = 2.0 / 3.0;
const RADIUS: f64 = 4.8;
/// A line of more points than this has small markers, so that it stays visible.
const DENSE: usize = 20;
const SMALL_RADIUS: f64 = 2.4;
/// A line of more points than this has no markers: they would be most of the file.
const MOST_MARKED: usize = 256;

/// A chart over two axes.
#[derive(Default)]
pub struct XyChart {
    /// A text alternative for readers who cannot see the chart.
    pub about: String,
    /// The horizontal axis.
    pub x: XyAxis,
    /// The vertical axis.
    pub y: XyAxis,
    /// One series per pipeline.
    pub series: Vec<Series>,
    /// Corners of the Pareto front, sorted by x; empty for none.
    pub front: Vec<(f64, f64)>,
    /// Whether larger y is better: if so, the front begins at the bottom.
    pub front_rises: bool,
    /// The meaning of the dashes of lines, by [`Line::dashes`]; empty if they have none.
    pub dashes: Vec<String>,
    /// The error of the reference itself, drawn if it is within the axis.
    pub floor: Option<f64>,
}

/// Title and type of an axis.
#[derive(Default)]
pub struct XyAxis {
    /// The title, with its unit.
    pub title: String,
    /// The type of its values.
    pub kind: AxisKind,
}

/// The type of the values on an axis.
#[derive(Default)]
pub enum AxisKind {
    /// A quantity.
    #[default]
    Quantity,
    /// Whole numbers, one after another.
    Count,
    /// A quantity with ticks at these values.
    Values(Vec<f64>),
    /// Choices by name; points are at 0, 1, …
    Choices(Vec<String>),
}

/// The points of one pipeline.
pub struct Series {
    /// The name in the legend.
    pub name: String,
    /// Determines color and marker.
    pub index: usize,
    /// The lines, each with its points.
    pub lines: Vec<Line>,
}

/// Points that are joined by lines, in order.
pub struct Line {
    /// The points.
    pub points: Vec<Point>,
    /// Index of its dashes, below [`MOST_DASHES`](crate::MOST_DASHES).
    pub dashes: usize,
}

/// A point with its intervals.
#[derive(Clone, Debug, Default)]
pub struct Point {
    /// Position on the x axis.
    pub x: f64,
    /// Position on the y axis.
    pub y: f64,
    /// Half the width of the interval of x; 0 for none.
    pub x_half: f64,
    /// Half the width of the interval of y; 0 for none.
    pub y_half: f64,
    /// Text beside the point, if there is room; empty for none.
    pub label: String,
    /// Text that is shown when the pointer is over the point.
    pub tip: String,
}

impl XyAxis {
    /// Creates the axis of a quantity.
    pub fn quantity(title: impl Into<String>) -> XyAxis {
        XyAxis { title: title.into(), kind: AxisKind::Quantity }
    }
}

impl XyChart {
    /// Draws the chart so wide \[px\].
    pub fn drawing(&self, wide: f64) -> Drawing {
        let points = || self.points();
        let ends = |value: f64, half: f64| [value, value - half, value + half];
        // An interval that reaches below zero does not make an axis linear; it is cut.
        let reach = |value: f64, half: f64| {
            ends(value, half).into_iter().filter(move |end| value < 0.0 || *end > 0.0 || *end == value)
        };
        let x = axis(&self.x, points().flat_map(|p| reach(p.x, p.x_half)), 7, wide);
        let y = axis(&self.y, points().flat_map(|p| reach(p.y, p.y_half)), 6, wide);
        let left = y.width() + 6.0;
        let frame =
            Frame { left, top: 10.0, width: wide - left - 14.0, height: HEIGHT * wide - BELOW - 10.0 };

        let mut drawing = Drawing::new(&self.about);
        frame.draw_x(&mut drawing, &x, !matches!(self.x.kind, AxisKind::Choices(_)));
        frame.draw_y(&mut drawing, &y);
        let has_floor = self.draw_floor(&mut drawing, frame, &y);
        self.draw_front(&mut drawing, frame, &x, &y);
        for series in &self.series {
            draw_series(&mut drawing, frame, &x, &y, series);
        }
        self.draw_labels(&mut drawing, frame, &x, &y);

        let mut entries: Vec<(Mark, String)> =
            self.series.iter().map(|s| (Mark::Series(s.index), s.name.clone())).collect();
        entries.extend(self.dashes.iter().enumerate().map(|(index, name)| (Mark::Line(index), name.clone())));
        if has_floor {
            entries.push((Mark::Floor, "noise of the reference".to_owned()));
        }
        if !self.front.is_empty() {
            entries.push((Mark::Front, "Pareto front".to_owned()));
        }
        let mut height = HEIGHT * wide + 4.0;
        height += legend::draw(&mut drawing, (frame.left, height), frame.width, &entries);
        let outside = points().filter(|p| !(x.scale.holds(p.x) && y.scale.holds(p.y))).count();
        if outside > 0 {
            let note = format!("hollow, at the edge: 0 or less ({outside} of {})", points().count());
            drawing.text((frame.left, height + 14.0), Text::new(&note, SMALL, Ink::Faint, Anchor::Start));
            height += 20.0;
        }
        drawing.finish((wide, height + 6.0))
    }

    fn points(&self) -> impl Iterator<Item = &Point> + Clone {
        self.series.iter().flat_map(|series| &series.lines).flat_map(|line| &line.points)
    }

    /// Draws the error of the reference, and returns whether it is within the axis.
    fn draw_floor(&self, drawing: &mut Drawing, frame: Frame, y: &Axis) -> bool {
        let reached = self.floor.filter(|&floor| {
            let place = y.scale.place(floor);
            floor > 0.0 && place > 0.0 && place < 1.0
        });
        if let Some(floor) = reached {
            let height = frame.y(y, floor);
            drawing.path(Path::through([(frame.left, height), (frame.right(), height)]), FLOOR);
        }
        reached.is_some()
    }

    /// Draws the Pareto front as steps: with this much time, no smaller error was measured.
    fn draw_front(&self, drawing: &mut Drawing, frame: Frame, x: &Axis, y: &Axis) {
        if self.front.is_empty() {
            return;
        }
        let start = if self.front_rises { frame.bottom() } else { frame.top };
        let mut points: Vec<(f64, f64)> = Vec::new();
        for &(corner_x, corner_y) in &self.front {
            let (corner_x, before) = (frame.x(x, corner_x), points.last().map_or(start, |point| point.1));
            points.extend([(corner_x, before), (corner_x, frame.y(y, corner_y))]);
        }
        points.extend(points.last().map(|&(_, last)| (frame.right(), last)));
        drawing.open("front", "Pareto front: nothing measured is both faster and better");
        drawing.path(Path::through(points), FRONT);
        drawing.close();
    }

    fn draw_labels(&self, drawing: &mut Drawing, frame: Frame, x: &Axis, y: &Axis) {
        let points: Vec<&Point> = self.points().collect();
        let place = |p: &Point| (frame.x(x, p.x), frame.y(y, p.y));
        // Markers reach beyond their radius.
        let markers: Vec<Rect> =
            points.iter().map(|p| Rect::around(place(p), 2.6 * RADIUS, 2.6 * RADIUS)).collect();
        let lines = self.series.iter().flat_map(|series| &series.lines);
        let joined = lines.flat_map(|line| line.points.windows(2));
        let mut drawn: Vec<Rect> =
            joined.flat_map(|pair| labels::along(place(&pair[0]), place(&pair[1]))).collect();
        for p in &points {
            let ends = |x: f64, y: f64| place(&Point { x, y, ..Point::default() });
            drawn.extend(labels::along(ends(p.x - p.x_half, p.y), ends(p.x + p.x_half, p.y)));
            drawn.extend(labels::along(ends(p.x, p.y - p.y_half), ends(p.x, p.y + p.y_half)));
        }
        let named: Vec<&Point> = points.into_iter().filter(|p| !p.label.is_empty()).collect();
        let wanted = named.iter().map(|p| Wanted {
            point: place(p),
            width: text_width(&p.label, TINY) + 2.0,
            height: TINY + 1.0,
        });
        let wanted: Vec<Wanted> = wanted.collect();
        for (point, centre) in named.iter().zip(labels::beside(&wanted, frame.area(), &markers, &drawn)) {
            if let Some((x, y)) = centre {
                drawing.text((x, y + 3.5), Text::new(&point.label, TINY, Ink::Faint, Anchor::Middle));
            }
        }
    }
}

fn draw_series(drawing: &mut Drawing, frame: Frame, x: &Axis, y: &Axis, series: &Series) {
    let ink = Ink::Series(series.index);
    drawing.open(&format!("series series-{}", series.index), "");
    for line in &series.lines {
        if line.points.len() > 1 {
            let corners = line.points.iter().map(|point| (frame.x(x, point.x), frame.y(y, point.y)));
            let dashes = palette::dashes(line.dashes);
            drawing.path(Path::through(corners), Style { dashes, ..Style::line(ink, 1.8) });
        }
    }
    let marked = series.lines.iter().filter(|line| line.points.len() <= MOST_MARKED);
    for (line, point) in marked.flat_map(|line| line.points.iter().map(move |point| (line, point))) {
        let radius = if line.points.len() > DENSE { SMALL_RADIUS } else { RADIUS };
        drawing.open("mark", &point.tip);
        let (px, py) = (frame.x(x, point.x), frame.y(y, point.y));
        let whiskers = whiskers(frame, x, y, point);
        if !whiskers.is_empty() {
            drawing.path(whiskers, Style::line(ink, 1.2));
        }
        let marker = palette::marker(series.index, (px, py), radius);
        if x.scale.holds(point.x) && y.scale.holds(point.y) {
            drawing.path(marker, Style { fill: Some(ink), ..Style::line(Ink::Paper, 1.0) });
        } else {
            drawing.path(marker, Style { fill: Some(Ink::Paper), ..Style::line(ink, 1.4) });
        }
        drawing.close();
    }
    drawing.close();
}

/// Returns the intervals of a point. An end outside the axis has an arrow in place of a cap.
fn whiskers(frame: Frame, x: &Axis, y: &Axis, point: &Point) -> Path {
    const CAP: f64 = 3.5;
    let (px, py) = (frame.x(x, point.x), frame.y(y, point.y));
    let mut path = Path::default();
    let mut add = |axis: &Axis, value: f64, [from, to]: [f64; 2], at: &dyn Fn(f64, f64) -> (f64, f64)| {
        if from == to || !axis.scale.holds(value) {
            return;
        }
        path.add(at(from, 0.0), at(to, 0.0));
        for end in [from, to] {
            if (0.0..=1.0).contains(&axis.scale.place(end)) && axis.scale.holds(end) {
                path.add(at(end, -CAP), at(end, CAP));
                continue;
            }
            // An arrow at the edge.
            let (tip, middle) = (at(end, 0.0), at(value, 0.0));
            let step = |from: f64, to: f64| (to - from).clamp(-CAP, CAP);
            for aside in [-CAP, CAP] {
                let (x, y) = at(end, aside);
                path.add((x + step(tip.0, middle.0), y + step(tip.1, middle.1)), tip);
            }
        }
    };
    let (x_half, y_half) = (point.x_half.max(0.0), point.y_half.max(0.0));
    add(y, point.y, [point.y + y_half, point.y - y_half], &|value, aside| (px + aside, frame.y(y, value)));
    add(x, point.x, [point.x - x_half, point.x + x_half], &|value, aside| (frame.x(x, value), py + aside));
    path
}

/// Returns an axis with so many ticks at most; names of choices share the width of the chart.
fn axis(axis: &XyAxis, values: impl Iterator<Item = f64> + Clone, most: usize, wide: f64) -> Axis {
    match &axis.kind {
        AxisKind::Quantity => Axis::new(Scale::fit(values), axis.title.clone(), most),
        AxisKind::Count => {
            let scale = Scale::across(values);
            let mut ticks = scale.ticks(most);
            ticks.retain(|tick| tick.value.fract() == 0.0);
            Axis { scale, title: axis.title.clone(), ticks }
        }
        AxisKind::Values(marked) => {
            let scale = Scale::fit(marked.iter().copied());
            let ticks = marked
                .iter()
                .map(|&value| Tick { value, label: Some(Label::plain(&crate::number::plain(value))) });
            Axis { scale, title: axis.title.clone(), ticks: ticks.collect() }
        }
        AxisKind::Choices(names) => {
            let band = (wide - 80.0) / names.len().max(1) as f64 - 8.0;
            let label = |name: &String| Label::plain(&shortened(name, SMALL, band));
            let ticks = names
                .iter()
                .enumerate()
                .map(|(index, name)| Tick { value: index as f64, label: Some(label(name)) });
            let scale = Scale::Bands { count: names.len() };
            Axis { scale, title: axis.title.clone(), ticks: ticks.collect() }
        }
    }
}
