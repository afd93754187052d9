//! The fonts that files for papers hold: DejaVu Sans, without the scripts that figures seldom need.

use std::sync::LazyLock;
use ttf_parser::{Face, GlyphId};

/// A font, in its file.
pub(crate) struct Font {
    /// Its name in a PDF file; the letters before the sign say that it is a part of a font.
    pub(crate) name: &'static str,
    /// The TrueType file.
    pub(crate) file: &'static [u8],
    pub(crate) face: Face<'static>,
}

/// The upright font of usual weight.
pub(crate) static REGULAR: LazyLock<Font> =
    LazyLock::new(|| Font::new("LTLOOM+DejaVuSans", include_bytes!("../fonts/DejaVuSans.ttf")));

/// The bold font.
pub(crate) static BOLD: LazyLock<Font> =
    LazyLock::new(|| Font::new("LTLOOM+DejaVuSans-Bold", include_bytes!("../fonts/DejaVuSans-Bold.ttf")));

impl Font {
    fn new(name: &'static str, file: &'static [u8]) -> Font {
        Font { name, file, face: Face::parse(file, 0).expect("a font of the tree") }
    }

    /// Returns the glyph of a character: that of a question mark where the font lacks it.
    pub(crate) fn glyph(&self, c: char) -> GlyphId {
        self.face.glyph_index(c).or_else(|| self.face.glyph_index('?')).unwrap_or_default()
    }

    /// Returns how far a glyph advances, in thousandths of the size.
    pub(crate) fn advance(&self, glyph: GlyphId) -> f64 {
        let advance = self.face.glyph_hor_advance(glyph).unwrap_or_default();
        self.thousandths(advance.into())
    }

    /// Returns a length in units of the font as thousandths of its size.
    pub(crate) fn thousandths(&self, length: f64) -> f64 {
        length * 1000.0 / f64::from(self.face.units_per_em())
    }

    /// Returns the width of a text of size 1.
    pub(crate) fn width(&self, text: &str) -> f64 {
        text.chars().map(|c| self.advance(self.glyph(c))).sum::<f64>() / 1000.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn characters_of_figures_have_glyphs_and_widths() {
        for font in [&*REGULAR, &*BOLD] {
            for c in "Aaäß0 ⁻⁰¹²³⁴⁵⁶⁷⁸⁹₀·×±−–…’′“”≤≥≈<>→²ꟻµμδσεΔ°√∞".chars()
            {
                assert!(font.face.glyph_index(c).is_some(), "{} has no {c:?}", font.name);
            }
            assert!(font.width("mm") > font.width("ii") && font.width("") == 0.0);
            assert_eq!(font.glyph('漢'), font.glyph('?'));
        }
        // 1401 of 2048 units, as DejaVu's own metrics say.
        assert!((REGULAR.width("A") - 1401.0 / 2048.0).abs() < 1e-9);
    }
}
