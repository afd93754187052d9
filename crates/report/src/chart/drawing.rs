//! The drawing of a chart: lines, paths, rectangles and text in pixels, written as SVG with coordinates to a hundredth of
//! a pixel, or as PDF.

use super::palette::{Ink, paint};
use crate::escape::html;
use crate::pdf::{Page, Set, channels};
use pdf_writer::Content;
use pdf_writer::types::LineJoinStyle;
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
    elements: Vec<Element>,
    /// Width and height [px], whole numbers.
    size: (f64, f64),
    /// A text alternative for readers who cannot see the chart.
    label: String,
}

/// What a drawing is made of.
enum Element {
    Path(Path, Style),
    /// Corner, width and height, fill and stroke.
    Rectangle(Point, Point, Ink, Option<Ink>),
    /// The position is on the base line.
    Text(Point, Text),
    /// Begins a group with a class, and a text for the pointer.
    Open(String, String),
    Close,
}

/// How a path is painted.
#[derive(Clone, Copy, Default)]
pub(super) struct Style {
    pub(super) fill: Option<Ink>,
    /// Color and width [px].
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
pub(super) struct Path(Vec<Segment>);

#[derive(Clone, Copy, Debug, PartialEq)]
enum Segment {
    Start(Point),
    To(Point),
    Close,
    /// Centre and radius.
    Circle(Point, f64),
}

impl Path {
    /// Creates a line through points.
    pub(super) fn through(points: impl IntoIterator<Item = Point>) -> Path {
        let mut path = Path::default();
        for point in points {
            path.0.push(if path.is_empty() { Segment::Start(point) } else { Segment::To(point) });
        }
        path
    }

    /// Creates a polygon.
    pub(super) fn polygon(corners: impl IntoIterator<Item = Point>) -> Path {
        let mut path = Path::through(corners);
        path.0.push(Segment::Close);
        path
    }

    pub(super) fn circle(centre: Point, radius: f64) -> Path {
        Path(vec![Segment::Circle(centre, radius)])
    }

    /// Adds a line apart from those before.
    pub(super) fn add(&mut self, from: Point, to: Point) {
        self.0.extend([Segment::Start(from), Segment::To(to)]);
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns the data of an SVG path; lines along an axis by `H` or `V`.
    fn svg(&self) -> String {
        let (mut data, mut last) = (String::new(), None);
        for segment in &self.0 {
            let _ = match (*segment, last) {
                (Segment::Start((x, y)), _) => write!(data, "M{} {}", n(x), n(y)),
                (Segment::To((x, y)), Some((_, before))) if y == before => write!(data, "H{}", n(x)),
                (Segment::To((x, y)), Some((before, _))) if x == before => write!(data, "V{}", n(y)),
                (Segment::To((x, y)), _) => write!(data, "L{} {}", n(x), n(y)),
                (Segment::Close, _) => write!(data, "Z"),
                (Segment::Circle((x, y), radius), _) => {
                    let (r, d) = (n(radius), n(2.0 * radius));
                    write!(data, "M{} {}a{r} {r} 0 1 0 {d} 0a{r} {r} 0 1 0 -{d} 0Z", n(x - radius), n(y))
                }
            };
            if let Segment::Start(point) | Segment::To(point) = *segment {
                last = Some(point);
            }
        }
        data
    }

    /// Adds the path to the content of a PDF file.
    fn pdf(&self, content: &mut Content) {
        /// How far the handles of a curve stand from its ends, for a quarter of a circle of radius 1.
        const HANDLE: f64 = 0.552_284_75;
        for segment in &self.0 {
            match *segment {
                Segment::Start((x, y)) => content.move_to(x as f32, y as f32),
                Segment::To((x, y)) => content.line_to(x as f32, y as f32),
                Segment::Close => content.close_path(),
                Segment::Circle((x, y), radius) => {
                    content.move_to((x + radius) as f32, y as f32);
                    for (cos, sin) in [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)] {
                        // A quarter turn takes (cos, sin) to (−sin, cos).
                        let at = |along: f64, aside: f64| {
                            let (along, aside) = (radius * along, radius * aside);
                            [x + cos * along - sin * aside, y + sin * along + cos * aside]
                                .map(|value| value as f32)
                        };
                        let ([x1, y1], [x2, y2], [x3, y3]) = (at(1.0, HANDLE), at(HANDLE, 1.0), at(0.0, 1.0));
                        content.cubic_to(x1, y1, x2, y2, x3, y3);
                    }
                    content.close_path()
                }
            };
        }
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

    /// Returns the exponent as it is written.
    fn exponent(&self) -> Option<String> {
        self.exponent.map(|exponent| exponent.to_string().replace('-', "−"))
    }
}

/// How far a superscript stands above the base line, and its size, as shares of the size of the text.
const SUPERSCRIPT: (f64, f64) = (0.38, 0.75);

impl Drawing {
    /// Creates an empty drawing. `label` is a text alternative for readers who cannot see the chart.
    pub(super) fn new(label: &str) -> Drawing {
        Drawing { elements: Vec::new(), size: (0.0, 0.0), label: label.to_owned() }
    }

