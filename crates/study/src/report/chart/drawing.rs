//! The drawing of a chart: lines, paths, rectangles and text in pixels, downwards, independent of the format of its
//! file.

use super::palette::Ink;

/// Sizes of text [px].
pub(super) const TEXT: f64 = 13.0;
pub(super) const SMALL: f64 = 11.5;
pub(super) const TINY: f64 = 10.0;

/// A point [px].
pub(super) type Point = (f64, f64);

/// A chart, drawn.
pub(in crate::report) struct Drawing {
    pub(super) items: Vec<Item>,
    /// Width and height [px], whole numbers.
    pub(super) size: (f64, f64),
    /// A text alternative for readers who cannot see the chart.
    pub(super) label: String,
}

/// What a drawing consists of, in the order in which it is painted.
pub(super) enum Item {
    Path(Path, Style),
    Rectangle {
        at: Point,
        size: Point,
        fill: Ink,
        stroke: Option<Ink>,
    },
    Text {
        at: Point,
        text: Text,
    },
    /// Begins a group with a class; `tip` is shown when the pointer is over it.
    Open {
        class: String,
        tip: String,
    },
    /// Ends the last group that is open.
    Close,
}

/// How a path is painted.
#[derive(Clone, Copy, Default)]
pub(super) struct Style {
    pub(super) fill: Option<Ink>,
    /// Colour and width [px].
    pub(super) stroke: Option<(Ink, f64)>,
    /// Lengths of dashes and gaps [px]; empty for none.
    pub(super) dashes: &'static [f64],
}

impl Style {
    pub(super) fn line(ink: Ink, width: f64) -> Style {
        Style { stroke: Some((ink, width)), ..Style::default() }
    }
}

/// Lines and circles.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Path {
    pub(super) steps: Vec<Step>,
}

/// A part of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Step {
    /// Begins a line here.
    Start(Point),
    /// Continues it straight to here.
    To(Point),
    /// Joins its end to its beginning.
    Close,
    /// A circle.
    Circle { centre: Point, radius: f64 },
}

impl Path {
    /// Creates a line through points.
    pub(super) fn through(points: impl IntoIterator<Item = Point>) -> Path {
        let mut path = Path::default();
        for point in points {
            path.steps.push(if path.steps.is_empty() { Step::Start(point) } else { Step::To(point) });
        }
        path
    }

    /// Creates a polygon.
    pub(super) fn polygon(corners: impl IntoIterator<Item = Point>) -> Path {
        let mut path = Path::through(corners);
        path.steps.push(Step::Close);
        path
    }

    pub(super) fn circle(centre: Point, radius: f64) -> Path {
        Path { steps: vec![Step::Circle { centre, radius }] }
    }

    /// Adds a line apart from those before.
    pub(super) fn add(&mut self, from: Point, to: Point) {
        self.steps.extend([Step::Start(from), Step::To(to)]);
    }

    pub(super) fn is_empty(&self) -> bool {
        self.steps.is_empty()
    }
}

/// Which end of a text is at its position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// Text with its style.
#[derive(Clone)]
pub(super) struct Text {
    pub(super) text: String,
    /// An exponent, set as a superscript.
    pub(super) exponent: Option<i32>,
    pub(super) size: f64,
    pub(super) ink: Ink,
    pub(super) anchor: Anchor,
    pub(super) bold: bool,
    /// Whether it is rotated to be read upwards.
    pub(super) upright: bool,
}

impl Text {
    pub(super) fn new(text: &str, size: f64, ink: Ink, anchor: Anchor) -> Text {
        Text { text: text.to_owned(), exponent: None, size, ink, anchor, bold: false, upright: false }
    }

    /// Returns the exponent as it is printed.
    pub(super) fn exponent_text(&self) -> Option<String> {
        self.exponent.map(|exponent| exponent.to_string().replace('-', "−"))
    }
}

/// How far a superscript stands above the base line, and its size, as shares of the size of the text.
pub(super) const SUPERSCRIPT: (f64, f64) = (0.38, 0.75);

impl Drawing {
    /// Creates an empty drawing. `label` is a text alternative for readers who cannot see the chart.
    pub(super) fn new(label: &str) -> Drawing {
        Drawing { items: Vec::new(), size: (0.0, 0.0), label: label.to_owned() }
    }

    /// Sets the size.
    pub(super) fn finish(self, (width, height): Point) -> Drawing {
        Drawing { size: (width.ceil(), height.ceil()), ..self }
    }

    pub(super) fn line(&mut self, from: Point, to: Point, ink: Ink, width: f64) {
        self.path(Path::through([from, to]), Style::line(ink, width));
    }

    pub(super) fn path(&mut self, path: Path, style: Style) {
        self.items.push(Item::Path(path, style));
    }

    pub(super) fn rectangle(&mut self, at: Point, size: Point, fill: Ink, stroke: Option<Ink>) {
        self.items.push(Item::Rectangle { at, size: (size.0.max(0.0), size.1.max(0.0)), fill, stroke });
    }

    /// Adds text. The position is on the base line.
    pub(super) fn text(&mut self, at: Point, text: Text) {
        self.items.push(Item::Text { at, text });
    }

    /// Begins a group with a class; `tip` is shown when the pointer is over it.
    pub(super) fn open(&mut self, class: &str, tip: &str) {
        self.items.push(Item::Open { class: class.to_owned(), tip: tip.to_owned() });
    }

    pub(super) fn close(&mut self) {
        self.items.push(Item::Close);
    }
}

/// Returns an estimate of the width of a text [px] in a sans-serif font; files must look alike on all
/// machines.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    let advance = |c: char| match c {
        'i' | 'j' | 'l' | 'I' | '.' | ',' | ':' | ';' | '\'' | '|' | '!' => 0.28,
        'f' | 't' | 'r' | ' ' | '(' | ')' | '[' | ']' | '/' | '-' => 0.34,
        'm' | 'w' | 'M' | 'W' | '@' | '%' => 0.88,
        c if c.is_uppercase() => 0.70,
        c if (c as u32) >= 0x1100 => 1.0,
        _ => 0.56,
    };
    text.chars().map(advance).sum::<f64>() * size
}

/// Returns a text cut to a width [px], with an ellipsis if something is missing.
pub(super) fn shortened(text: &str, size: f64, most: f64) -> String {
    if text_width(text, size) <= most {
        return text.to_owned();
    }
    let mut kept = String::new();
    for c in text.chars() {
        kept.push(c);
        if text_width(&kept, size) + size > most {
            kept.pop();
            break;
        }
    }
    kept.trim_end().to_owned() + "…"
}

/// Formats a coordinate: at most two decimals, no trailing zeros, never `-0`.
pub(super) fn n(value: f64) -> String {
    let rounded = (value * 100.0).round() / 100.0;
    if rounded == 0.0 { "0".to_owned() } else { rounded.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_are_short() {
        assert_eq!([n(1.0), n(-0.001), n(12.345_678), n(0.1 + 0.2)], ["1", "0", "12.35", "0.3"]);
    }

    #[test]
    fn long_names_are_cut() {
        assert_eq!(shortened("short", 10.0, 100.0), "short");
        let cut = shortened(&"long ".repeat(40), 10.0, 100.0);
        assert!(cut.ends_with('…') && text_width(&cut, 10.0) <= 100.0, "{cut}");
    }
}
