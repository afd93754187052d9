//! Horizontal bars from zero, stacked or side by side, with one row for each combination of values.

use super::axis::{Axis, BELOW, Frame};
use super::drawing::{Anchor, Drawing, SMALL, TEXT, Text, shortened, text_width};
use super::legend::{self, Mark};
use super::palette::Ink;
use super::scale::Scale;

/// Greatest width of the label of a row, as a share of the chart's; longer labels are cut.
const LABELS: f64 = 170.0 / 540.0;
/// Thickness of a bar that is the only one of its row, and of one of several [px].
const ALONE: f64 = 17.0;
const AMONG: f64 = 8.0;
/// Free height of a row [px].
const GAP: f64 = 7.0;
/// Height of the line that names a pipeline [px].
const HEADING: f64 = 24.0;

/// A chart of bars.
pub struct BarChart {
    /// A text alternative for readers who cannot see the chart.
    pub about: String,
    /// Title of the axis, with its unit.
    pub title: String,
    /// The rows: a heading is drawn where it differs from that of the row before and rows have labels.
    pub rows: Vec<BarRow>,
    /// Names of the segments.
    pub legend: Vec<(Ink, String)>,
}

/// A row of bars.
pub struct BarRow {
    /// The heading, such as the pipeline.
    pub heading: String,
    /// The label; empty if the heading suffices.
    pub label: String,
    /// The bars from the top, each as segments from the left.
    pub bars: Vec<Vec<Segment>>,
    /// Text behind the longest bar.
    pub total: String,
}

/// A segment of a bar.
pub struct Segment {
    /// The color.
    pub ink: Ink,
    /// At least 0.
    pub value: f64,
    /// Text that is shown when the pointer is over the segment.
    pub tip: String,
}

impl BarRow {
    fn thickness(&self) -> f64 {
        if self.bars.len() > 1 { AMONG } else { ALONE }
    }

    fn height(&self) -> f64 {
        self.bars.len().max(1) as f64 * self.thickness() + GAP
    }

    /// Returns the value at which the longest bar ends.
    fn end(&self) -> f64 {
        let length = |bar: &Vec<Segment>| bar.iter().map(|segment| segment.value).sum();
        self.bars.iter().map(length).fold(0.0, f64::max)
    }

    /// Returns the text on the left of the bars.
    fn name(&self) -> &str {
        if self.label.is_empty() { &self.heading } else { &self.label }
    }
}

impl BarChart {
    /// Draws the chart so wide \[px\].
    pub fn drawing(&self, wide: f64) -> Drawing {
        let greatest = self.rows.iter().map(BarRow::end).fold(0.0, f64::max);
        let totals = self.rows.iter().map(|row| text_width(&row.total, SMALL)).fold(0.0, f64::max);
        let labels = self.rows.iter().map(|row| text_width(row.name(), SMALL)).fold(0.0, f64::max);
        let most_label = LABELS * wide;
        let left = labels.min(most_label) + 16.0;
        let height =
            |(index, row): (usize, &BarRow)| row.height() + self.heading(index).map_or(0.0, |_| HEADING);
        let height: f64 = self.rows.iter().enumerate().map(height).sum();
        let frame = Frame { left, top: 6.0, width: wide - left - totals - 16.0, height: height + 4.0 };
        let axis = Axis::new(Scale::from_zero(greatest), self.title.clone(), 7);

        let mut drawing = Drawing::new(&self.about);
        frame.draw_x(&mut drawing, &axis, true);
        let mut y = frame.top;
        for (index, row) in self.rows.iter().enumerate() {
            if let Some(heading) = self.heading(index) {
                let heading = shortened(heading, TEXT, left + frame.width);
                let text = Text { bold: true, ..Text::new(&heading, TEXT, Ink::Text, Anchor::Start) };
                drawing.text((4.0, y + HEADING - 7.0), text);
                y += HEADING;
            }
            let label = shortened(row.name(), SMALL, most_label);
            let text = Text::new(&label, SMALL, Ink::Text, Anchor::End);
            drawing.text((left - 8.0, y + row.height() / 2.0 + 4.0), text);
            draw_row(&mut drawing, frame, &axis, row, y);
            y += row.height();
        }
        drawing.line((frame.left, frame.top), (frame.left, frame.bottom()), Ink::Text, 1.0);
        let entries: Vec<(Mark, String)> =
            self.legend.iter().map(|(ink, name)| (Mark::Square(*ink), name.clone())).collect();
        let below = frame.bottom() + BELOW + 4.0;
        let legend = legend::draw(&mut drawing, (16.0, below), wide - 32.0, &entries);
        drawing.finish((wide, below + legend + 6.0))
    }

    /// Returns the heading above a row, if there is one.
    fn heading(&self, row: usize) -> Option<&str> {
        let BarRow { heading, label, .. } = &self.rows[row];
        let continued = row > 0 && self.rows[row - 1].heading == *heading;
        (!continued && !label.is_empty()).then_some(heading)
    }
}

fn draw_row(drawing: &mut Drawing, frame: Frame, axis: &Axis, row: &BarRow, top: f64) {
    for (index, bar) in row.bars.iter().enumerate() {
        let y = top + GAP / 2.0 + index as f64 * row.thickness();
        let outline = (bar.len() > 1).then_some(Ink::Paper);
        let mut from = 0.0;
        for segment in bar.iter().filter(|segment| segment.value > 0.0) {
            let (left, right) = (frame.x(axis, from), frame.x(axis, from + segment.value));
            drawing.open("mark", &segment.tip);
            drawing.rectangle((left, y), (right - left, row.thickness()), segment.ink, outline);
            drawing.close();
            from += segment.value;
        }
    }
    let total = Text::new(&row.total, SMALL, Ink::Faint, Anchor::Start);
    drawing.text((frame.x(axis, row.end()) + 6.0, top + row.height() / 2.0 + 4.0), total);
}
