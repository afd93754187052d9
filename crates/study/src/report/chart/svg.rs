//! A writer of SVG: lines, paths and text, with coordinates to a hundredth of a pixel.

use std::fmt::Write;

use super::palette::{Ink, paint};
use crate::report::escape;

/// Sizes of text [px].
pub(super) const TEXT: f64 = 13.0;
pub(super) const SMALL: f64 = 11.5;
pub(super) const TINY: f64 = 10.0;

/// An SVG file that is being written.
pub(super) struct Svg {
    body: String,
}

/// Which end of a text is at its position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// Text with its style.
#[derive(Clone, Copy)]
pub(super) struct Text<'a> {
    pub(super) text: &'a str,
    /// An exponent, set as a superscript.
    pub(super) exponent: Option<i32>,
    pub(super) size: f64,
    pub(super) ink: Ink,
    pub(super) anchor: Anchor,
    pub(super) bold: bool,
    /// Whether it is rotated to be read upwards.
    pub(super) upright: bool,
}

impl<'a> Text<'a> {
    pub(super) fn new(text: &'a str, size: f64, ink: Ink, anchor: Anchor) -> Text<'a> {
        Text { text, exponent: None, size, ink, anchor, bold: false, upright: false }
    }
}

impl Svg {
    pub(super) fn new() -> Svg {
        Svg { body: String::new() }
    }

    pub(super) fn line(&mut self, from: (f64, f64), to: (f64, f64), ink: Ink, width: f64) {
        let _ = writeln!(
            self.body,
            "<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\"{} stroke-width=\"{width}\"/>",
            n(from.0),
            n(from.1),
            n(to.0),
            n(to.1),
            paint(None, Some(ink)),
        );
    }

    /// Adds a path. `dashes` as in `stroke-dasharray`; empty for none.
    pub(super) fn path(&mut self, data: &str, fill: Option<Ink>, stroke: Option<(Ink, f64)>, dashes: &str) {
        let _ = write!(self.body, "<path d=\"{data}\"{}", paint(fill, stroke.map(|(ink, _)| ink)));
        if let Some((_, width)) = stroke {
            let _ = write!(self.body, " stroke-width=\"{width}\" stroke-linejoin=\"round\"");
        }
        if !dashes.is_empty() {
            let _ = write!(self.body, " stroke-dasharray=\"{dashes}\"");
        }
        self.body.push_str("/>\n");
    }

    pub(super) fn rectangle(&mut self, at: (f64, f64), size: (f64, f64), fill: Ink, stroke: Option<Ink>) {
        let _ = writeln!(
            self.body,
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"{}/>",
            n(at.0),
            n(at.1),
            n(size.0.max(0.0)),
            n(size.1.max(0.0)),
            paint(Some(fill), stroke),
        );
    }

    /// Adds text. The position is on the base line.
    pub(super) fn text(&mut self, (x, y): (f64, f64), text: &Text<'_>) {
        let _ = write!(self.body, "<text x=\"{}\" y=\"{}\" font-size=\"{}\"", n(x), n(y), text.size);
        self.body.push_str(&paint(Some(text.ink), None));
        match text.anchor {
            Anchor::Start => {}
            Anchor::Middle => self.body.push_str(" text-anchor=\"middle\""),
            Anchor::End => self.body.push_str(" text-anchor=\"end\""),
        }
        if text.bold {
            self.body.push_str(" font-weight=\"bold\"");
        }
        if text.upright {
            let _ = write!(self.body, " transform=\"rotate(-90 {} {})\"", n(x), n(y));
        }
        let _ = write!(self.body, ">{}", escape::html(text.text));
        if let Some(exponent) = text.exponent {
            let exponent = exponent.to_string().replace('-', "−");
            let (rise, size) = (n(-0.38 * text.size), n(0.75 * text.size));
            let _ = write!(self.body, "<tspan dy=\"{rise}\" font-size=\"{size}\">{exponent}</tspan>");
        }
        self.body.push_str("</text>\n");
    }

    /// Opens a group with a class; `tip` is shown when the pointer is over it.
    pub(super) fn open(&mut self, class: &str, tip: &str) {
        let _ = write!(self.body, "<g class=\"{class}\">");
        if !tip.is_empty() {
            let _ = write!(self.body, "<title>{}</title>", escape::html(tip));
        }
        self.body.push('\n');
    }

    pub(super) fn close(&mut self) {
        self.body.push_str("</g>\n");
    }

    /// Returns the text of the file. `label` is a text alternative for readers who cannot see the chart.
    pub(super) fn finish(self, (width, height): (f64, f64), label: &str) -> String {
        let (width, height) = (width.ceil(), height.ceil());
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" font-family=\"Helvetica, Arial, sans-serif\" role=\"img\" \
             aria-label=\"{}\">\n{}</svg>\n",
            escape::html(label),
            self.body,
        )
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

    #[test]
    fn text_is_escaped_and_powers_stand_above() {
        let mut svg = Svg::new();
        let text = Text { exponent: Some(-3), ..Text::new("<b>10", 10.0, Ink::Text, Anchor::Middle) };
        svg.text((1.0, 2.0), &text);
        let file = svg.finish((10.0, 10.0), "a & b");
        assert!(
            file.contains(">&lt;b&gt;10<tspan dy=\"-3.8\" font-size=\"7.5\">−3</tspan></text>"),
            "{file}"
        );
        assert!(file.contains("aria-label=\"a &amp; b\""), "{file}");
    }
}
