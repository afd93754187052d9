//! A figure as a PDF file of one page, in Helvetica, which every reader has.

use super::{Area, Composed, FRAME, Layout, Raster, TEXT, WIDTH, color};
use flate2::Compression;
use flate2::write::ZlibEncoder;
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, Str};
use std::io::Write;

const CATALOG: Ref = Ref::new(1);
const PAGES: Ref = Ref::new(2);
const PAGE: Ref = Ref::new(3);
const FONT: Ref = Ref::new(4);
const CONTENT: Ref = Ref::new(5);
/// The number of the first picture's object.
const FIRST_PICTURE: i32 = 6;
const HELVETICA: Name<'_> = Name(b"F");
/// The least size of text [pt]: what is still too wide is cut.
const LEAST_TEXT: f64 = 5.0;
/// The least length of the longer side of a picture [px].
const LEAST_SIDE: usize = 384;
/// How far exponents stand above the base line, and their size, as shares of the size of the text.
const EXPONENT: (f64, f64) = (0.35, 0.75);

/// Widths of the characters of Helvetica from the space to `~`, in thousandths of its size (Adobe's font metrics).
const WIDTHS: [u16; 95] = [
    278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333, 278, 278, 556, 556, 556, 556, 556,
    556, 556, 556, 556, 556, 278, 278, 584, 584, 584, 556, 1015, 667, 667, 722, 722, 667, 611, 778, 722, 278,
    500, 667, 556, 833, 722, 778, 667, 778, 722, 667, 611, 722, 667, 944, 667, 667, 611, 278, 278, 278, 469,
    556, 333, 556, 556, 500, 556, 556, 278, 556, 556, 222, 222, 500, 222, 833, 556, 556, 556, 556, 333, 500,
    278, 556, 500, 722, 500, 500, 500, 334, 260, 334, 584,
];

impl Composed {
    /// Returns the figure as a PDF file, whose pictures are not smoothed. The same figure gives the same bytes.
    pub fn pdf(&self) -> Vec<u8> {
        let layout = self.layout();
        let mut pdf = Pdf::new();
        pdf.catalog(CATALOG).pages(PAGES);
        pdf.pages(PAGES).kids([PAGE]).count(1);
        let pictures: Vec<(Ref, String)> = (0..self.placed(&layout).count() as i32)
            .map(|index| (Ref::new(FIRST_PICTURE + index), format!("P{index}")))
            .collect();
        let mut page = pdf.page(PAGE);
        page.media_box(Rect::new(0.0, 0.0, WIDTH as f32, layout.height as f32));
        page.parent(PAGES).contents(CONTENT);
        let mut resources = page.resources();
        resources.fonts().pair(HELVETICA, FONT);
        let mut objects = resources.x_objects();
        for (object, name) in &pictures {
            objects.pair(Name(name.as_bytes()), *object);
        }
        objects.finish();
        resources.finish();
        page.finish();
        pdf.type1_font(FONT).base_font(Name(b"Helvetica")).encoding_predefined(Name(b"WinAnsiEncoding"));
        for ((raster, ..), (object, _)) in self.placed(&layout).zip(&pictures) {
            picture(&mut pdf, *object, raster);
        }
        let content = self.content(&layout, &pictures);
        pdf.stream(CONTENT, &deflated(&content)).filter(Filter::FlateDecode);
        pdf.finish()
    }

