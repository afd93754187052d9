//! A picture in linear radiance as the page stores it: the page maps it to display values itself, by the exposure that
//! its reader chooses.

use std::io::Write as _;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use half::f16;
use metrics::Image;
use serde::Serialize;

use super::encoded::reduced;

/// Half floats in planes, compressed.
///
/// For each of red, green and blue there is a plane of the high bytes and one of the low bytes of the pixels' codes.
/// All planes together are a zlib stream (RFC 1950), in base64.
#[derive(Serialize)]
pub(super) struct Linear {
    pub(super) width: usize,
    pub(super) height: usize,
    /// Whether each code is less that of the pixel on its left (modulo 2¹⁶; of the first of a row, less 0): smooth
    /// pictures are smaller so, noise is not.
    delta: bool,
    pub(super) data: String,
}

impl Linear {
    pub(super) fn new(image: &Image) -> Linear {
        let image = reduced(image);
        let [plain, by_delta] = [false, true].map(|delta| packed(&planes(&image, delta)));
        let delta = by_delta.len() < plain.len();
        let data = STANDARD.encode(if delta { by_delta } else { plain });
        Linear { width: image.width(), height: image.height(), delta, data }
    }
}

fn planes(image: &Image, delta: bool) -> Vec<u8> {
    let count = image.pixels().len();
    let mut planes = vec![0; 6 * count];
    for (channel, planes) in planes.chunks_mut(2 * count).enumerate() {
        let (high, low) = planes.split_at_mut(count);
        let mut before = 0;
        for (index, pixel) in image.pixels().iter().enumerate() {
            let left = if delta && !index.is_multiple_of(image.width()) { before } else { 0 };
            before = code(pixel[channel]);
            [high[index], low[index]] = before.wrapping_sub(left).to_be_bytes();
        }
    }
    planes
}

fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    let packed = encoder.write_all(bytes).and_then(|()| encoder.finish());
    packed.expect("memory takes what is written to it")
}

/// Returns the half float nearest to a value; finite ones stay finite, and there is one zero and one NaN.
fn code(value: f32) -> u16 {
    if value.is_nan() {
        return f16::NAN.to_bits();
    }
    let half = f16::from_f32(value);
    if value.is_finite() && !half.is_finite() {
        return f16::MAX.copysign(half).to_bits();
    }
    if half == f16::ZERO { 0 } else { half.to_bits() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_keep_what_a_half_float_can() {
        let back = |value: f32| f16::from_bits(code(value)).to_f32();
        assert_eq!([back(0.5), back(-2.0), back(1e6), back(-1e6)], [0.5, -2.0, 65504.0, -65504.0]);
        assert!(back(f32::NAN).is_nan() && back(f32::INFINITY) == f32::INFINITY);
        assert_eq!((code(-0.0), code(1e-12)), (0, 0));
        assert!((back(0.123_456) / 0.123_456 - 1.0).abs() < 5e-4);
    }

    #[test]
    fn planes_hold_codes_or_differences_to_the_left() {
        let image = Image::from_fn(2, 2, |x, y| [1.0 + x as f32, y as f32, 0.0, 1.0]).expect("pixels");
        // 1 is 0x3c00 and 2 is 0x4000.
        let green = [0, 0, 0x3c, 0x3c, 0, 0, 0, 0];
        assert_eq!(planes(&image, false), [[0x3c, 0x40, 0x3c, 0x40, 0, 0, 0, 0], green, [0; 8]].concat());
        let green = [0, 0, 0x3c, 0, 0, 0, 0, 0];
        assert_eq!(planes(&image, true), [[0x3c, 0x04, 0x3c, 0x04, 0, 0, 0, 0], green, [0; 8]].concat());
    }

    #[test]
    fn the_smaller_form_is_kept() {
        let smooth = Image::from_fn(64, 64, |x, y| [x as f32, 0.5 * y as f32, 1.0, 1.0]).expect("pixels");
        let hash = |x: usize, y: usize| ((x * 7919 + y * 104_729) * 2_654_435_761 % 1009) as f32 / 1009.0;
        let noise =
            Image::from_fn(64, 64, |x, y| [hash(x, y), hash(y, x), hash(x + y, x), 1.0]).expect("pixels");
        for image in [smooth, noise] {
            let linear = Linear::new(&image);
            let bytes = STANDARD.decode(&linear.data).expect("base64");
            let least = [false, true].map(|delta| packed(&planes(&image, delta)).len()).into_iter().min();
            assert_eq!(Some(bytes.len()), least);
            let mut found = Vec::new();
            std::io::Read::read_to_end(&mut flate2::read::ZlibDecoder::new(&bytes[..]), &mut found)
                .expect("a stream");
            assert!(found == planes(&image, linear.delta) && (linear.width, linear.height) == (64, 64));
        }
    }
}
