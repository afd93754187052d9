//! Difference images.

use colorous::{MAGMA, RED_BLUE};

use crate::image::luminance;
use crate::{Image, Pair, linear_from_srgb};

impl Pair<'_> {
    /// Computes I − R for each RGB channel (radiance), signed, for an EXR or PFM file. NaN where one of the
    /// two is NaN; alpha is 1.
    pub fn difference(&self) -> Image {
        self.pixelwise(|i, r| std::array::from_fn(|c| i[c] - r[c]))
    }

    /// Computes |I − R| · `gain` for each RGB channel.
    pub fn absolute_difference(&self, gain: f32) -> Image {
        self.pixelwise(|i, r| std::array::from_fn(|c| (i[c] - r[c]).abs() * gain))
    }

    /// Returns the luminance of I − R, times `gain`, as color: blue where the image is too dark (−1), white
    /// where it agrees (0), red where it is too bright (+1). The values are linear display light, to be
    /// written with [`Display::AS_IS`](crate::Display::AS_IS); NaN and infinite pixels stay NaN.
    pub fn signed_difference(&self, gain: f32) -> Image {
        self.pixelwise(|i, r| {
            let difference = luminance(i) - luminance(r);
            if difference.is_finite() {
                linear(RED_BLUE, 0.5 - 0.5 * difference * gain)
            } else {
                [f32::NAN; 3]
            }
        })
    }

    fn pixelwise(&self, rgb: impl Fn([f32; 3], [f32; 3]) -> [f32; 3]) -> Image {
        let mut out = self.image().clone();
        for (out, &reference) in out.pixels_mut().iter_mut().zip(self.reference().pixels()) {
            let ([i, j, k, _], [r, g, b, _]) = (*out, reference);
            let [x, y, z] = rgb([i, j, k], [r, g, b]);
            *out = [x, y, z, 1.0];
        }
        out
    }
}

/// Maps values 0..=1 to the magma color map (Smith and van der Walt 2015).
pub(crate) fn magma(width: usize, height: usize, values: &[f32]) -> Image {
    Image::from_fn(width, height, |x, y| {
        let [r, g, b] = linear(MAGMA, values[y * width + x]);
        [r, g, b, 1.0]
    })
    .expect("the values are those of an image")
}

/// Returns the color at `t`, clamped to 0..=1, as linear light.
fn linear(gradient: colorous::Gradient, t: f32) -> [f32; 3] {
    let colorous::Color { r, g, b } = gradient.eval_continuous(f64::from(t.clamp(0.0, 1.0)));
    [r, g, b].map(|channel| linear_from_srgb(f32::from(channel) / 255.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::is_finite;

    #[test]
    fn differences_by_hand() {
        let image = Image::new(2, 1, vec![[1.0, 0.5, 0.0, 0.5], [f32::NAN, 0.0, 0.0, 1.0]]).unwrap();
        let reference = Image::new(2, 1, vec![[0.25, 1.0, 0.0, 1.0], [0.0, 0.0, 0.0, 1.0]]).unwrap();
        let pair = Pair::new(&image, &reference).unwrap();
        assert_eq!(pair.difference().pixels()[0], [0.75, -0.5, 0.0, 1.0]);
        assert_eq!(pair.absolute_difference(2.0).pixels()[0], [1.5, 1.0, 0.0, 1.0]);
        assert!(!is_finite(pair.difference().pixels()[1]));
        assert!(!is_finite(pair.signed_difference(1.0).pixels()[1]));
    }

    #[test]
    fn too_bright_is_red_and_too_dark_is_blue() {
        let [black, white] = [0.0, 1.0].map(|v| Image::new(1, 1, vec![[v, v, v, 1.0]]).unwrap());
        let [r, _, b, _] = Pair::new(&white, &black).unwrap().signed_difference(1.0).pixels()[0];
        assert!(r > 2.0 * b, "{r} {b}");
        let [r, _, b, _] = Pair::new(&black, &white).unwrap().signed_difference(1.0).pixels()[0];
        assert!(b > 2.0 * r, "{r} {b}");
        let [r, g, b, _] = Pair::new(&white, &white).unwrap().signed_difference(1.0).pixels()[0];
        assert!((r - g).abs() < 0.05 && (g - b).abs() < 0.05 && g > 0.8, "{r} {g} {b}");
    }

    #[test]
    fn magma_has_the_published_ends() {
        let image = magma(2, 1, &[0.0, 1.0]);
        let srgb = |pixel: [f32; 4]| pixel.map(|c| (crate::srgb_from_linear(c) * 255.0).round() as u8);
        assert_eq!(srgb(image.pixels()[0])[..3], [0, 0, 4]);
        assert_eq!(srgb(image.pixels()[1])[..3], [252, 253, 191]);
    }
}
