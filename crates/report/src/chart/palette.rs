//! Colors and shapes that are distinguishable for color-blind readers, on paper and on a dark page.

use std::fmt::Write;

use super::drawing::Path;

/// The color role of a mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// The background.
    Paper,
    /// Text and axes.
    Text,
    /// Labels of ticks, notes.
    Faint,
    /// Grid lines.
    Grid,
    /// A pipeline, by index.
    Series(usize),
    /// A part of a stack, by index below [`MOST_PARTS`].
    Part(usize),
    /// Segments that have no color of their own.
    Rest,
}

/// A color on a white and on a dark background.
type Pair = (&'static str, &'static str);

/// Okabe and Ito 2008, without yellow, which is invisible on white; then wine, indigo and olive of Tol's
/// muted scheme (2021).
const SERIES: [Pair; MOST_COLORS] = [
    ("#0072b2", "#4aa3e0"),
    ("#d55e00", "#ff8b42"),
    ("#009e73", "#2fc79b"),
    ("#cc79a7", "#e69cc6"),
    ("#e69f00", "#f2c14e"),
    ("#56b4e9", "#a5dbf8"),
    ("#4d4d4d", "#c4c4c4"),
    ("#882255", "#c0507f"),
    ("#332288", "#8f86f0"),
    ("#77771f", "#b5b54a"),
];

/// How many series have a color of their own.
pub const MOST_COLORS: usize = 10;

/// Tol 2021, "Color Schemes", §2, the muted scheme; neighbours differ in lightness.
const PARTS: [Pair; MOST_PARTS] = [
    ("#332288", "#7b6fe0"),
    ("#88ccee", "#88ccee"),
    ("#117733", "#35a05a"),
    ("#ddcc77", "#ddcc77"),
    ("#cc6677", "#e08391"),
    ("#44aa99", "#44aa99"),
    ("#882255", "#bb4f87"),
    ("#999933", "#b5b54a"),
    ("#aa4499", "#cf74bf"),
];

/// How many parts of a stack have a color of their own.
pub const MOST_PARTS: usize = 9;

impl Ink {
    /// Returns the name of the CSS variable, which is also the ending of the classes.
    fn name(self) -> String {
        match self {
            Ink::Paper => "paper".to_owned(),
            Ink::Text => "text".to_owned(),
            Ink::Faint => "faint".to_owned(),
            Ink::Grid => "grid".to_owned(),
            Ink::Series(index) => format!("s{}", index % SERIES.len()),
            Ink::Part(index) => format!("p{}", index % PARTS.len()),
            Ink::Rest => "rest".to_owned(),
        }
    }

    /// Returns the color on a white background: red, green and blue.
    pub(crate) fn rgb(self) -> [u8; 3] {
        let digits = self.pair().0;
        std::array::from_fn(|channel| {
            let at = 1 + 2 * channel;
            u8::from_str_radix(&digits[at..at + 2], 16).expect("colors are six digits")
        })
    }

    fn pair(self) -> Pair {
        match self {
            Ink::Paper => ("#ffffff", "#14171c"),
            Ink::Text => ("#1b1f24", "#e6e9ee"),
            Ink::Faint => ("#59626e", "#a0aab8"),
            Ink::Grid => ("#e3e6ea", "#2b313a"),
            Ink::Series(index) => SERIES[index % SERIES.len()],
            Ink::Part(index) => PARTS[index % PARTS.len()],
            Ink::Rest => ("#b4bac2", "#68717e"),
        }
    }
}

/// Returns `class`, `fill` and `stroke` of an element.
pub(super) fn paint(fill: Option<Ink>, stroke: Option<Ink>) -> String {
    let class = |letter: char, ink: Option<Ink>| ink.map(|ink| format!("{letter}-{}", ink.name()));
    let classes: Vec<String> = [class('f', fill), class('k', stroke)].into_iter().flatten().collect();
    let mut out =
        format!(" class=\"{}\" fill=\"{}\"", classes.join(" "), fill.map_or("none", |ink| ink.pair().0));
    if let Some(ink) = stroke {
        let _ = write!(out, " stroke=\"{}\"", ink.pair().0);
    }
    out
}

