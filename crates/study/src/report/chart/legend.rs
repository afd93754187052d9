//! Legends: rows of names with their marks.

use super::palette::{self, Ink};
use super::svg::{Anchor, SMALL, Svg, Text, shortened, text_width};

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
pub(super) fn draw(svg: &mut Svg, (left, top): (f64, f64), width: f64, entries: &[(Mark, String)]) -> f64 {
    let (mut x, mut y) = (left, top);
    for (mark, name) in entries {
        let name = shortened(name, SMALL, width - MARK - GAP);
        let wide = MARK + GAP + text_width(&name, SMALL);
        if x > left && x + wide > left + width {
            (x, y) = (left, y + ROW);
        }
        let middle = y + ROW / 2.0;
        match *mark {
            Mark::Series(index) => {
                let data = format!("M{x:.2} {middle:.2}h{MARK}");
                svg.path(&data, None, Some((Ink::Series(index), 1.8)), "");
                let marker = palette::marker(index, (x + MARK / 2.0, middle), 4.5);
                svg.path(&marker, Some(Ink::Series(index)), Some((Ink::Paper, 1.0)), "");
            }
            Mark::Square(ink) => svg.rectangle((x + MARK - 13.0, middle - 6.5), (13.0, 13.0), ink, None),
            Mark::Line(dashes) => {
                let data = format!("M{x:.2} {middle:.2}h{MARK}");
                svg.path(&data, None, Some((Ink::Text, 1.4)), palette::dashes(dashes));
            }
            Mark::Front => svg.path(&format!("M{x:.2} {middle:.2}h{MARK}"), None, Some(FRONT), ""),
            Mark::Floor => {
                svg.path(&format!("M{x:.2} {middle:.2}h{MARK}"), None, Some((Ink::Faint, 1.4)), FLOOR);
            }
        }
        svg.text((x + MARK + GAP, middle + 4.0), &Text::new(&name, SMALL, Ink::Text, Anchor::Start));
        x += wide + BETWEEN;
    }
    if entries.is_empty() { 0.0 } else { y + ROW - top }
}

/// The Pareto front: broad and pale, under the lines of the series.
pub(super) const FRONT: (Ink, f64) = (Ink::Rest, 4.0);
/// Dashes of the reference's noise.
pub(super) const FLOOR: &str = "1 4";
