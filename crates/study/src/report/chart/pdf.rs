//! Writes a drawing as PDF 1.4: one page of the size of the drawing, for `\includegraphics`.
//!
//! The fonts are Helvetica and Symbol of the standard 14, which every reader has; they are not embedded. A character
//! that they lack becomes a question mark.

mod text;
mod widths;

use std::fmt::Write;

use super::drawing::{Drawing, Item, Path, Step, Style, n};
use super::palette::Ink;
use text::Font;

/// A pixel of a drawing [pt]: 96 to the inch, as in SVG.
const POINTS: f64 = 0.75;
/// Length of the handles of the cubic curves that make a quarter of a circle, as a share of its radius.
const HANDLE: f64 = 0.552_284_75;

impl Drawing {
    /// Returns the bytes of a PDF file. The same drawing gives the same bytes.
    pub(in crate::report) fn pdf(&self) -> Vec<u8> {
        let (width, height) = self.size;
        let mut content = format!("{POINTS} 0 0 -{POINTS} 0 {} cm\n1 j\n", n(height * POINTS));
        for item in &self.items {
            match item {
                Item::Path(path, style) => paint(&mut content, &path_data(path), *style),
                Item::Rectangle { at, size, fill, stroke } => {
                    let data = format!("{} {} {} {} re\n", n(at.0), n(at.1), n(size.0), n(size.1));
                    let stroke = stroke.map(|ink| (ink, 1.0));
                    paint(&mut content, &data, Style { fill: Some(*fill), stroke, dashes: &[] });
                }
                Item::Text { at, text } => text::show(&mut content, *at, text),
                // Groups are for readers with a pointer.
                Item::Open { .. } | Item::Close => {}
            }
        }
        let fonts = Font::ALL.map(|font| {
            let encoding = if font == Font::Symbol { "" } else { " /Encoding /WinAnsiEncoding" };
            format!("<< /Type /Font /Subtype /Type1 /BaseFont /{}{encoding} >>", font.name())
        });
        let [regular, bold, symbol] = fonts;
        let page = format!(
            "<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {} {}] /Contents 4 0 R /Resources << /Font << /{} 5 0 R \
             /{} 6 0 R /{} 7 0 R >> >> >>",
            n(width * POINTS),
            n(height * POINTS),
            Font::Regular.resource(),
            Font::Bold.resource(),
            Font::Symbol.resource(),
        );
        file(&[
            "<< /Type /Catalog /Pages 2 0 R >>".to_owned(),
            "<< /Type /Pages /Kids [3 0 R] /Count 1 >>".to_owned(),
            page,
            format!("<< /Length {} >>\nstream\n{content}endstream", content.len()),
            regular,
            bold,
            symbol,
            format!("<< /Title {} /Producer (Lightloom) >>", unicode(&self.label)),
        ])
    }
}

/// Returns a file of these objects, numbered from 1: the first is the catalogue, the last tells of the file.
fn file(objects: &[String]) -> Vec<u8> {
    // The comment after the first line has bytes above 127, so that programs do not take the file for text.
    let mut bytes = b"%PDF-1.4\n%\xe2\xe3\xcf\xd3\n".to_vec();
    let mut offsets = Vec::new();
    for (number, object) in (1..).zip(objects) {
        offsets.push(bytes.len());
        bytes.extend(format!("{number} 0 obj\n{object}\nendobj\n").bytes());
    }
    let start = bytes.len();
    let count = objects.len() + 1;
    let mut end = format!("xref\n0 {count}\n0000000000 65535 f \n");
    for offset in offsets {
        // Each entry has 20 bytes, the end of its line included.
        let _ = writeln!(end, "{offset:010} 00000 n ");
    }
    let _ = write!(
        end,
        "trailer\n<< /Size {count} /Root 1 0 R /Info {} 0 R >>\nstartxref\n{start}\n%%EOF\n",
        objects.len()
    );
    bytes.extend(end.bytes());
    bytes
}

/// Formats a text string in UTF-16, hexadecimal.
fn unicode(text: &str) -> String {
    let digits: String = text.encode_utf16().map(|unit| format!("{unit:04X}")).collect();
    format!("<FEFF{digits}>")
}

/// Returns the operands of a colour: red, green and blue.
fn colour(ink: Ink) -> String {
    let [r, g, b] = ink.rgb().map(|channel| n(f64::from(channel) / 255.0));
    format!("{r} {g} {b}")
}

fn paint(content: &mut String, data: &str, style: Style) {
    if let Some(ink) = style.fill {
        let _ = writeln!(content, "{} rg", colour(ink));
    }
    if let Some((ink, width)) = style.stroke {
        let dashes: Vec<String> = style.dashes.iter().map(|length| n(*length)).collect();
        let _ = writeln!(content, "{} RG {} w [{}] 0 d", colour(ink), n(width), dashes.join(" "));
    }
    content.push_str(data);
    content.push_str(match (style.fill, style.stroke) {
        (Some(_), Some(_)) => "B\n",
        (Some(_), None) => "f\n",
        (None, Some(_)) => "S\n",
        (None, None) => "n\n",
    });
}

