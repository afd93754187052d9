//! The drawing of a chart: lines, paths, rectangles and text in pixels, written as SVG with coordinates to a hundredth of
//! a pixel.

use super::palette::{Ink, paint};
use crate::escape::html;
use std::fmt::Write;

/// Sizes of text [px].
pub(super) const TEXT: f64 = 13.0;
pub(super) const SMALL: f64 = 11.5;
pub(super) const TINY: f64 = 10.0;

/// A point [px].
pub(super) type Point = (f64, f64);

/// A chart, drawn.
pub struct Drawing {
    /// The elements, in the order in which they are painted.
    body: String,
    /// Width and height [px], whole numbers.
    size: (f64, f64),
    /// A text alternative for readers who cannot see the chart.
    label: String,
}

/// How a path is painted.
#[derive(Clone, Copy, Default)]
pub(super) struct Style {
    pub(super) fill: Option<Ink>,
    /// Color and width [px].
    pub(super) stroke: Option<(Ink, f64)>,
    /// Lengths of dashes and gaps [px]; empty for none.
    pub(super) dashes: &'static [f64],
    /// Whether the fill lets through what is below it.
    pub(super) is_pale: bool,
}

impl Style {
    pub(super) fn line(ink: Ink, width: f64) -> Style {
        Style { stroke: Some((ink, width)), ..Style::default() }
    }
}

/// The data of an SVG path.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Path {
    data: String,
    last: Option<Point>,
}

impl Path {
    /// Creates a line through points.
    pub(super) fn through(points: impl IntoIterator<Item = Point>) -> Path {
        let mut path = Path::default();
        for point in points {
            if path.last.is_none() { path.start(point) } else { path.to(point) }
        }
        path
    }

    /// Creates a polygon.
    pub(super) fn polygon(corners: impl IntoIterator<Item = Point>) -> Path {
        let mut path = Path::through(corners);
        path.data.push('Z');
        path
    }

    pub(super) fn circle((x, y): Point, radius: f64) -> Path {
        let (r, d) = (n(radius), n(2.0 * radius));
        let data = format!("M{} {}a{r} {r} 0 1 0 {d} 0a{r} {r} 0 1 0 -{d} 0Z", n(x - radius), n(y));
        Path { data, last: None }
    }

    /// Adds a line apart from those before.
    pub(super) fn add(&mut self, from: Point, to: Point) {
        self.start(from);
        self.to(to);
    }

    pub(super) fn is_empty(&self) -> bool {
        self.data.is_empty()
    }

    fn start(&mut self, (x, y): Point) {
        let _ = write!(self.data, "M{} {}", n(x), n(y));
        self.last = Some((x, y));
    }

    /// Continues the line straight to a point; along an axis by `H` or `V`.
    fn to(&mut self, (x, y): Point) {
        let _ = match self.last {
            Some((_, last)) if y == last => write!(self.data, "H{}", n(x)),
            Some((last, _)) if x == last => write!(self.data, "V{}", n(y)),
            _ => write!(self.data, "L{} {}", n(x), n(y)),
        };
        self.last = Some((x, y));
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
}

/// How far a superscript stands above the base line, and its size, as shares of the size of the text.
const SUPERSCRIPT: (f64, f64) = (0.38, 0.75);

impl Drawing {
    /// Creates an empty drawing. `label` is a text alternative for readers who cannot see the chart.
    pub(super) fn new(label: &str) -> Drawing {
        Drawing { body: String::new(), size: (0.0, 0.0), label: label.to_owned() }
    }

    /// Sets the size.
    pub(super) fn finish(self, (width, height): Point) -> Drawing {
        Drawing { size: (width.ceil(), height.ceil()), ..self }
    }

    /// Returns the text of an SVG file.
    pub fn svg(&self) -> String {
        let (width, height) = self.size;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" font-family=\"Helvetica, Arial, sans-serif\" role=\"img\" \
             aria-label=\"{}\">\n{}</svg>\n",
            html(&self.label),
            self.body,
        )
    }

    pub(super) fn line(&mut self, from: Point, to: Point, ink: Ink, width: f64) {
        self.path(&Path::through([from, to]), Style::line(ink, width));
    }

