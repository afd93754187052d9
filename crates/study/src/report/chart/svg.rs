//! Writes a drawing as SVG, with coordinates to a hundredth of a pixel.

use std::fmt::Write;

use super::drawing::{Anchor, Drawing, Item, Path, SUPERSCRIPT, Step, Style, Text, n};
use super::palette::paint;
use crate::report::escape;

impl Drawing {
    /// Returns the text of an SVG file.
    pub(in crate::report) fn svg(&self) -> String {
        let mut body = String::new();
        for item in &self.items {
            let _ = match item {
                Item::Path(path, style) => path_element(&mut body, path, *style),
                Item::Rectangle { at, size, fill, stroke } => writeln!(
                    body,
                    "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"{}/>",
                    n(at.0),
                    n(at.1),
                    n(size.0),
                    n(size.1),
                    paint(Some(*fill), *stroke),
                ),
                Item::Text { at, text } => text_element(&mut body, *at, text),
                Item::Open { class, tip } if tip.is_empty() => writeln!(body, "<g class=\"{class}\">"),
                Item::Open { class, tip } => {
                    writeln!(body, "<g class=\"{class}\"><title>{}</title>", escape::html(tip))
                }
                Item::Close => writeln!(body, "</g>"),
            };
        }
        let (width, height) = self.size;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" font-family=\"Helvetica, Arial, sans-serif\" role=\"img\" \
             aria-label=\"{}\">\n{body}</svg>\n",
            escape::html(&self.label),
        )
    }
}

fn path_element(body: &mut String, path: &Path, style: Style) -> std::fmt::Result {
    let stroke = style.stroke;
    write!(body, "<path d=\"{}\"{}", data(path), paint(style.fill, stroke.map(|(ink, _)| ink)))?;
    if let Some((_, width)) = stroke {
        write!(body, " stroke-width=\"{width}\" stroke-linejoin=\"round\"")?;
    }
    if !style.dashes.is_empty() {
        let dashes: Vec<String> = style.dashes.iter().map(f64::to_string).collect();
        write!(body, " stroke-dasharray=\"{}\"", dashes.join(" "))?;
    }
    writeln!(body, "/>")
}

/// Returns path data: lines along an axis by `H` and `V`.
fn data(path: &Path) -> String {
    let mut data = String::new();
    let mut last = (f64::NAN, f64::NAN);
    for step in &path.steps {
        let _ = match *step {
            Step::Start((x, y)) => write!(data, "M{} {}", n(x), n(y)),
            Step::To((x, y)) if y == last.1 => write!(data, "H{}", n(x)),
            Step::To((x, y)) if x == last.0 => write!(data, "V{}", n(y)),
            Step::To((x, y)) => write!(data, "L{} {}", n(x), n(y)),
            Step::Close => write!(data, "Z"),
            Step::Circle { centre: (x, y), radius } => {
                let (r, d) = (n(radius), n(2.0 * radius));
                write!(data, "M{} {}a{r} {r} 0 1 0 {d} 0a{r} {r} 0 1 0 -{d} 0Z", n(x - radius), n(y))
            }
        };
        if let Step::Start(point) | Step::To(point) = *step {
            last = point;
        }
    }
    data
}

fn text_element(body: &mut String, (x, y): (f64, f64), text: &Text) -> std::fmt::Result {
    write!(body, "<text x=\"{}\" y=\"{}\" font-size=\"{}\"", n(x), n(y), text.size)?;
    body.push_str(&paint(Some(text.ink), None));
    body.push_str(match text.anchor {
        Anchor::Start => "",
        Anchor::Middle => " text-anchor=\"middle\"",
        Anchor::End => " text-anchor=\"end\"",
    });
    if text.bold {
        body.push_str(" font-weight=\"bold\"");
    }
    if text.upright {
        write!(body, " transform=\"rotate(-90 {} {})\"", n(x), n(y))?;
    }
    write!(body, ">{}", escape::html(&text.text))?;
    if let Some(exponent) = text.exponent_text() {
        let (rise, size) = (n(-SUPERSCRIPT.0 * text.size), n(SUPERSCRIPT.1 * text.size));
        write!(body, "<tspan dy=\"{rise}\" font-size=\"{size}\">{exponent}</tspan>")?;
    }
    writeln!(body, "</text>")
}

#[cfg(test)]
mod tests {
    use super::super::palette::Ink;
    use super::*;

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
        assert_eq!(data(&path), "M0 1H5V3L6 4M1 1H2");
        assert_eq!(data(&Path::polygon([(0.0, 0.0), (1.0, 1.0)])), "M0 0L1 1Z");
        assert_eq!(data(&Path::circle((2.0, 2.0), 1.5)), "M0.5 2a1.5 1.5 0 1 0 3 0a1.5 1.5 0 1 0 -3 0Z");
    }
}
