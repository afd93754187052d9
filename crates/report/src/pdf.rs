//! PDF files of one page, whose fonts are embedded. Positions count from the upper left corner downwards.

use crate::font::{BOLD, Font, REGULAR};
use flate2::Compression;
use flate2::write::ZlibEncoder;
use pdf_writer::types::{CidFontType, FontFlags, SystemInfo, UnicodeCmap};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, Str};
use std::collections::BTreeMap;
use std::io::Write;

/// The ordering of glyphs in a font that is embedded as it is.
const IDENTITY: SystemInfo<'_> =
    SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };
/// The least length of the longer side of a picture [px].
const LEAST_SIDE: usize = 384;

/// A picture of 8 bits a channel.
#[derive(Clone, Copy)]
pub(crate) struct Pixels<'a> {
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// Red, green and blue, by rows from above.
    pub(crate) rgb: &'a [u8],
}

/// A page that is being drawn.
pub(crate) struct Page<'a> {
    /// What is drawn, in units of the page.
    pub(crate) content: Content,
    size: (f64, f64),
    /// Points of a unit.
    unit: f64,
    pictures: Vec<Pixels<'a>>,
    /// The glyphs that are used of the usual font and of the bold one, with a character of each.
    used: [BTreeMap<u16, char>; 2],
}

/// How a text is set.
#[derive(Clone, Copy)]
pub(crate) struct Set {
    pub(crate) size: f64,
    pub(crate) rgb: [u8; 3],
    pub(crate) is_bold: bool,
    /// Whether it is turned to be read upwards.
    pub(crate) is_upright: bool,
}

impl Set {
    pub(crate) fn font(self) -> &'static Font {
        if self.is_bold { &BOLD } else { &REGULAR }
    }
}

impl<'a> Page<'a> {
    /// Creates an empty page. Its size is in units of so many points.
    pub(crate) fn new(size: (f64, f64), unit: f64) -> Page<'a> {
        let mut content = Content::new();
        content.transform([unit, 0.0, 0.0, -unit, 0.0, size.1 * unit].map(|value| value as f32));
        Page { content, size, unit, pictures: Vec::new(), used: Default::default() }
    }

    /// Writes a text that begins at a position on the base line.
    pub(crate) fn text(&mut self, (x, y): (f64, f64), text: &str, set: Set) {
        let font = set.font();
        let mut glyphs = Vec::with_capacity(2 * text.len());
        for c in text.chars() {
            let glyph = font.glyph(c).0;
            self.used[usize::from(set.is_bold)].entry(glyph).or_insert(c);
            glyphs.extend(glyph.to_be_bytes());
        }
        if glyphs.is_empty() {
            return;
        }
        let [red, green, blue] = channels(set.rgb);
        // The page is upside down, text is not.
        let (x, y) = (x as f32, y as f32);
        let matrix = if set.is_upright { [0.0, -1.0, -1.0, 0.0, x, y] } else { [1.0, 0.0, 0.0, -1.0, x, y] };
        self.content.begin_text();
        self.content.set_fill_rgb(red, green, blue);
        self.content.set_font(font_name(set.is_bold), set.size as f32);
        self.content.set_text_matrix(matrix);
        self.content.show(Str(&glyphs));
        self.content.end_text();
    }

    /// Paints a picture over an area: left, top, width, height.
    pub(crate) fn picture(&mut self, [left, top, width, height]: [f64; 4], pixels: Pixels<'a>) {
        let name = picture_name(self.pictures.len());
        self.pictures.push(pixels);
        self.content.save_state();
        self.content.transform([width, 0.0, 0.0, -height, left, top + height].map(|value| value as f32));
        self.content.x_object(Name(name.as_bytes()));
        self.content.restore_state();
    }

    /// Returns the file. The same page gives the same bytes.
    pub(crate) fn finish(self) -> Vec<u8> {
        let mut numbers = (1..).map(Ref::new);
        let mut next = || numbers.next().expect("there are numbers enough");
        let [catalog, pages, page_id, content] = std::array::from_fn(|_| next());
        let fonts: Vec<(bool, [Ref; 5])> = [false, true]
            .into_iter()
            .filter(|&is_bold| !self.used[usize::from(is_bold)].is_empty())
            .map(|is_bold| (is_bold, std::array::from_fn(|_| next())))
            .collect();
        let pictures: Vec<(Ref, String)> =
            (0..self.pictures.len()).map(|index| (next(), picture_name(index))).collect();

        let mut pdf = Pdf::new();
        pdf.catalog(catalog).pages(pages);
        pdf.pages(pages).kids([page_id]).count(1);
        let mut page = pdf.page(page_id);
        let [width, height] = [self.size.0, self.size.1].map(|side| (side * self.unit) as f32);
        page.media_box(Rect::new(0.0, 0.0, width, height));
        page.parent(pages).contents(content);
        let mut resources = page.resources();
        let mut named = resources.fonts();
        for (is_bold, [font, ..]) in &fonts {
            named.pair(font_name(*is_bold), *font);
        }
        named.finish();
        let mut named = resources.x_objects();
        for (object, name) in &pictures {
            named.pair(Name(name.as_bytes()), *object);
        }
        named.finish();
        resources.finish();
        page.finish();
        for (is_bold, objects) in &fonts {
            let font = if *is_bold { &*BOLD } else { &*REGULAR };
            embed(&mut pdf, font, &self.used[usize::from(*is_bold)], *objects);
        }
        for (pixels, (object, _)) in self.pictures.iter().zip(&pictures) {
            picture(&mut pdf, *object, *pixels);
        }
        pdf.stream(content, &deflated(&self.content.finish().into_vec())).filter(Filter::FlateDecode);
        pdf.finish()
    }
}

