//! Pictures of 8 bits: PNG files, and what the page stores of them.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use metrics::{Display, Image, Pair, luminance};
use serde::Serialize;

/// Longest side of a picture in the page [px]; larger ones are averaged down.
const MOST_SIDE: usize = 1024;
/// Share of the reference's pixels that the exposure maps below white.
const BELOW_WHITE: f64 = 0.99;

/// A PNG file.
#[derive(Serialize)]
pub(super) struct Encoded {
    width: usize,
    height: usize,
    /// Base64.
    pub(super) data: String,
}

impl Encoded {
    /// Encodes a picture of display values.
    pub(super) fn new(image: &Image) -> Encoded {
        let image = reduced(image);
        let data = STANDARD.encode(image.png(Display::AS_IS).unwrap_or_default());
        Encoded { width: image.width(), height: image.height(), data }
    }
}

/// Returns the colors of differences of luminance from −1 to +1: 256 of RGB, 8 bits each, in base64.
pub(super) fn diverging() -> String {
    let grey = |value: f32| [value, value, value, 1.0];
    let image = Image::from_fn(256, 1, |x, _| grey(x as f32 / 127.5 - 1.0));
    let zero = Image::from_fn(256, 1, |_, _| grey(0.0));
    let (image, zero) = image.ok().zip(zero.ok()).expect("both have pixels");
    let pair = Pair::new(&image, &zero).expect("both have one size");
    let colors: Vec<u8> = pair.signed_difference(1.0).srgb8(Display::AS_IS).flatten().collect();
    STANDARD.encode(colors)
}

/// Returns the luminance that [`BELOW_WHITE`] of the pixels do not exceed; the greatest luminance if that is
/// not above 0, and 1 for a black picture.
pub(super) fn white(image: &Image) -> f32 {
    let of = |&[r, g, b, _]: &[f32; 4]| luminance([r, g, b]);
    let mut values: Vec<f32> = image.pixels().iter().map(of).filter(|l| l.is_finite()).collect();
    values.sort_by(f32::total_cmp);
    let rank = (BELOW_WHITE * values.len() as f64).ceil() as usize;
    let candidates = [values.get(rank.saturating_sub(1)), values.last()];
    candidates.into_iter().flatten().copied().find(|value| *value > 0.0).unwrap_or(1.0)
}

/// Returns the side of the blocks of pixels that are averaged.
pub(super) fn step(image: &Image) -> usize {
    image.width().max(image.height()).div_ceil(MOST_SIDE)
}

/// Reduces a picture to at most [`MOST_SIDE`] pixels in width and height, by means over blocks. A block with
/// a pixel that is NaN or infinite is NaN.
pub(super) fn reduced(image: &Image) -> Image {
    let step = step(image);
    if step == 1 {
        return image.clone();
    }
    let (width, height) = (image.width(), image.height());
    let block = |x: usize, y: usize| {
        let (columns, rows) =
            (x * step..(x * step + step).min(width), y * step..(y * step + step).min(height));
        let count = (columns.len() * rows.len()) as f32;
        let mut sum = [0.0; 4];
        for row in rows {
            for pixel in &image.pixels()[row * width + columns.start..row * width + columns.end] {
                sum = std::array::from_fn(|channel| sum[channel] + pixel[channel] / count);
            }
        }
        sum
    };
    Image::from_fn(width.div_ceil(step), height.div_ceil(step), block)
        .expect("a picture has at least a pixel")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_is_the_99th_percentile() {
        let grey = |value: f32| [value, value, value, 1.0];
        let ramp = Image::from_fn(100, 1, |x, _| grey(x as f32 + 1.0)).expect("pixels");
        assert!((white(&ramp) - 99.0).abs() < 1e-3);
        let mut broken = ramp.clone();
        broken.pixels_mut()[99] = grey(f32::INFINITY);
        assert!((white(&broken) - 99.0).abs() < 1e-3);
        let spark = Image::from_fn(1000, 1, |x, _| grey(if x == 0 { 5.0 } else { 0.0 })).expect("pixels");
        assert!((white(&spark) - 5.0).abs() < 1e-3, "the greatest where the percentile is black");
        assert_eq!(white(&Image::from_fn(2, 2, |_, _| grey(0.0)).expect("pixels")), 1.0);
    }

    #[test]
    fn large_pictures_are_averaged() {
        let wide = Image::from_fn(2050, 2, |x, _| [x as f32, 0.0, 0.0, 1.0]).expect("pixels");
        let small = reduced(&wide);
        assert_eq!((small.width(), small.height()), (684, 1));
        assert!((small.pixels()[0][0] - 1.0).abs() < 1e-5, "mean of 0, 1 and 2");
        // The last block holds the single column 2049.
        assert!((small.pixels()[683][0] - 2049.0).abs() < 1e-2);
        let tiny = Image::from_fn(1, 1, |_, _| [0.5; 4]).expect("pixels");
        assert_eq!(reduced(&tiny), tiny);
    }
}