    /// Sets the size.
    pub(super) fn finish(self, (width, height): Point) -> Drawing {
        Drawing { size: (width.ceil(), height.ceil()), ..self }
    }

    pub(super) fn line(&mut self, from: Point, to: Point, ink: Ink, width: f64) {
        self.path(Path::through([from, to]), Style::line(ink, width));
    }

    pub(super) fn path(&mut self, path: Path, style: Style) {
        self.elements.push(Element::Path(path, style));
    }

    pub(super) fn rectangle(&mut self, at: Point, size: Point, fill: Ink, stroke: Option<Ink>) {
        self.elements.push(Element::Rectangle(at, (size.0.max(0.0), size.1.max(0.0)), fill, stroke));
    }

    /// Adds text. The position is on the base line.
    pub(super) fn text(&mut self, at: Point, text: Text) {
        self.elements.push(Element::Text(at, text));
    }

    /// Begins a group with a class; `tip` is shown when the pointer is over it.
    pub(super) fn open(&mut self, class: &str, tip: &str) {
        self.elements.push(Element::Open(class.to_owned(), tip.to_owned()));
    }

    pub(super) fn close(&mut self) {
        self.elements.push(Element::Close);
    }

    /// Returns the text of an SVG file.
    pub fn svg(&self) -> String {
        let (width, height) = self.size;
        let mut file = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" font-family=\"Helvetica, Arial, sans-serif\" role=\"img\" \
             aria-label=\"{}\">\n",
            html(&self.label),
        );
        for element in &self.elements {
            let _ = match element {
                Element::Path(path, style) => writeln!(file, "{}", path_element(path, style)),
                Element::Rectangle((x, y), (width, height), fill, stroke) => writeln!(
                    file,
                    "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"{}/>",
                    n(*x),
                    n(*y),
                    n(*width),
                    n(*height),
                    paint(Some(*fill), *stroke),
                ),
                Element::Text(at, text) => writeln!(file, "{}", text_element(*at, text)),
                Element::Open(class, tip) if tip.is_empty() => writeln!(file, "<g class=\"{class}\">"),
                Element::Open(class, tip) => {
                    writeln!(file, "<g class=\"{class}\"><title>{}</title>", html(tip))
                }
                Element::Close => writeln!(file, "</g>"),
            };
        }
        file + "</svg>\n"
    }

