//! Pictures of cells that did not hold, as the page shows them.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use metrics::{Display, Image, Tonemap};
use serde::{Deserialize, Serialize};

/// The mean luminance that pictures are exposed to: middle grey.
const GREY: f64 = 0.18;

/// A picture in the page.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shown {
    /// A description with the exposure.
    pub about: String,
    /// The PNG file, in base64.
    pub png: String,
}

impl Shown {
    /// Encodes a picture at an exposure of its own, so that lights of 10⁻⁶ and of 10⁶ W look alike.
    pub(crate) fn new(what: &str, image: &Image) -> Option<Shown> {
        let mean = image.glance().mean;
        let exposure = if mean > 0.0 { (GREY / mean).log2() as f32 } else { 0.0 };
        let display = Display { tonemap: Tonemap::default(), exposure };
        let png = STANDARD.encode(image.png(display).ok()?);
        Some(Shown { about: format!("{what}, at {exposure:+.1} EV"), png })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_of_any_brightness_look_alike() {
        let shown = |value: f32| {
            let image = Image::from_fn(4, 2, |x, _| [value * x as f32, value, value, 1.0]).unwrap();
            Shown::new("a ramp", &image).unwrap()
        };
        let (dim, bright) = (shown(1.0 / 4096.0), shown(65536.0));
        assert!(dim.png == bright.png && !dim.png.is_empty());
        assert_ne!(dim.about, bright.about);
        let black = Image::from_fn(2, 2, |_, _| [0.0; 4]).unwrap();
        assert_eq!(Shown::new("nothing", &black).unwrap().about, "nothing, at +0.0 EV");
    }
}
