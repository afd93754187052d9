//! Legends: rows of names with their marks.

use super::drawing::{Anchor, Drawing, Path, SMALL, Style, Text, shortened, text_width};
use super::palette::{self, Ink};

/// Height of a row [px].
const ROW: f64 = 18.0;
/// Width of a mark, and the gaps after it and after a name [px].
const MARK: f64 = 24.0;
const GAP: f64 = 6.0;
const BETWEEN: f64 = 18.0;

/// The mark of an entry.
#[derive(Clone, Copy)]
pub(super) enum Mark {
    /// Line and marker of a series.
    Series(usize),
    /// A line by its dashes.
    Line(usize),
    /// A square.
    Square(Ink),
    /// The Pareto front.
    Front,
    /// The noise of the reference.
    Floor,
}

/// Draws entries from the left, as many per row as fit in `width`; returns the height that they take [px].
pub(super) fn draw(
    drawing: &mut Drawing,
    (left, top): (f64, f64),
    width: f64,
    entries: &[(Mark, String)],
) -> f64 {
    let (mut x, mut y) = (left, top);
    for (mark, name) in entries {
        let name = shortened(name, SMALL, width - MARK - GAP);
        let wide = MARK + GAP + text_width(&name, SMALL);
        if x > left && x + wide > left + width {
            (x, y) = (left, y + ROW);
        }
        let middle = y + ROW / 2.0;
        let line = Path::through([(x, middle), (x + MARK, middle)]);
        match *mark {
            Mark::Series(index) => {
                drawing.path(line, Style::line(Ink::Series(index), 1.8));
                let marker = palette::marker(index, (x + MARK / 2.0, middle), 4.5);
                let style = Style { fill: Some(Ink::Series(index)), ..Style::line(Ink::Paper, 1.0) };
                drawing.path(marker, style);
            }
            Mark::Square(ink) => drawing.rectangle((x + MARK - 13.0, middle - 6.5), (13.0, 13.0), ink, None),
            Mark::Line(dashes) => {
                let dashes = palette::dashes(dashes);
                drawing.path(line, Style { dashes, ..Style::line(Ink::Text, 1.4) });
            }
            Mark::Front => drawing.path(line, FRONT),
            Mark::Floor => drawing.path(line, FLOOR),
        }
        drawing.text((x + MARK + GAP, middle + 4.0), Text::new(&name, SMALL, Ink::Text, Anchor::Start));
        x += wide + BETWEEN;
    }
    if entries.is_empty() { 0.0 } else { y + ROW - top }
}

/// The Pareto front: broad and pale, under the lines of the series.
pub(super) const FRONT: Style = Style { fill: None, stroke: Some((Ink::Rest, 4.0)), dashes: &[] };
/// The noise of the reference: dotted.
pub(super) const FLOOR: Style = Style { fill: None, stroke: Some((Ink::Faint, 1.4)), dashes: &[1.0, 4.0] };