fn path_data(path: &Path) -> String {
    let mut data = String::new();
    for step in &path.steps {
        let _ = match *step {
            Step::Start((x, y)) => writeln!(data, "{} {} m", n(x), n(y)),
            Step::To((x, y)) => writeln!(data, "{} {} l", n(x), n(y)),
            Step::Close => writeln!(data, "h"),
            Step::Circle { centre, radius } => circle(&mut data, centre, radius),
        };
    }
    data
}

fn circle(data: &mut String, (x, y): (f64, f64), radius: f64) -> std::fmt::Result {
    writeln!(data, "{} {} m", n(x + radius), n(y))?;
    // From right to bottom, left, top and back: each quarter leaves along one axis and arrives along the other.
    for (from, to) in [((1, 0), (0, 1)), ((0, 1), (-1, 0)), ((-1, 0), (0, -1)), ((0, -1), (1, 0))] {
        let at = |(u, v): (i32, i32), (s, t): (i32, i32)| {
            let (u, v) = (f64::from(u) + HANDLE * f64::from(s), f64::from(v) + HANDLE * f64::from(t));
            format!("{} {}", n(x + radius * u), n(y + radius * v))
        };
        writeln!(data, "{} {} {} c", at(from, to), at(to, from), at(to, (0, 0)))?;
    }
    writeln!(data, "h")
}

#[cfg(test)]
mod tests {
    use super::super::drawing::{Anchor, Text};
    use super::*;

    /// Checks offsets and lengths of a file as a reader uses them, and returns the bodies of its objects.
    fn objects(bytes: &[u8]) -> Vec<String> {
        // One character for each byte.
        let text: String =
            bytes.iter().map(|&byte| if byte < 128 { char::from(byte) } else { '~' }).collect();
        assert!(text.starts_with("%PDF-1.4\n") && text.ends_with("\n%%EOF\n"), "{text}");
        let number = |text: &str| -> usize { text.trim().parse().unwrap_or_else(|_| panic!("{text:?}")) };
        let start = text.rsplit("startxref\n").next().and_then(|rest| rest.lines().next()).expect("a place");
        let table = &text[number(start)..];
        let mut lines = table.lines();
        assert_eq!(lines.next(), Some("xref"));
        let count = number(lines.next().and_then(|line| line.strip_prefix("0 ")).expect("a count"));
        assert_eq!(lines.next(), Some("0000000000 65535 f "));
        let entries: Vec<&str> = lines.by_ref().take(count - 1).collect();
        assert_eq!(lines.next(), Some("trailer"));
        assert!(lines.next().is_some_and(|line| line.contains(&format!("/Size {count} "))), "{table}");
        let object = |(index, entry): (usize, &&str)| {
            assert!(entry.len() == 19 && entry.ends_with(" 00000 n "), "{entry:?}");
            let body = &text[number(&entry[..10])..];
            let body = body.strip_prefix(&format!("{} 0 obj\n", index + 1)).expect("the object is there");
            let body = body.split("\nendobj\n").next().expect("an end").to_owned();
            if let Some((head, rest)) = body.split_once("\nstream\n") {
                let length = head.split("/Length ").nth(1).and_then(|rest| rest.split(' ').next());
                assert_eq!(&rest[number(length.expect("a length"))..], "endstream");
            }
            assert_eq!(body.matches("<<").count(), body.matches(">>").count(), "{body}");
            body
        };
        entries.iter().enumerate().map(object).collect()
    }

    #[test]
    fn every_object_is_where_the_table_says() {
        let mut drawing = Drawing::new("Größe <x>");
        drawing.path(
            Path::circle((10.0, 10.0), 4.0),
            Style { fill: Some(Ink::Rest), ..Style::line(Ink::Text, 1.5) },
        );
        drawing.path(
            Path::through([(0.0, 0.0), (8.0, 9.0)]),
            Style { dashes: &[7.0, 3.0], ..Style::line(Ink::Grid, 1.0) },
        );
        drawing.rectangle((1.0, 2.0), (3.0, 4.0), Ink::Paper, None);
        drawing.text((5.0, 6.0), Text::new("(ꟻLIP) µ", 10.0, Ink::Text, Anchor::Middle));
        let objects = objects(&drawing.finish((100.0, 40.2)).pdf());
        assert_eq!(objects.len(), 8);
        assert!(objects[2].contains("/MediaBox [0 0 75 30.75]"), "{}", objects[2]);
        let content = &objects[3];
        assert!(content.contains("0.75 0 0 -0.75 0 30.75 cm\n"), "{content}");
        assert!(
            content.contains("0.71 0.73 0.76 rg\n0.11 0.12 0.14 RG 1.5 w [] 0 d\n14 10 m\n"),
            "{content}"
        );
        assert!(content.contains("14 12.21 12.21 14 10 14 c\n"), "a quarter: {content}");
        assert!(content.contains("[7 3] 0 d\n0 0 m\n8 9 l\nS\n"), "{content}");
        assert!(content.contains("1 2 3 4 re\nf\n"), "{content}");
        assert!(objects[7].contains("<FEFF004700720"), "{}", objects[7]);
    }
}