    pub(super) fn path(&mut self, path: &Path, style: Style) {
        let Style { fill, stroke, dashes, is_pale } = style;
        let mut element = format!("<path d=\"{}\"{}", path.data, paint(fill, stroke.map(|(ink, _)| ink)));
        if let Some((_, width)) = stroke {
            let _ = write!(element, " stroke-width=\"{width}\" stroke-linejoin=\"round\"");
        }
        if !dashes.is_empty() {
            let dashes: Vec<String> = dashes.iter().map(f64::to_string).collect();
            let _ = write!(element, " stroke-dasharray=\"{}\"", dashes.join(" "));
        }
        if is_pale {
            element.push_str(" fill-opacity=\"0.2\"");
        }
        self.body += &element;
        self.body.push_str("/>\n");
    }

    pub(super) fn rectangle(&mut self, at: Point, size: Point, fill: Ink, stroke: Option<Ink>) {
        let (width, height) = (size.0.max(0.0), size.1.max(0.0));
        let _ = writeln!(
            self.body,
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"{}/>",
            n(at.0),
            n(at.1),
            n(width),
            n(height),
            paint(Some(fill), stroke),
        );
    }

    /// Adds text. The position is on the base line.
    pub(super) fn text(&mut self, (x, y): Point, text: Text) {
        let (x, y) = (n(x), n(y));
        let paint = paint(Some(text.ink), None);
        let anchor = match text.anchor {
            Anchor::Start => "",
            Anchor::Middle => " text-anchor=\"middle\"",
            Anchor::End => " text-anchor=\"end\"",
        };
        let weight = if text.bold { " font-weight=\"bold\"" } else { "" };
        let turn = if text.upright { format!(" transform=\"rotate(-90 {x} {y})\"") } else { String::new() };
        let exponent = text.exponent.map_or_else(String::new, |exponent| {
            let (rise, size) = (n(-SUPERSCRIPT.0 * text.size), n(SUPERSCRIPT.1 * text.size));
            let exponent = exponent.to_string().replace('-', "−");
            format!("<tspan dy=\"{rise}\" font-size=\"{size}\">{exponent}</tspan>")
        });
        let (size, text) = (text.size, html(&text.text));
        let _ = writeln!(
            self.body,
            "<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\"{paint}{anchor}{weight}{turn}>{text}{exponent}</text>"
        );
    }

    /// Begins a group with a class; `tip` is shown when the pointer is over it.
    pub(super) fn open(&mut self, class: &str, tip: &str) {
        let title = if tip.is_empty() { String::new() } else { format!("<title>{}</title>", html(tip)) };
        let _ = writeln!(self.body, "<g class=\"{class}\">{title}");
    }

    pub(super) fn close(&mut self) {
        self.body.push_str("</g>\n");
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
pub(crate) fn n(value: f64) -> String {
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

    #[test]
    fn text_is_escaped_and_powers_stand_above() {
        let mut drawing = Drawing::new("a & b");
        let text = Text { exponent: Some(-3), ..Text::new("<b>10", 10.0, Ink::Text, Anchor::Middle) };
        drawing.text((1.0, 2.0), text);
        let file = drawing.finish((10.0, 10.0)).svg();
        assert!(
            file.contains(">&lt;b&gt;10<tspan dy=\"-3.8\" font-size=\"7.5\">−3</tspan></text>"),
            "{file}"
        );
        assert!(file.contains("aria-label=\"a &amp; b\""), "{file}");
    }

    #[test]
    fn paths_are_short() {
        let mut path = Path::through([(0.0, 1.0), (5.0, 1.0), (5.0, 3.0), (6.0, 4.001)]);
        path.add((1.0, 1.0), (2.0, 1.0));
        assert_eq!(path.data, "M0 1H5V3L6 4M1 1H2");
        assert_eq!(Path::polygon([(0.0, 0.0), (1.0, 1.0)]).data, "M0 0L1 1Z");
        assert_eq!(Path::circle((2.0, 2.0), 1.5).data, "M0.5 2a1.5 1.5 0 1 0 3 0a1.5 1.5 0 1 0 -3 0Z");
    }
}
