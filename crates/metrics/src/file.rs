//! Image files. A new file is complete or absent: it is written under a temporary name, and then renamed.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufWriter, Cursor, Write};
use std::path::Path;

use exr::prelude as exr;
use serde::{Deserialize, Serialize};
use whole_file::Unfinished;

use crate::decode::{self, guarded};
use crate::image::is_finite;
use crate::{Display, Image, ImageError, linear_from_srgb, pfm, srgb_from_linear};

/// The name under which the provenance of a picture is stored in its file: a string attribute in EXR, the
/// keyword of an iTXt chunk in PNG.
pub const PROVENANCE_KEY: &str = "lightloom";

/// The longest provenance that is unpacked, in bytes; records of whole sequences have a thousandth of it.
const MAX_PROVENANCE: usize = 16 << 20;

/// The image formats, determined by the ending of the file name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FileFormat {
    /// OpenEXR: linear `f32`, lossless, with provenance.
    Exr,
    /// PNG: 8-bit sRGB, with provenance.
    Png,
    /// Portable float map: linear `f32` RGB, no provenance.
    Pfm,
    /// Radiance RGBE: only read.
    Hdr,
}

impl FileFormat {
    /// Returns the format for a file name, or `None`. Case does not matter.
    pub fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "exr" => Some(Self::Exr),
            "png" => Some(Self::Png),
            "pfm" => Some(Self::Pfm),
            "hdr" => Some(Self::Hdr),
            _ => None,
        }
    }

    /// Returns true if the values are display light (tone-mapped), false if they are radiance.
    pub fn is_display_referred(self) -> bool {
        self == Self::Png
    }
}

impl Image {
    /// Reads an EXR (the first layer that has R, G and B; alpha is 1 if there is none), PNG (decoded from
    /// sRGB to linear), PFM or HDR file.
    ///
    /// # Errors
    /// Fails for names with another ending, for files that cannot be opened, and for content of another
    /// format.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, ImageError> {
        let path = path.as_ref();
        match FileFormat::of(path) {
            Some(FileFormat::Exr) => read_exr(path),
            Some(FileFormat::Png) => {
                let mut image = decode(path, image::ImageFormat::Png, "a PNG picture")?;
                for [r, g, b, _] in image.pixels_mut() {
                    [*r, *g, *b] = [*r, *g, *b].map(linear_from_srgb);
                }
                Ok(image)
            }
            Some(FileFormat::Hdr) => decode(path, image::ImageFormat::Hdr, "a Radiance HDR picture"),
            Some(FileFormat::Pfm) => pfm::read(&read_bytes(path)?)
                .map_err(|found| malformed(path, "a portable float map (PF or Pf)", found)),
            None => Err(ImageError::UnknownFormat {
                path: path.into(),
                verb: "read",
                expected: ".exr, .png, .pfm or .hdr",
            }),
        }
    }

    /// Writes an EXR, PNG or PFM file. An existing file is replaced only once the new file is complete on
    /// disk.
    ///
    /// EXR and PFM store the linear values unchanged. PNG stores 8-bit sRGB after applying `display`, with
    /// NaN and infinite pixels in pure magenta. `provenance` (JSON, any UTF-8 text) is stored in EXR and PNG;
    /// PFM has no place for it. Alpha is written only if it is not 1 everywhere, and never to PFM.
    ///
    /// # Errors
    /// Fails for names with another ending, if the folder is missing or not writable, and if the disk is
    /// full.
    pub fn write(
        &self,
        path: impl AsRef<Path>,
        display: Display,
        provenance: Option<&str>,
    ) -> Result<(), ImageError> {
        let path = path.as_ref();
        match FileFormat::of(path) {
            Some(FileFormat::Exr) => replace(path, |out| write_exr(self, out, path, provenance)),
            Some(FileFormat::Png) => replace(path, |out| {
                write_png(self, out, display, provenance)
                    .map_err(|error| ImageError::Encode { path: path.into(), reason: error.to_string() })
            }),
            Some(FileFormat::Pfm) => {
                replace(path, |out| pfm::write(self, out).map_err(io(path, "cannot write the picture")))
            }
            Some(FileFormat::Hdr) | None => Err(ImageError::UnknownFormat {
                path: path.into(),
                verb: "write",
                expected: ".exr, .png or .pfm",
            }),
        }
    }

    /// Returns the bytes of a PNG file, as [`Image::write`] writes it.
    ///
    /// # Errors
    /// [`ImageError::Encode`] if the picture is too large for the format.
    pub fn png(&self, display: Display) -> Result<Vec<u8>, ImageError> {
        let mut file = Vec::new();
        write_png(self, &mut file, display, None)
            .map_err(|error| ImageError::Encode { path: "PNG".into(), reason: error.to_string() })?;
        Ok(file)
    }

    /// Returns the pixels as 8-bit sRGB after applying `display`; NaN and infinite pixels are pure magenta.
    pub fn srgb8(&self, display: Display) -> impl Iterator<Item = [u8; 3]> {
        self.pixels().iter().map(move |&rgba| {
            let [r, g, b, _] = rgba;
            if is_finite(rgba) {
                display.map([r, g, b]).map(|channel| byte(srgb_from_linear(channel)))
            } else {
                [255, 0, 255]
            }
        })
    }
}

