use serde::{Deserialize, Serialize};

use crate::ImageError;

/// Linear Rec. 709 color with alpha, row by row from the top left.
///
/// RGB is radiance [W/(m² sr)] for a rendered picture, or display light in 0..=1 for one that was
/// read from an 8-bit file. Values may be NaN or infinite; the measures count such pixels.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    width: usize,
    height: usize,
    pixels: Vec<[f32; 4]>,
}

/// Mean and counts of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Glance {
    /// Mean luminance over the pixels whose color is finite; 0 where there is none.
    pub mean: f64,
    /// Number of pixels whose color is not finite.
    pub not_finite: usize,
    /// Number of pixels whose color is finite and has a negative channel.
    pub negative: usize,
}

impl Image {
    /// Computes mean and counts over all pixels.
    pub fn glance(&self) -> Glance {
        let (mut sum, mut finite, mut negative) = (0.0, 0, 0);
        for &[r, g, b, _] in self.pixels() {
            let rgb = [r, g, b];
            if rgb.iter().all(|value| value.is_finite()) {
                sum += f64::from(luminance(rgb));
                finite += 1;
                negative += usize::from(rgb.iter().any(|value| *value < 0.0));
            }
        }
        let mean = if finite == 0 { 0.0 } else { sum / finite as f64 };
        Glance { mean, not_finite: self.pixels().len() - finite, negative }
    }

    /// Creates an image from `pixels: [height * width]` RGBA, row by row from the top left.
    ///
    /// # Errors
    /// [`ImageError::PixelCount`] if the length does not match or the image is empty.
    pub fn new(width: usize, height: usize, pixels: Vec<[f32; 4]>) -> Result<Self, ImageError> {
        let expected = width.saturating_mul(height);
        if expected == 0 || pixels.len() != expected {
            return Err(ImageError::PixelCount { width, height, expected, found: pixels.len() });
        }
        Ok(Self { width, height, pixels })
    }

    /// Creates an image, computing each pixel from its column and row.
    ///
    /// # Errors
    /// [`ImageError::PixelCount`] if the image is empty.
    pub fn from_fn(
        width: usize,
        height: usize,
        mut pixel: impl FnMut(usize, usize) -> [f32; 4],
    ) -> Result<Self, ImageError> {
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| pixel(x, y));
        Self::new(width, height, pixels.collect())
    }

    /// Returns the means over squares of `side` × `side` pixels: the picture of which this one has so many samples a pixel. Pixels that fill
    /// no square are left out.
    ///
    /// # Errors
    /// [`ImageError::PixelCount`] if there is no square, or `side` is 0.
    pub fn mean_of_squares(&self, side: usize) -> Result<Self, ImageError> {
        let of = |x: usize, y: usize| {
            let samples = (0..side * side)
                .map(|s| self.pixels[(y * side + s / side) * self.width + x * side + s % side]);
            let sum =
                samples.fold([0.0; 4], |sum: [f32; 4], pixel| std::array::from_fn(|c| sum[c] + pixel[c]));
            sum.map(|channel| channel / (side * side) as f32)
        };
        let sides = |length: usize| length.checked_div(side).unwrap_or(0);
        Self::from_fn(sides(self.width), sides(self.height), of)
    }

    /// Returns the width in pixels, at least 1.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Returns the height in pixels, at least 1.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Returns the `[height * width]` RGBA pixels.
    pub fn pixels(&self) -> &[[f32; 4]] {
        &self.pixels
    }

    /// Returns the `[height * width]` RGBA pixels, to change in place.
    pub fn pixels_mut(&mut self) -> &mut [[f32; 4]] {
        &mut self.pixels
    }

    /// Returns the `[height * width]` RGBA pixels, without a copy.
    pub fn into_pixels(self) -> Vec<[f32; 4]> {
        self.pixels
    }

    /// Checks that the image has the size of `other`.
    ///
    /// # Errors
    /// [`ImageError::SizesDiffer`], with the names of the two images.
    pub(crate) fn expect_size_of(
        &self,
        other: &Self,
        what: &'static str,
        other_name: &'static str,
    ) -> Result<(), ImageError> {
        let [found, expected] = [self, other].map(|image| (image.width, image.height));
        if found == expected {
            Ok(())
        } else {
            Err(ImageError::SizesDiffer { what, found, other: other_name, expected })
        }
    }

    /// Returns an image of the same size with every pixel's RGB replaced; alpha is kept.
    pub(crate) fn map_rgb(&self, map: impl Fn([f32; 3]) -> [f32; 3]) -> Self {
        let pixels = self.pixels.iter().map(|&[r, g, b, a]| {
            let [r, g, b] = map([r, g, b]);
            [r, g, b, a]
        });
        Self { width: self.width, height: self.height, pixels: pixels.collect() }
    }
}

/// Returns the relative luminance Y of a linear Rec. 709 color (ITU-R BT.709: 0.2126, 0.7152, 0.0722).
pub fn luminance([r, g, b]: [f32; 3]) -> f32 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

pub(crate) fn is_finite(rgba: [f32; 4]) -> bool {
    rgba[..3].iter().all(|channel| channel.is_finite())
}
