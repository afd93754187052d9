//! Turns values into colors.

use crate::action::choices;
use eframe::egui::{Color32, ColorImage};
use metrics::{Image, srgb_from_linear};

choices! {
    /// The part of a texel that is shown.
    pub(super) enum Channel {
        #[default]
        Rgb = "RGB",
        Red = "red",
        Green = "green",
        Blue = "blue",
        Alpha = "alpha",
        Luminance = "luminance",
    }
}

choices! {
    /// The colors of one number.
    pub(super) enum Palette {
        #[default]
        Plain = "plain",
        Turbo = "turbo",
        Viridis = "viridis",
        Signed = "signed",
    }
}

impl Channel {
    /// The one number of a texel; of RGB the luminance.
    pub(super) fn of(self, pixel: [f32; 4]) -> f32 {
        match self {
            Channel::Red => pixel[0],
            Channel::Green => pixel[1],
            Channel::Blue => pixel[2],
            Channel::Alpha => pixel[3],
            Channel::Rgb | Channel::Luminance => metrics::luminance([pixel[0], pixel[1], pixel[2]]),
        }
    }
}

/// The coloring of a texture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Coloring {
    pub(super) channel: Channel,
    pub(super) palette: Palette,
    /// Values are multiplied by 2 to the power of this.
    pub(super) exposure: f32,
    /// Whether the range of values is fitted to that of colors instead.
    pub(super) auto: bool,
}

/// The least and the greatest finite value; zeros where there is none.
pub(super) fn range(image: &Image, channel: Channel) -> (f32, f32) {
    let values = image.pixels().iter().map(|pixel| channel.of(*pixel)).filter(|value| value.is_finite());
    let (least, greatest) = values
        .fold((f32::INFINITY, f32::NEG_INFINITY), |(least, greatest), v| (least.min(v), greatest.max(v)));
    if least > greatest { (0.0, 0.0) } else { (least, greatest) }
}

impl Coloring {
    /// Returns the picture for a screen. What is not finite is magenta.
    pub(super) fn apply(&self, image: &Image) -> ColorImage {
        let (offset, scale) = if self.auto {
            let (least, greatest) = range(image, self.channel);
            (least, if greatest > least { 1.0 / (greatest - least) } else { 1.0 })
        } else {
            (0.0, self.exposure.exp2())
        };
        let map = |value: f32| (value - offset) * scale;
        let pixels = image.pixels().iter().map(|pixel| self.pixel(*pixel, map));
        ColorImage::new([image.width(), image.height()], pixels.collect())
    }

    fn pixel(&self, pixel: [f32; 4], map: impl Fn(f32) -> f32) -> Color32 {
        const NOT_FINITE: Color32 = Color32::from_rgb(255, 0, 255);
        let byte = |value: f32| (srgb_from_linear(value.clamp(0.0, 1.0)) * 255.0).round() as u8;
        if self.channel == Channel::Rgb && self.palette == Palette::Plain {
            if !pixel[..3].iter().all(|value| value.is_finite()) {
                return NOT_FINITE;
            }
            return Color32::from_rgb(byte(map(pixel[0])), byte(map(pixel[1])), byte(map(pixel[2])));
        }
        let value = self.channel.of(pixel);
        if !value.is_finite() {
            return NOT_FINITE;
        }
        let value = map(value);
        let gradient = match self.palette {
            Palette::Plain => return Color32::from_gray(byte(value)),
            Palette::Turbo => colorous::TURBO,
            Palette::Viridis => colorous::VIRIDIS,
            // Without a fitted range 0 is in the middle.
            Palette::Signed if self.auto => colorous::RED_BLUE,
            Palette::Signed => {
                let color = colorous::RED_BLUE.eval_continuous(f64::from(0.5 - value * 0.5).clamp(0.0, 1.0));
                return Color32::from_rgb(color.r, color.g, color.b);
            }
        };
        let color = gradient.eval_continuous(f64::from(value).clamp(0.0, 1.0));
        Color32::from_rgb(color.r, color.g, color.b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture() -> Image {
        Image::new(3, 1, vec![[0.0, 0.0, 0.0, 1.0], [4.0, 4.0, 4.0, 0.5], [f32::NAN, 0.0, 0.0, 0.0]]).unwrap()
    }

    #[test]
    fn a_fitted_range_reaches_from_black_to_white_and_nan_stands_out() {
        let coloring = Coloring { auto: true, ..Coloring::default() };
        let shown = coloring.apply(&picture());
        assert_eq!(shown.pixels, [Color32::BLACK, Color32::WHITE, Color32::from_rgb(255, 0, 255)]);
    }

    #[test]
    fn exposure_doubles_values_and_a_channel_is_grey() {
        let of =
            |exposure: f32, channel| Coloring { exposure, channel, ..Coloring::default() }.apply(&picture());
        assert_eq!(of(-2.0, Channel::Rgb).pixels[1], Color32::WHITE);
        assert_eq!(of(-3.0, Channel::Red).pixels[1], Color32::from_gray(188));
        assert_eq!(of(0.0, Channel::Alpha).pixels[0], Color32::WHITE);
    }
}