/// Dashes of lines and the gaps between them [px]; the first is none.
const DASHES: [&[f64]; MOST_DASHES] = [&[], &[7.0, 3.0], &[2.0, 3.0], &[9.0, 3.0, 2.0, 3.0]];

/// The number of lines of one series that can be distinguished.
pub const MOST_DASHES: usize = 4;

/// Returns the dashes of a line.
pub(super) fn dashes(line: usize) -> &'static [f64] {
    DASHES[line % DASHES.len()]
}

/// Returns CSS rules that give each class its color on a light and on a dark page, and the colors as
/// variables for the page itself.
pub(crate) fn style_sheet() -> String {
    let fixed = [Ink::Paper, Ink::Text, Ink::Faint, Ink::Grid, Ink::Rest];
    let series = (0..SERIES.len()).map(Ink::Series);
    let parts = (0..PARTS.len()).map(Ink::Part);
    let (mut variables, mut rules) = (String::new(), String::new());
    for ink in fixed.into_iter().chain(series).chain(parts) {
        let (name, (light, dark)) = (ink.name(), ink.pair());
        let _ = writeln!(variables, "  --{name}: light-dark({light}, {dark});");
        let _ =
            writeln!(rules, ".f-{name} {{ fill: var(--{name}); }} .k-{name} {{ stroke: var(--{name}); }}");
    }
    format!(":root {{\n{variables}}}\n{rules}")
}

/// Returns the outline of the marker of a series, with a radius of about `radius`. Each color has a shape of its own, by which
/// it is told apart in grey.
pub(super) fn marker(series: usize, (x, y): (f64, f64), radius: f64) -> Path {
    /// A quarter of a plus.
    const ARM: [(f64, f64); 3] = [(0.4, -1.2), (0.4, -0.4), (1.2, -0.4)];
    const TRIANGLE: [(f64, f64); 3] = [(0.0, -1.2), (1.15, 0.85), (-1.15, 0.85)];
    let turned = |corners: &[(f64, f64)], turn: f64| -> Vec<(f64, f64)> {
        let (sin, cos) = (turn * std::f64::consts::TAU).sin_cos();
        corners.iter().map(|(dx, dy)| (cos * dx - sin * dy, sin * dx + cos * dy)).collect()
    };
    let regular = |corners: u32, size: f64, turn: f64| -> Vec<(f64, f64)> {
        let corner = |index: u32| turned(&[(0.0, -size)], turn + f64::from(index) / f64::from(corners));
        (0..corners).flat_map(corner).collect()
    };
    let plus = |turn: f64| -> Vec<(f64, f64)> {
        (0..4).flat_map(|quarter| turned(&ARM, turn + f64::from(quarter) / 4.0)).collect()
    };
    let corners = match series % MOST_COLORS {
        0 => return Path::circle((x, y), radius),
        1 => regular(4, 0.9 * std::f64::consts::SQRT_2, 1.0 / 8.0),
        2 => regular(4, 1.25, 0.0),
        3 => TRIANGLE.to_vec(),
        4 => turned(&TRIANGLE, 0.5),
        5 => plus(0.0),
        6 => turned(&TRIANGLE, 0.25),
        7 => plus(1.0 / 8.0),
        8 => turned(&TRIANGLE, 0.75),
        _ => regular(6, 1.1, 0.0),
    };
    Path::polygon(corners.iter().map(|(dx, dy)| (x + dx * radius, y + dy * radius)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_color_has_a_marker_of_its_own() {
        let markers: Vec<Path> = (0..MOST_COLORS).map(|series| marker(series, (0.0, 0.0), 1.0)).collect();
        for (index, one) in markers.iter().enumerate() {
            assert!(markers[..index].iter().all(|other| other != one), "{index}: {one:?}");
        }
    }
}
