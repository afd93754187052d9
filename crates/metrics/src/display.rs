//! Maps linear radiance to display values.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::Image;
use crate::image::luminance;

/// An exposure, followed by a tone-mapping operator.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Display {
    /// The operator that maps exposed radiance to display light.
    pub tonemap: Tonemap,
    /// Exposure value (EV): radiance is multiplied by 2^exposure first; +1 doubles it.
    pub exposure: f32,
}

/// Maps exposed radiance 0..∞ to linear display light 0..=1: the curves of `shaders/tonemap.wgsl`, by the same names.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Tonemap {
    /// Reinhard et al. 2002, the global operator, on luminance: L′ = L (1 + L/w²) / (1 + L) (Eq. 4);
    /// without a white point w = ∞, so L′ = L / (1 + L) (Eq. 3). RGB is scaled by L′/L.
    Reinhard {
        /// The smallest luminance w that maps to white (exposed radiance), above 0.
        white: Option<f32>,
    },
    /// Narkowicz 2015, "ACES Filmic Tone Mapping Curve": x (2.51 x + 0.03) / (x (2.43 x + 0.59) + 0.14)
    /// for each channel.
    Aces,
    /// Hable 2010 (Uncharted 2), for each channel, scaled so that `white` becomes 1.
    Filmic {
        /// The exposed radiance that maps to white, above 0.
        white: f32,
    },
    /// Only clamps to 0..=1.
    Clamp,
}

/// The white point where none is given: that of the pass type `composite`.
const WHITE: f32 = 4.0;

/// The curve by which measures look at pictures: it depends on no white point.
impl Default for Tonemap {
    fn default() -> Self {
        Self::Reinhard { white: None }
    }
}

impl Tonemap {
    /// Returns the curve that a pass names in its setting `tonemap`, with its setting `white`.
    pub fn of_settings(name: &str, white: f32) -> Option<Tonemap> {
        match name {
            "reinhard" => Some(Self::Reinhard { white: Some(white) }),
            "reinhard-simple" => Some(Self::Reinhard { white: None }),
            "aces" => Some(Self::Aces),
            "filmic" => Some(Self::Filmic { white }),
            "none" | "clamp" => Some(Self::Clamp),
            _ => None,
        }
    }

    /// Returns the name of the curve in the setting `tonemap` of a pass, and the white point where it has one.
    pub fn to_settings(self) -> (&'static str, Option<f32>) {
        match self {
            Self::Reinhard { white: None } => ("reinhard-simple", None),
            Self::Reinhard { white } => ("reinhard", white),
            Self::Aces => ("aces", None),
            Self::Filmic { white } => ("filmic", Some(white)),
            Self::Clamp => ("none", None),
        }
    }
}

impl Display {
    /// Keeps display light as it is: for pictures that are tone-mapped already.
    pub const AS_IS: Self = Self { tonemap: Tonemap::Clamp, exposure: 0.0 };

    /// Returns how an output of a pipeline becomes a picture: the output `display` is display light already, others are
    /// shown as `linear` says.
    pub fn of_output(output: &str, linear: Display) -> Display {
        if output == "display" { Display::AS_IS } else { linear }
    }

    /// Returns the linear display light in 0..=1 of a linear radiance. If any channel is NaN or infinite, all
    /// channels are NaN, so that the caller decides how to show such a pixel.
    pub fn map(&self, rgb: [f32; 3]) -> [f32; 3] {
        if !rgb.iter().all(|channel| channel.is_finite()) {
            return [f32::NAN; 3];
        }
        let scale = self.exposure.exp2();
        // An exposed value beyond the range of f32 is white, instead of infinity divided by infinity.
        let exposed = rgb.map(|channel| (channel * scale).clamp(0.0, f32::MAX.sqrt() * 0.1));
        let mapped = match self.tonemap {
            Tonemap::Clamp => exposed,
            Tonemap::Reinhard { white } => {
                let l = luminance(exposed);
                let gain = (1.0 + white.map_or(0.0, |w| l / (w * w))) / (1.0 + l);
                exposed.map(|channel| channel * gain)
            }
            Tonemap::Aces => exposed.map(|x| x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)),
            Tonemap::Filmic { white } => exposed.map(|x| hable(x) / hable(white)),
        };
        mapped.map(|channel| channel.clamp(0.0, 1.0))
    }

    /// Applies [`Display::map`] to every pixel; alpha is kept.
    pub fn apply(&self, image: &Image) -> Image {
        image.map_rgb(|rgb| self.map(rgb))
    }
}

fn hable(x: f32) -> f32 {
    (x * (0.15 * x + 0.05) + 0.004) / (x * (0.15 * x + 0.5) + 0.06) - 0.02 / 0.3
}