    fn content(&self, layout: &Layout, pictures: &[(Ref, String)]) -> Vec<u8> {
        let mut content = Content::new();
        for ((_, area, _), (_, name)) in self.placed(layout).zip(pictures) {
            let [x, y, width, height] = corners(layout, area);
            content.save_state();
            content.transform([width, 0.0, 0.0, height, x, y]);
            content.x_object(Name(name.as_bytes()));
            content.restore_state();
        }
        content.set_line_width(FRAME as f32);
        let crops = self.placed(layout).filter_map(|(_, area, crop)| Some((area, crop?)));
        let on_picture = layout.frames.iter().enumerate().map(|(crop, area)| (*area, crop));
        for (area, crop) in crops.chain(on_picture) {
            let [red, green, blue] = color(crop);
            content.set_stroke_rgb(red, green, blue);
            let [x, y, width, height] = corners(layout, inset(area));
            content.rect(x, y, width, height);
            content.stroke();
        }
        let below = layout.height - layout.picture.height;
        let line = |index: usize| below - TEXT.1 * (index as f64 + 0.9);
        write(&mut content, &self.name, layout.picture, line(0));
        for (column, areas) in self.columns.iter().zip(&layout.columns) {
            for (index, (text, _)) in column.lines().enumerate() {
                write(&mut content, text, areas[0], line(index));
            }
        }
        content.finish().into_vec()
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

/// Returns the lower left corner, width and height, as PDF counts them: upwards.
fn corners(layout: &Layout, area: Area) -> [f32; 4] {
    [area.left, layout.height - area.top - area.height, area.width, area.height].map(|value| value as f32)
}

/// Adds a picture. Small ones are enlarged by a whole factor, since many readers smooth what they enlarge by themselves.
fn picture(pdf: &mut Pdf, object: Ref, raster: &Raster) {
    let factor = LEAST_SIDE.div_ceil(raster.width.max(raster.height));
    let mut pixels = Vec::with_capacity(raster.rgb.len() * factor * factor);
    for row in raster.rgb.chunks(3 * raster.width) {
        let wide: Vec<u8> = row.chunks(3).flat_map(|pixel| pixel.repeat(factor)).collect();
        pixels.extend(wide.repeat(factor));
    }
    let data = deflated(&pixels);
    let mut image = pdf.image_xobject(object, &data);
    image.filter(Filter::FlateDecode);
    image.interpolate(false).width((raster.width * factor) as i32).height((raster.height * factor) as i32);
    image.color_space().device_rgb();
    image.bits_per_component(8);
}

fn deflated(data: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    let written = encoder.write_all(data).and_then(|()| encoder.finish());
    written.expect("memory takes all that is written")
}

/// Writes a line in the middle of an area's width: smaller where it is too wide, and cut where that is not enough.
fn write(content: &mut Content, text: &str, area: Area, y: f64) {
    let mut runs = runs(text);
    let size = (TEXT.0 * area.width / width(&runs, TEXT.0).max(1e-9)).clamp(LEAST_TEXT, TEXT.0);
    while width(&runs, size) > area.width && runs.pop().is_some() {
        match runs.last_mut() {
            // Three dots, in one character.
            Some(last) => *last = (0x85, false),
            None => break,
        }
    }
    let x = area.left + (area.width - width(&runs, size)) / 2.0;
    content.begin_text();
    content.set_fill_rgb(0.0, 0.0, 0.0);
    content.next_line(x as f32, y as f32);
    for run in runs.chunk_by(|a, b| a.1 == b.1) {
        let is_exponent = run[0].1;
        let (rise, scale) = if is_exponent { EXPONENT } else { (0.0, 1.0) };
        content.set_font(HELVETICA, (size * scale) as f32);
        content.set_rise((size * rise) as f32);
        content.show(Str(&run.iter().map(|(byte, _)| *byte).collect::<Vec<_>>()));
    }
    content.end_text();
}

/// Returns the width of characters [pt].
fn width(runs: &[(u8, bool)], size: f64) -> f64 {
    let one = |&(byte, is_exponent): &(u8, bool)| {
        let width = match byte {
            0x85 => 1000,
            0xb7 => 278,
            0xb1 | 0xd7 => 584,
            byte => WIDTHS.get(usize::from(byte).wrapping_sub(32)).copied().unwrap_or(556),
        };
        f64::from(width) / 1000.0 * if is_exponent { EXPONENT.1 } else { 1.0 }
    };
    runs.iter().map(one).sum::<f64>() * size
}

/// Returns the characters of a text in the encoding of PDF for western languages, and whether each is an exponent. What it
/// lacks is written with what it has.
fn runs(text: &str) -> Vec<(u8, bool)> {
    let mut out = Vec::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '¹' => out.push((b'1', true)),
            '²' => out.push((b'2', true)),
            '³' => out.push((b'3', true)),
            ' '..='~' | '\u{a0}'..='\u{ff}' => out.push((u32::from(c) as u8, false)),
            '⁰' | '⁴'..='⁹' => out.push((b'0' + (u32::from(c) - u32::from('⁰')) as u8, true)),
            '⁻' => out.push((b'-', true)),
            '−' => out.push((b'-', false)),
            '–' => out.push((0x96, false)),
            '…' => out.push((0x85, false)),
            '’' => out.push((0x92, false)),
            '′' => out.push((b'\'', false)),
            'ꟻ' => out.push((b'F', false)),
            'μ' => out.push((0xb5, false)),
            'δ' => out.extend(b"delta".map(|byte| (byte, false))),
            'σ' => out.extend(b"sigma".map(|byte| (byte, false))),
            'ε' => out.extend(b"epsilon".map(|byte| (byte, false))),
            _ => out.push((b'?', false)),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::tests::figure;
    use super::*;

    #[test]
    fn a_file_has_one_page_and_every_picture() {
        let figure = figure(2, &[(8, 8), (8, 4)]);
        let pdf = figure.pdf();
        assert!(pdf.starts_with(b"%PDF-1.7") && pdf.ends_with(b"%%EOF"));
        let text = String::from_utf8_lossy(&pdf);
        assert_eq!(text.matches("/Subtype /Image").count(), 1 + 2 * 2);
        assert!(text.contains("/Width 384"), "8 pixels, 48 times");
        assert!(text.contains("/BaseFont /Helvetica") && text.contains("/MediaBox [0 0 506 "), "{text}");
        assert_eq!(pdf, figure.pdf());
    }

    #[test]
    fn crops_are_painted_where_they_stand_with_frames_and_numbers() {
        let figure = figure(2, &[(8, 8)]);
        let layout = figure.layout();
        let names = [0, 1, 2].map(|index| (Ref::new(6 + index), format!("P{index}")));
        let content = String::from_utf8_lossy(&figure.content(&layout, &names)).into_owned();
        // Two crops and the frame on the picture.
        assert_eq!((content.matches(" Do").count(), content.matches(" re\nS").count()), (3, 3), "{content}");
        assert!(content.contains("(method_1) Tj"), "{content}");
        // The exponent is raised, and what follows would not be.
        assert!(content.contains("2.45 Ts\n(-5) Tj"), "{content}");
        let frame = inset(layout.frames[0]);
        let [x, y, width, height] = corners(&layout, frame);
        assert!((y + height + frame.top as f32 - layout.height as f32).abs() < 1e-3);
        assert!((x - frame.left as f32).abs() < 1e-6 && width > 0.0);
    }

    #[test]
    fn text_is_in_the_encoding_and_fits() {
        let plain: Vec<(u8, bool)> = b"FLIP 10".iter().map(|byte| (*byte, false)).collect();
        assert_eq!(runs("ꟻLIP 10⁻⁵"), [&plain[..], &[(b'-', true), (b'5', true)]].concat());
        assert_eq!(runs("±·×µ"), [0xb1, 0xb7, 0xd7, 0xb5].map(|byte| (byte, false)));
        assert_eq!(runs("m²"), [(b'm', false), (b'2', true)]);
        // "Hi": 722 and 222 thousandths.
        assert!((width(&runs("Hi"), 10.0) - 9.44).abs() < 1e-9);
        let area = Area { left: 10.0, top: 0.0, width: 40.0, height: 1.0 };
        let mut content = Content::new();
        write(&mut content, &"a long name ".repeat(20), area, 5.0);
        let written = String::from_utf8_lossy(&content.finish().into_vec()).into_owned();
        assert!(written.contains("/F 5 Tf") && written.contains("85> Tj"), "{written}");
        let mut content = Content::new();
        write(&mut content, "", area, 5.0);
        assert!(String::from_utf8_lossy(&content.finish().into_vec()).contains("30 5 Td"), "in the middle");
    }
}