/// Returns the provenance that [`Image::write`] stored in an EXR or PNG file; `None` if the file has none, as
/// is always the case for PFM and HDR files.
///
/// # Errors
/// Those of [`Image::read`].
pub fn read_provenance(path: impl AsRef<Path>) -> Result<Option<String>, ImageError> {
    let path = path.as_ref();
    match FileFormat::of(path) {
        Some(FileFormat::Exr) => {
            let meta = exr_meta(path, &read_bytes(path)?)?;
            // An attribute that is not part of the format counts as an attribute of the layer.
            let attributes = meta.headers.iter().map(|header| &header.own_attributes.other);
            let mut values = attributes.flat_map(|other| other.get(PROVENANCE_KEY.as_bytes()));
            match values.next() {
                Some(exr::AttributeValue::Text(text)) => {
                    let text = String::from_utf8(text.as_slice().to_vec());
                    text.map(Some).map_err(|e| malformed(path, "provenance in UTF-8", e.to_string()))
                }
                _ => Ok(None),
            }
        }
        Some(FileFormat::Png) => {
            let bytes = read_bytes(path)?;
            let read = || {
                let reader = png::Decoder::new(Cursor::new(&bytes)).read_info()?;
                let mut chunks = reader.info().utf8_text.iter();
                let chunk = chunks.find(|chunk| chunk.keyword == PROVENANCE_KEY).cloned();
                chunk
                    .map(|mut chunk| {
                        chunk.decompress_text_with_limit(MAX_PROVENANCE)?;
                        chunk.get_text()
                    })
                    .transpose()
            };
            let found = guarded(|| read().map_err(|error: png::DecodingError| error.to_string()));
            found.map_err(|found| malformed(path, "a PNG picture", found))
        }
        Some(FileFormat::Pfm | FileFormat::Hdr) => Ok(None),
        None => Err(ImageError::UnknownFormat {
            path: path.into(),
            verb: "read",
            expected: ".exr, .png, .pfm or .hdr",
        }),
    }
}

/// Returns the attributes of an EXR file that are texts or numbers, by name: what the program that wrote it says of it. Files of
/// other formats have none.
///
/// # Errors
/// Those of [`Image::read`].
pub fn read_attributes(path: impl AsRef<Path>) -> Result<BTreeMap<String, String>, ImageError> {
    let path = path.as_ref();
    if FileFormat::of(path) != Some(FileFormat::Exr) {
        return Ok(BTreeMap::new());
    }
    let meta = exr_meta(path, &read_bytes(path)?)?;
    let mut found = BTreeMap::new();
    for header in &meta.headers {
        let software =
            header.own_attributes.software_name.iter().map(|text| ("software".to_owned(), text.to_string()));
        let comments =
            header.own_attributes.comments.iter().map(|text| ("comments".to_owned(), text.to_string()));
        let others = header.own_attributes.other.iter().filter_map(|(name, value)| {
            let text = match value {
                exr::AttributeValue::Text(text) => text.to_string(),
                exr::AttributeValue::F32(number) => number.to_string(),
                exr::AttributeValue::F64(number) => number.to_string(),
                exr::AttributeValue::I32(number) => number.to_string(),
                _ => return None,
            };
            Some((name.to_string(), text))
        });
        found.extend(software.chain(comments).chain(others));
    }
    Ok(found)
}

fn write_exr(
    image: &Image,
    out: &mut BufWriter<&File>,
    path: &Path,
    provenance: Option<&str>,
) -> Result<(), ImageError> {
    let has_alpha = has_alpha(image);
    let names = ["R", "G", "B", "A"].into_iter().enumerate().take(if has_alpha { 4 } else { 3 });
    let channels = names.map(|(index, name)| {
        let samples = image.pixels().iter().map(|rgba| rgba[index]).collect();
        exr::AnyChannel::new(name, exr::FlatSamples::F32(samples))
    });
    let layer = exr::Layer::new(
        (image.width(), image.height()),
        exr::LayerAttributes::default(),
        exr::Encoding::SMALL_LOSSLESS,
        exr::AnyChannels::sort(channels.collect()),
    );
    let mut file = exr::Image::from_layer(layer);
    if let Some(provenance) = provenance {
        let value = exr::AttributeValue::Text(exr::Text::from_slice_unchecked(provenance.as_bytes()));
        file.attributes.other.insert(exr::Text::from(PROVENANCE_KEY), value);
    }
    exr::WritableImage::write(&file)
        .to_buffered(out)
        .map_err(|e| ImageError::Encode { path: path.into(), reason: e.to_string() })
}

