//! The frame of a chart: grid, ticks, labels and titles.

use super::drawing::{Anchor, Drawing, SMALL, TEXT, Text, text_width};
use super::labels::{Rect, thinned};
use super::palette::Ink;
use super::scale::{Label, Scale, Tick};

/// An axis with its ticks.
pub(super) struct Axis {
    pub(super) scale: Scale,
    pub(super) title: String,
    pub(super) ticks: Vec<Tick>,
}

/// The area in which values are plotted [px].
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) width: f64,
    pub(super) height: f64,
}

impl Axis {
    /// Creates an axis with the ticks of its scale.
    pub(super) fn new(scale: Scale, title: String, most: usize) -> Axis {
        Axis { ticks: scale.ticks(most), scale, title }
    }

    /// Returns the width that the labels of a vertical axis, its ticks and its title take [px].
    pub(super) fn width(&self) -> f64 {
        let labels = self.ticks.iter().filter_map(|tick| tick.label.as_ref());
        labels.map(Label::width).fold(0.0, f64::max) + 10.0 + if self.title.is_empty() { 0.0 } else { 24.0 }
    }
}

impl Label {
    fn width(&self) -> f64 {
        let exponent = self.exponent.map_or(0.0, |e| text_width(&e.to_string(), 0.75 * SMALL));
        text_width(&self.text, SMALL) + exponent
    }

    fn text(&self, anchor: Anchor) -> Text {
        Text { exponent: self.exponent, ..Text::new(&self.text, SMALL, Ink::Faint, anchor) }
    }
}

/// Height below a frame for the ticks, labels and title of a horizontal axis [px].
pub(super) const BELOW: f64 = 46.0;

impl Frame {
    pub(super) fn right(&self) -> f64 {
        self.left + self.width
    }

    pub(super) fn bottom(&self) -> f64 {
        self.top + self.height
    }

    /// Returns the position of a value on the horizontal axis [px].
    pub(super) fn x(&self, axis: &Axis, value: f64) -> f64 {
        self.left + self.width * axis.scale.place(value).clamp(0.0, 1.0)
    }

    /// Returns the position of a value on the vertical axis [px].
    pub(super) fn y(&self, axis: &Axis, value: f64) -> f64 {
        self.bottom() - self.height * axis.scale.place(value).clamp(0.0, 1.0)
    }

    pub(super) fn area(&self) -> Rect {
        Rect { left: self.left, top: self.top, right: self.right(), bottom: self.bottom() }
    }

    /// Draws grid lines, ticks, labels and title of the horizontal axis. `with_grid` is false for choices.
    pub(super) fn draw_x(&self, drawing: &mut Drawing, axis: &Axis, with_grid: bool) {
        let labelled: Vec<(f64, &Label)> = axis
            .ticks
            .iter()
            .filter_map(|tick| Some((self.x(axis, tick.value), tick.label.as_ref()?)))
            .collect();
        for tick in &axis.ticks {
            let x = self.x(axis, tick.value);
            let length = if tick.label.is_some() { 5.0 } else { 3.0 };
            if tick.label.is_some() && with_grid {
                drawing.line((x, self.top), (x, self.bottom()), Ink::Grid, 1.0);
            }
            drawing.line((x, self.bottom()), (x, self.bottom() + length), Ink::Text, 1.0);
        }
        let places: Vec<(f64, f64)> = labelled.iter().map(|(x, label)| (*x, label.width())).collect();
        for ((x, label), shown) in labelled.into_iter().zip(thinned(&places, 6.0)) {
            if shown {
                drawing.text((x, self.bottom() + 18.0), label.text(Anchor::Middle));
            }
        }
        drawing.line((self.left, self.bottom()), (self.right(), self.bottom()), Ink::Text, 1.0);
        let title = Text::new(&axis.title, TEXT, Ink::Text, Anchor::Middle);
        drawing.text((self.left + self.width / 2.0, self.bottom() + 38.0), title);
    }

    /// Draws grid lines, ticks, labels and title of the vertical axis.
    pub(super) fn draw_y(&self, drawing: &mut Drawing, axis: &Axis) {
        for tick in &axis.ticks {
            let y = self.y(axis, tick.value);
            let length = if tick.label.is_some() { 5.0 } else { 3.0 };
            if let Some(label) = &tick.label {
                drawing.line((self.left, y), (self.right(), y), Ink::Grid, 1.0);
                drawing.text((self.left - 8.0, y + 4.0), label.text(Anchor::End));
            }
            drawing.line((self.left - length, y), (self.left, y), Ink::Text, 1.0);
        }
        drawing.line((self.left, self.top), (self.left, self.bottom()), Ink::Text, 1.0);
        let title = Text { upright: true, ..Text::new(&axis.title, TEXT, Ink::Text, Anchor::Middle) };
        drawing.text((self.left - axis.width() + 12.0, self.top + self.height / 2.0), title);
    }
}