/// Returns the channels of a color, each from 0 to 1.
pub(crate) fn channels(rgb: [u8; 3]) -> [f32; 3] {
    rgb.map(|channel| f32::from(channel) / 255.0)
}

fn font_name(is_bold: bool) -> Name<'static> {
    Name(if is_bold { b"B" } else { b"R" })
}

fn picture_name(index: usize) -> String {
    format!("P{index}")
}

/// Adds a font with the widths of the glyphs that are used, and the characters that they stand for.
fn embed(pdf: &mut Pdf, font: &Font, used: &BTreeMap<u16, char>, objects: [Ref; 5]) {
    let [whole, part, descriptor, file, characters] = objects;
    let name = Name(font.name.as_bytes());
    pdf.type0_font(whole)
        .base_font(name)
        .encoding_predefined(Name(b"Identity-H"))
        .descendant_font(part)
        .to_unicode(characters);
    let mut cid = pdf.cid_font(part);
    cid.subtype(CidFontType::Type2).base_font(name).system_info(IDENTITY).font_descriptor(descriptor);
    cid.cid_to_gid_map_predefined(Name(b"Identity")).default_width(0.0);
    let mut widths = cid.widths();
    for glyph in used.keys() {
        widths.consecutive(*glyph, [font.advance(ttf_parser::GlyphId(*glyph)) as f32]);
    }
    widths.finish();
    cid.finish();
    let face = &font.face;
    let thousandths = |length: i16| font.thousandths(length.into()) as f32;
    let bounds = face.global_bounding_box();
    let [left, bottom, right, top] =
        [bounds.x_min, bounds.y_min, bounds.x_max, bounds.y_max].map(thousandths);
    pdf.font_descriptor(descriptor)
        .name(name)
        .flags(FontFlags::SYMBOLIC)
        .bbox(Rect::new(left, bottom, right, top))
        .italic_angle(0.0)
        .ascent(thousandths(face.ascender()))
        .descent(thousandths(face.descender()))
        .cap_height(thousandths(face.capital_height().unwrap_or(face.ascender())))
        .stem_v(80.0)
        .font_file2(file);
    let data = deflated(font.file);
    let mut stream = pdf.stream(file, &data);
    stream.filter(Filter::FlateDecode);
    stream.pair(Name(b"Length1"), font.file.len() as i32);
    stream.finish();
    let mut map = UnicodeCmap::new(Name(b"Characters"), IDENTITY);
    for (glyph, c) in used {
        map.pair(*glyph, *c);
    }
    pdf.cmap(characters, &map.finish());
}

/// Adds a picture, which is not smoothed. Small ones are enlarged by a whole factor, since many readers smooth what they
/// enlarge by themselves.
fn picture(pdf: &mut Pdf, object: Ref, Pixels { width, height, rgb }: Pixels<'_>) {
    let factor = LEAST_SIDE.div_ceil(width.max(height));
    let mut pixels = Vec::with_capacity(rgb.len() * factor * factor);
    for row in rgb.chunks(3 * width) {
        let wide: Vec<u8> = row.chunks(3).flat_map(|pixel| pixel.repeat(factor)).collect();
        pixels.extend(wide.repeat(factor));
    }
    let data = deflated(&pixels);
    let mut image = pdf.image_xobject(object, &data);
    image.filter(Filter::FlateDecode);
    image.interpolate(false).width((width * factor) as i32).height((height * factor) as i32);
    image.color_space().device_rgb();
    image.bits_per_component(8);
}

fn deflated(data: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    let written = encoder.write_all(data).and_then(|()| encoder.finish());
    written.expect("memory takes all that is written")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fonts_are_embedded_where_they_are_used() {
        let set = Set { size: 7.0, rgb: [0; 3], is_bold: false, is_upright: false };
        let file = |is_bold: &[bool]| {
            let mut page = Page::new((100.0, 50.0), 0.75);
            is_bold.iter().for_each(|&is_bold| page.text((1.0, 2.0), "ꟻLIP", Set { is_bold, ..set }));
            String::from_utf8_lossy(&page.finish()).into_owned()
        };
        assert!(file(&[]).starts_with("%PDF-1.7") && file(&[]).ends_with("%%EOF"));
        assert_eq!(file(&[]).matches("/FontFile2").count(), 0);
        assert!(file(&[false]).contains("/BaseFont /LTLOOM+DejaVuSans\n"), "{}", file(&[false]));
        assert_eq!(file(&[false, true]).matches("/FontFile2").count(), 2);
        assert!(file(&[false]).contains("<A7FB>"), "text can be copied");
        assert!(file(&[]).contains("/MediaBox [0 0 75 37.5]"));
        assert_eq!(file(&[true]), file(&[true]));
    }
}
