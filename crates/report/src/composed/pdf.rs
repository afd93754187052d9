//! A figure as a PDF file of one page.

use super::{Area, Composed, FRAME, TEXT, WIDTH, color};
use crate::pdf::{Page, Pixels, Set, channels};

/// The least size of text [pt]: what is still too wide is cut.
const LEAST_TEXT: f64 = 5.0;

impl Composed {
    /// Returns the figure as a PDF file, whose pictures are not smoothed and whose font is embedded. The same figure gives
    /// the same bytes.
    pub fn pdf(&self) -> Vec<u8> {
        self.page().finish()
    }

    fn page(&self) -> Page<'_> {
        let layout = self.layout();
        let mut page = Page::new((WIDTH, layout.height), 1.0);
        for (raster, area, _) in self.placed(&layout) {
            let pixels = Pixels { width: raster.width, height: raster.height, rgb: &raster.rgb };
            page.picture([area.left, area.top, area.width, area.height], pixels);
        }
        page.content.set_line_width(FRAME as f32);
        let crops = self.placed(&layout).filter_map(|(_, area, crop)| Some((area, crop?)));
        let on_picture = layout.frames.iter().enumerate().map(|(crop, area)| (*area, crop));
        for (area, crop) in crops.chain(on_picture) {
            let [red, green, blue] = channels(color(crop));
            page.content.set_stroke_rgb(red, green, blue);
            let Area { left, top, width, height } = inset(area);
            page.content.rect(left as f32, top as f32, width as f32, height as f32);
            page.content.stroke();
        }
        let line = |index: usize| layout.picture.height + TEXT.1 * (index as f64 + 0.9);
        write(&mut page, &self.name, layout.picture, line(0));
        for (column, areas) in self.columns.iter().zip(&layout.columns) {
            for (index, (text, _)) in column.lines().enumerate() {
                write(&mut page, text, areas[0], line(index));
            }
        }
        page
    }
}

/// Returns the area within which a frame's line stays.
fn inset(area: Area) -> Area {
    let Area { left, top, width, height } = area;
    let half = FRAME / 2.0;
    Area {
        left: left + half,
        top: top + half,
        width: (width - FRAME).max(0.0),
        height: (height - FRAME).max(0.0),
    }
}

/// Writes a line in the middle of an area's width.
fn write(page: &mut Page<'_>, text: &str, area: Area, y: f64) {
    let set = Set { size: TEXT.0, rgb: [0; 3], is_bold: false, is_upright: false };
    let (text, size) = fitted(text, area.width, |text| set.font().width(text));
    let x = area.left + (area.width - size * set.font().width(&text)) / 2.0;
    page.text((x, y), &text, Set { size, ..set });
}

/// Returns a text and the size in which it fits into a width: smaller where it is too wide, and cut where that is not enough.
fn fitted(text: &str, most: f64, width: impl Fn(&str) -> f64) -> (String, f64) {
    let size = (most / width(text).max(1e-9)).clamp(LEAST_TEXT, TEXT.0);
    let mut kept = text.to_owned();
    if size * width(&kept) > most {
        while !kept.is_empty() && size * width(&format!("{kept}…")) > most {
            kept.pop();
        }
        kept.push('…');
    }
    (kept, size)
}

#[cfg(test)]
mod tests {
    use super::super::tests::figure;
    use super::*;

    #[test]
    fn a_file_has_one_page_and_every_picture() {
        let figure = figure(2, &[(8, 8), (8, 4)]);
        let pdf = figure.pdf();
        let text = String::from_utf8_lossy(&pdf);
        assert_eq!(text.matches("/Subtype /Image").count(), 1 + 2 * 2);
        assert!(text.contains("/Width 384"), "8 pixels, 48 times");
        assert!(text.contains("/MediaBox [0 0 506 "), "{text}");
        assert_eq!(pdf, figure.pdf());
    }

    #[test]
    fn crops_are_painted_where_they_stand_with_frames() {
        let figure = figure(2, &[(8, 8)]);
        let content = String::from_utf8_lossy(&figure.page().content.finish().into_vec()).into_owned();
        // Two crops and the frame on the picture.
        assert_eq!((content.matches(" Do").count(), content.matches(" re\nS").count()), (3, 3), "{content}");
        let Area { left, top, .. } = inset(figure.layout().frames[0]);
        assert!(content.contains(&format!("{} {} ", left as f32, top as f32)), "{content}");
    }

    #[test]
    fn text_fits() {
        let width = |text: &str| text.chars().count() as f64 * 0.5;
        assert_eq!(fitted("short", 40.0, width), ("short".to_owned(), TEXT.0));
        assert_eq!(fitted("a bit longer", 36.0, width), ("a bit longer".to_owned(), 6.0));
        let (cut, size) = fitted(&"a long name ".repeat(20), 40.0, width);
        assert!(cut.ends_with('…') && size == LEAST_TEXT && size * width(&cut) <= 40.0, "{cut}");
        assert_eq!(fitted("", 40.0, width), (String::new(), TEXT.0));
    }
}