    /// Returns a PDF file of one page, whose fonts are embedded; four pixels are three points. The same drawing gives the same
    /// bytes.
    pub fn pdf(&self) -> Vec<u8> {
        let mut page = Page::new(self.size, 0.75);
        for element in &self.elements {
            match element {
                Element::Path(path, style) => {
                    let Style { fill, stroke, dashes } = *style;
                    let draw = |content: &mut Content| path.pdf(content);
                    painted(&mut page, draw, fill, stroke, dashes);
                }
                Element::Rectangle((x, y), (width, height), fill, stroke) => {
                    let [x, y, width, height] = [*x, *y, *width, *height].map(|value| value as f32);
                    let draw = |content: &mut Content| {
                        content.rect(x, y, width, height);
                    };
                    painted(&mut page, draw, Some(*fill), stroke.map(|ink| (ink, 1.0)), &[]);
                }
                Element::Text(at, text) => write_text(&mut page, *at, text),
                Element::Open(..) | Element::Close => {}
            }
        }
        page.finish()
    }
}

fn path_element(path: &Path, Style { fill, stroke, dashes }: &Style) -> String {
    let mut element = format!("<path d=\"{}\"{}", path.svg(), paint(*fill, stroke.map(|(ink, _)| ink)));
    if let Some((_, width)) = stroke {
        let _ = write!(element, " stroke-width=\"{width}\" stroke-linejoin=\"round\"");
    }
    if !dashes.is_empty() {
        let dashes: Vec<String> = dashes.iter().map(f64::to_string).collect();
        let _ = write!(element, " stroke-dasharray=\"{}\"", dashes.join(" "));
    }
    element + "/>"
}

fn text_element((x, y): Point, text: &Text) -> String {
    let (x, y) = (n(x), n(y));
    let paint = paint(Some(text.ink), None);
    let anchor = match text.anchor {
        Anchor::Start => "",
        Anchor::Middle => " text-anchor=\"middle\"",
        Anchor::End => " text-anchor=\"end\"",
    };
    let weight = if text.bold { " font-weight=\"bold\"" } else { "" };
    let turn = if text.upright { format!(" transform=\"rotate(-90 {x} {y})\"") } else { String::new() };
    let exponent = text.exponent().map_or_else(String::new, |exponent| {
        let (rise, size) = (n(-SUPERSCRIPT.0 * text.size), n(SUPERSCRIPT.1 * text.size));
        format!("<tspan dy=\"{rise}\" font-size=\"{size}\">{exponent}</tspan>")
    });
    let (size, text) = (text.size, html(&text.text));
    format!(
        "<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\"{paint}{anchor}{weight}{turn}>{text}{exponent}</text>"
    )
}

/// Paints what `draw` adds to the content of a page.
fn painted(
    page: &mut Page<'_>,
    draw: impl FnOnce(&mut Content),
    fill: Option<Ink>,
    stroke: Option<(Ink, f64)>,
    dashes: &[f64],
) {
    page.content.save_state();
    if let Some([red, green, blue]) = fill.map(|ink| channels(ink.rgb())) {
        page.content.set_fill_rgb(red, green, blue);
    }
    if let Some((ink, width)) = stroke {
        let [red, green, blue] = channels(ink.rgb());
        page.content.set_stroke_rgb(red, green, blue);
        page.content.set_line_width(width as f32).set_line_join(LineJoinStyle::RoundJoin);
        page.content.set_dash_pattern(dashes.iter().map(|length| *length as f32), 0.0);
    }
    draw(&mut page.content);
    match (fill, stroke) {
        (Some(_), Some(_)) => page.content.fill_nonzero_and_stroke(),
        (Some(_), None) => page.content.fill_nonzero(),
        (None, Some(_)) => page.content.stroke(),
        (None, None) => page.content.end_path(),
    };
    page.content.restore_state();
}

fn write_text(page: &mut Page<'_>, (x, y): Point, text: &Text) {
    let set = Set { size: text.size, rgb: text.ink.rgb(), is_bold: text.bold, is_upright: text.upright };
    let raised = Set { size: SUPERSCRIPT.1 * text.size, ..set };
    let exponent = text.exponent().unwrap_or_default();
    let width = set.size * set.font().width(&text.text);
    let whole = width + raised.size * set.font().width(&exponent);
    let before = match text.anchor {
        Anchor::Start => 0.0,
        Anchor::Middle => whole / 2.0,
        Anchor::End => whole,
    };
    // Along the text, and away from its base line.
    let at = |along: f64, above: f64| match text.upright {
        true => (x - above, y - along),
        false => (x + along, y - above),
    };
    page.text(at(-before, 0.0), &text.text, set);
    page.text(at(width - before, SUPERSCRIPT.0 * text.size), &exponent, raised);
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
        assert_eq!(path.svg(), "M0 1H5V3L6 4M1 1H2");
        assert_eq!(Path::polygon([(0.0, 0.0), (1.0, 1.0)]).svg(), "M0 0L1 1Z");
        assert_eq!(Path::circle((2.0, 2.0), 1.5).svg(), "M0.5 2a1.5 1.5 0 1 0 3 0a1.5 1.5 0 1 0 -3 0Z");
    }
}
