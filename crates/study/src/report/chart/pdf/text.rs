//! Text in the standard fonts of PDF.

use std::fmt::Write;

use super::super::drawing::{Anchor, SUPERSCRIPT, Text, n};
use super::{colour, widths};

/// A standard font.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Font {
    Regular,
    Bold,
    Symbol,
}

impl Font {
    pub(super) const ALL: [Font; 3] = [Font::Regular, Font::Bold, Font::Symbol];

    pub(super) fn name(self) -> &'static str {
        match self {
            Font::Regular => "Helvetica",
            Font::Bold => "Helvetica-Bold",
            Font::Symbol => "Symbol",
        }
    }

    /// Returns its name in the content of the page.
    pub(super) fn resource(self) -> &'static str {
        match self {
            Font::Regular => "R",
            Font::Bold => "B",
            Font::Symbol => "S",
        }
    }

    /// Returns the width of a text, as a share of its size.
    fn width(self, codes: &[u8]) -> f64 {
        let widths = match self {
            Font::Regular => &widths::REGULAR,
            Font::Bold => &widths::BOLD,
            Font::Symbol => &widths::SYMBOL,
        };
        let width = |code: &u8| code.checked_sub(32).map_or(0, |index| widths[usize::from(index)]);
        f64::from(codes.iter().map(|code| u32::from(width(code))).sum::<u32>()) / 1000.0
    }
}

/// Characters that are set alike.
#[derive(Clone, Debug, PartialEq)]
struct Run {
    font: Font,
    /// In the encoding of the font.
    codes: Vec<u8>,
    is_raised: bool,
    /// Whether it is mirrored left to right.
    is_mirrored: bool,
}

impl Run {
    fn scale(&self) -> f64 {
        if self.is_raised { SUPERSCRIPT.1 } else { 1.0 }
    }

    /// Returns its width, as a share of the size of the text.
    fn width(&self) -> f64 {
        self.scale() * self.font.width(&self.codes)
    }
}

/// Adds a text to the content of a page. The position is on the base line.
pub(super) fn show(content: &mut String, (x, y): (f64, f64), text: &Text) {
    let mut runs = runs(&text.text, text.bold);
    let exponent = text.exponent_text().map(|exponent| self::runs(&exponent, text.bold));
    for run in exponent.into_iter().flatten() {
        join(&mut runs, Run { is_raised: true, ..run });
    }
    let width: f64 = runs.iter().map(Run::width).sum::<f64>() * text.size;
    let mut along = match text.anchor {
        Anchor::Start => 0.0,
        Anchor::Middle => -width / 2.0,
        Anchor::End => -width,
    };
    let _ = writeln!(content, "{} rg BT", colour(text.ink));
    for run in &runs {
        let wide = run.width() * text.size;
        let up = if run.is_raised { SUPERSCRIPT.0 * text.size } else { 0.0 };
        // A mirrored run is drawn from its right end.
        let (start, sign) = if run.is_mirrored { (along + wide, -1.0) } else { (along, 1.0) };
        // The page's own coordinates go downwards, glyphs do not.
        let matrix = if text.upright {
            [0.0, -sign, -1.0, 0.0, x - up, y - start]
        } else {
            [sign, 0.0, 0.0, -1.0, x + start, y - up]
        };
        let _ = writeln!(
            content,
            "/{} {} Tf {} Tm {} Tj",
            run.font.resource(),
            n(run.scale() * text.size),
            matrix.map(n).join(" "),
            string(&run.codes)
        );
        along += wide;
    }
    content.push_str("ET\n");
}

/// Formats codes as a string: bytes that are not plain ASCII in octal.
fn string(codes: &[u8]) -> String {
    let mut out = String::from("(");
    for &code in codes {
        match code {
            b'(' | b')' | b'\\' => out.extend(['\\', char::from(code)]),
            b' '..=b'~' => out.push(char::from(code)),
            code => {
                let _ = write!(out, "\\{code:03o}");
            }
        }
    }
    out + ")"
}

fn runs(text: &str, is_bold: bool) -> Vec<Run> {
    let plain = if is_bold { Font::Bold } else { Font::Regular };
    let mut runs = Vec::new();
    for c in text.chars() {
        let run =
            |font: Font, code: u8| Run { font, codes: vec![code], is_raised: false, is_mirrored: false };
        let found = match c {
            // Lower F of the name of a measure.
            'ꟻ' => Run { is_mirrored: true, ..run(plain, b'F') },
            '⁰' => Run { is_raised: true, ..run(plain, b'0') },
            '⁴'..='⁹' => {
                let digit = u8::try_from(u32::from(c) - u32::from('⁰')).unwrap_or(0);
                Run { is_raised: true, ..run(plain, b'0' + digit) }
            }
            '⁻' => Run { is_raised: true, ..run(Font::Symbol, b'-') },
            c => match (win_ansi(c), symbol(c)) {
                (Some(code), _) => run(plain, code),
                (None, Some(code)) => run(Font::Symbol, code),
                (None, None) => run(plain, b'?'),
            },
        };
        join(&mut runs, found);
    }
    runs
}