fn write_png(
    image: &Image,
    out: impl Write,
    display: Display,
    provenance: Option<&str>,
) -> Result<(), png::EncodingError> {
    let has_alpha = has_alpha(image);
    let mut bytes = Vec::with_capacity(image.pixels().len() * 4);
    for (rgb, [.., alpha]) in image.srgb8(display).zip(image.pixels()) {
        bytes.extend(rgb);
        bytes.extend(has_alpha.then(|| byte(*alpha)));
    }
    let mut encoder = png::Encoder::new(out, image.width() as u32, image.height() as u32);
    encoder.set_color(if has_alpha { png::ColorType::Rgba } else { png::ColorType::Rgb });
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    if let Some(provenance) = provenance {
        encoder.add_itxt_chunk(PROVENANCE_KEY.into(), provenance.into())?;
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&bytes)?;
    writer.finish()
}

fn byte(value: f32) -> u8 {
    (value * 255.0).round() as u8
}

/// Calls `write` with a temporary file in the folder of `path`, then renames that to `path`.
fn replace(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&File>) -> Result<(), ImageError>,
) -> Result<(), ImageError> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        return Err(ImageError::NoFolder { path: path.into(), folder: folder.into() });
    }
    let part = Unfinished::of(path).map_err(io(path, "cannot begin the picture"))?;
    let mut out = BufWriter::with_capacity(1 << 16, part.file());
    write(&mut out)?;
    out.flush().map_err(io(path, "cannot write the picture"))?;
    drop(out);
    part.finish().map_err(io(path, "cannot put the finished picture in its place"))?;
    Ok(())
}

fn read_exr(path: &Path) -> Result<Image, ImageError> {
    let bytes = read_bytes(path)?;
    let meta = exr_meta(path, &bytes)?;
    for header in &meta.headers {
        let (width, height) = (header.layer_size.0 as u64, header.layer_size.1 as u64);
        decode::check_size(width, height, bytes.len() as u64)
            .map_err(|found| malformed(path, "an EXR picture", found))?;
    }
    let file = guarded(|| {
        use exr::{ReadChannels as _, ReadLayers as _};
        let layers = exr::read()
            .no_deep_data()
            .largest_resolution_level()
            .rgba_channels(
                |size: exr::Vec2<usize>, _: &exr::RgbaChannels| (size.0, vec![[0.0_f32; 4]; size.0 * size.1]),
                |(width, pixels): &mut (usize, Vec<[f32; 4]>), at, (r, g, b, a): (f32, f32, f32, f32)| {
                    pixels[at.1 * *width + at.0] = [r, g, b, a];
                },
            )
            .first_valid_layer()
            .all_attributes();
        // On this thread: a panic on those of the decoder's own pool would end the program.
        layers.non_parallel().from_buffered(Cursor::new(&bytes)).map_err(|error| error.to_string())
    })
    .map_err(|found| malformed(path, "an EXR picture with the channels R, G and B", found))?;
    let size = file.layer_data.size;
    Image::new(size.0, size.1, file.layer_data.channel_data.pixels.1)
        .map_err(|e| malformed(path, "an EXR picture", e.to_string()))
}

fn exr_meta(path: &Path, bytes: &[u8]) -> Result<::exr::meta::MetaData, ImageError> {
    guarded(|| ::exr::meta::MetaData::read_from_buffered(bytes, false).map_err(|error| error.to_string()))
        .map_err(|found| malformed(path, "an EXR picture", found))
}

fn decode(path: &Path, format: image::ImageFormat, expected: &'static str) -> Result<Image, ImageError> {
    let decoded = decode::picture(&read_bytes(path)?, Some(format))
        .map_err(|found| malformed(path, expected, found))?
        .into_rgba32f();
    let (width, height) = (decoded.width() as usize, decoded.height() as usize);
    let pixels = decoded.pixels().map(|pixel| pixel.0).collect();
    Image::new(width, height, pixels).map_err(|e| malformed(path, expected, e.to_string()))
}

fn has_alpha(image: &Image) -> bool {
    image.pixels().iter().any(|rgba| rgba[3] != 1.0)
}

fn read_bytes(path: &Path) -> Result<Vec<u8>, ImageError> {
    decode::read_file(path).map_err(io(path, "cannot open"))
}

fn io(path: &Path, action: &'static str) -> impl Fn(std::io::Error) -> ImageError {
    move |source| ImageError::Io { path: path.into(), action, source }
}

fn malformed(path: &Path, expected: &'static str, found: String) -> ImageError {
    ImageError::Malformed { path: path.into(), expected, found }
}