/// Formats a curve as [`FromStr`] reads it: its name, and after a colon its white point.
impl fmt::Display for Tonemap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.to_settings() {
            (name, Some(white)) => write!(f, "{name}:{white}"),
            (name, None) => write!(f, "{name}"),
        }
    }
}

impl FromStr for Tonemap {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, white) = match text.split_once(':') {
            Some((name, white)) => (name, Some(white)),
            None => (text, None),
        };
        let expected = "expected `reinhard`, `reinhard:WHITE`, `reinhard-simple`, `aces`, `filmic`, `filmic:WHITE` or `none`";
        let refused = || format!("{expected}, not `{text}`");
        let tonemap = Self::of_settings(name, WHITE).ok_or_else(refused)?;
        let Some(white) = white else { return Ok(tonemap) };
        if tonemap.to_settings().1.is_none() {
            return Err(refused());
        }
        match white.parse() {
            Ok(white) if white > 0.0 && f32::is_finite(white) => {
                Self::of_settings(name, white).ok_or_else(refused)
            }
            _ => Err(format!("the white point of `{name}:WHITE` is a number above 0, not `{white}`")),
        }
    }
}

/// Returns the sRGB transfer function (IEC 61966-2-1): linear light 0..=1 to the encoded value 0..=1.
pub fn srgb_from_linear(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Returns the inverse of [`srgb_from_linear`].
pub fn linear_from_srgb(encoded: f32) -> f32 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reinhard_halves_luminance_one_and_keeps_hue() {
        let display = Display::default();
        assert_eq!(display.map([1.0; 3]), [0.5; 3]);
        // L = 0.2126·2 = 0.4252, so red becomes 2 / 1.4252 and is clamped to 1; green stays 0.
        assert_eq!(display.map([2.0, 0.0, 0.0]), [1.0, 0.0, 0.0]);
        // +2 EV: L = 4, L′ = 4/5.
        let [r, ..] = Display { exposure: 2.0, ..display }.map([1.0; 3]);
        assert!((r - 0.8).abs() < 1e-6, "{r}");
    }

    #[test]
    fn the_white_point_maps_to_one() {
        let display = Display { tonemap: Tonemap::Reinhard { white: Some(4.0) }, exposure: 0.0 };
        let [r, ..] = display.map([4.0; 3]);
        assert!((r - 1.0).abs() < 1e-6, "{r}");
        // 1·(1 + 1/16)/2
        let [r, ..] = display.map([1.0; 3]);
        assert!((r - 0.531_25).abs() < 1e-6, "{r}");
    }

    #[test]
    fn aces_follows_its_formula() {
        let display = Display { tonemap: Tonemap::Aces, exposure: 0.0 };
        // (2.51 + 0.03) / (2.43 + 0.59 + 0.14)
        let [r, ..] = display.map([1.0; 3]);
        assert!((r - 2.54 / 3.16).abs() < 1e-6, "{r}");
        assert_eq!(display.map([1e9; 3]), [1.0; 3]);
    }

    #[test]
    fn extremes_stay_in_range() {
        for tonemap in [Tonemap::default(), Tonemap::Clamp, Tonemap::Aces, "reinhard:0.5".parse().unwrap()] {
            for exposure in [-40.0, 0.0, 40.0] {
                for value in [0.0, -1.0, 1e-30, 1.0, f32::MAX] {
                    let mapped = Display { tonemap, exposure }.map([value, 0.0, value]);
                    assert!(
                        mapped.iter().all(|c| (0.0..=1.0).contains(c)),
                        "{tonemap} {exposure} {value}: {mapped:?}"
                    );
                }
            }
            assert!(Display { tonemap, exposure: 0.0 }.map([f32::NAN, 0.0, 0.0]).iter().all(|c| c.is_nan()));
        }
    }

    #[test]
    fn srgb_round_trip_and_known_value() {
        // IEC 61966-2-1: 0.5 linear is 187.5/255 encoded.
        assert!((srgb_from_linear(0.5) - 0.735_357).abs() < 1e-5);
        for step in 0..=255_u8 {
            let encoded = f32::from(step) / 255.0;
            assert!((srgb_from_linear(linear_from_srgb(encoded)) - encoded).abs() < 1e-6);
        }
    }

    #[test]
    fn operators_parse_as_they_print() {
        for text in ["reinhard-simple", "reinhard:2.5", "none", "aces", "filmic:11.2"] {
            assert_eq!(text.parse::<Tonemap>().unwrap().to_string(), text);
        }
        for (text, known) in [("reinhard", "reinhard:4"), ("filmic", "filmic:4"), ("clamp", "none")] {
            assert_eq!(text.parse::<Tonemap>().unwrap().to_string(), known);
        }
        for text in ["", "hable", "reinhard:", "reinhard:0", "reinhard:inf", "aces:2", "reinhard-simple:2"] {
            assert!(text.parse::<Tonemap>().is_err(), "{text}");
        }
    }
}