/// Adds a run to others, or its codes to the last of them if that is set alike.
fn join(runs: &mut Vec<Run>, run: Run) {
    match runs.last_mut() {
        Some(last)
            if (last.font, last.is_raised, last.is_mirrored)
                == (run.font, run.is_raised, run.is_mirrored) =>
        {
            last.codes.extend(run.codes);
        }
        _ => runs.push(run),
    }
}

/// Returns the code of a character in the encoding of the text fonts.
fn win_ansi(c: char) -> Option<u8> {
    match c {
        '€' => Some(0x80),
        '…' => Some(0x85),
        '‘' => Some(0x91),
        '’' => Some(0x92),
        '“' => Some(0x93),
        '”' => Some(0x94),
        '•' => Some(0x95),
        '–' => Some(0x96),
        '—' => Some(0x97),
        c => u8::try_from(u32::from(c)).ok().filter(|code| matches!(code, 0x20..=0x7e | 0xa0..=0xff)),
    }
}

/// Returns the code of a character in the encoding of Symbol.
fn symbol(c: char) -> Option<u8> {
    let code = match c {
        '−' => 0x2d,
        '≤' => 0xa3,
        '≥' => 0xb3,
        '→' => 0xae,
        '′' => 0xa2,
        '∞' => 0xa5,
        '∝' => 0xb5,
        'Δ' => b'D',
        'α' => b'a',
        'β' => b'b',
        'γ' => b'g',
        'δ' => b'd',
        'ε' => b'e',
        'θ' => b'q',
        'λ' => b'l',
        'μ' => b'm',
        'π' => b'p',
        'ρ' => b'r',
        'σ' => b's',
        'τ' => b't',
        'φ' => b'f',
        'ω' => b'w',
        _ => return None,
    };
    Some(code)
}

#[cfg(test)]
mod tests {
    use super::super::super::palette::Ink;
    use super::*;

    fn shown(text: &Text) -> String {
        let mut content = String::new();
        show(&mut content, (50.0, 20.0), text);
        content
    }

    #[test]
    fn text_is_placed_by_the_metrics_of_its_font() {
        // A, V: 667 thousandths each; in bold 722 and 667.
        let at = |anchor| Text::new("AV", 10.0, Ink::Text, anchor);
        assert!(shown(&at(Anchor::Start)).contains("/R 10 Tf 1 0 0 -1 50 20 Tm (AV) Tj"));
        assert!(shown(&at(Anchor::End)).contains("1 0 0 -1 36.66 20 Tm"));
        let bold = Text { bold: true, ..at(Anchor::End) };
        assert!(shown(&bold).contains("/B 10 Tf 1 0 0 -1 36.11 20 Tm"), "{}", shown(&bold));
        let upright = Text { upright: true, ..at(Anchor::Middle) };
        assert!(shown(&upright).contains("0 -1 -1 0 50 26.67 Tm"), "{}", shown(&upright));
    }

    #[test]
    fn characters_beyond_the_text_font_are_found() {
        let text = Text::new("|E′| (ꟻ²) \\ 世", 10.0, Ink::Text, Anchor::Start);
        let shown = shown(&text);
        for part in [
            "(|E) Tj",
            "/S 10 Tf 1 0 0 -1",
            "(\\242) Tj",
            "(| \\() Tj",
            "-1 0 0 -1",
            "(F) Tj",
            "(\\262\\) \\\\ ?) Tj",
        ] {
            assert!(shown.contains(part), "{part} is not in {shown}");
        }
        let power = Text { exponent: Some(-3), ..Text::new("10", 10.0, Ink::Text, Anchor::Start) };
        let mut content = String::new();
        show(&mut content, (0.0, 0.0), &power);
        // Two digits of 556 thousandths, then the exponent.
        assert!(content.contains("/S 7.5 Tf 1 0 0 -1 11.12 -3.8 Tm (-) Tj"), "{content}");
        assert!(content.contains("/R 7.5 Tf 1 0 0 -1 15.24 -3.8 Tm (3) Tj"), "{content}");
    }
}
