use serde::Serialize;

use crate::image::{is_finite, luminance};
use crate::{Image, ImageError};

/// The deviation of each pixel from frame to frame, of a scene in which nothing moves.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StaticDeviation {
    /// Standard deviation of each pixel's luminance (units of the frames), grey; NaN if a frame is NaN or
    /// infinite there. Alpha is 1.
    #[serde(skip)]
    pub map: Image,
    /// Mean of the map (units of the frames).
    pub mean: f64,
    /// The mean of the map divided by the mean luminance of all frames (1); `None` if that is 0.
    pub normalised: Option<f64>,
    /// Pixels left out of the means: NaN or infinite in any frame.
    pub non_finite: usize,
}

/// Computes the standard deviation over `frames` (denominator n − 1) of the luminance of each pixel. It
/// measures flicker if camera, scene and lights do not move. O(frames · pixels).
///
/// # Errors
/// [`ImageError::TooFew`] for fewer than two frames; [`ImageError::SizesDiffer`];
/// [`ImageError::NoFinitePixels`] if each pixel is NaN or infinite in some frame.
pub fn static_deviation(frames: &[Image]) -> Result<StaticDeviation, ImageError> {
    let Some(first) = frames.first().filter(|_| frames.len() > 1) else {
        return Err(ImageError::TooFew { what: "frames", expected: 2, found: frames.len() });
    };
    for frame in frames {
        frame.expect_size_of(first, "a frame", "the first frame")?;
    }
    let n = frames.len() as f64;
    let mut map = first.clone();
    let (mut deviations, mut luminances, mut non_finite) = (0.0, 0.0, 0);
    for (pixel, out) in map.pixels_mut().iter_mut().enumerate() {
        let values = || frames.iter().map(|frame| frame.pixels()[pixel]);
        if !values().all(is_finite) {
            *out = [f32::NAN, f32::NAN, f32::NAN, 1.0];
            non_finite += 1;
            continue;
        }
        let values = || values().map(|[r, g, b, _]| f64::from(luminance([r, g, b])));
        let mean = values().sum::<f64>() / n;
        let variance = values().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0);
        let deviation = variance.sqrt();
        *out = [deviation as f32, deviation as f32, deviation as f32, 1.0];
        deviations += deviation;
        luminances += mean;
    }
    let pixels = first.pixels().len();
    if non_finite == pixels {
        return Err(ImageError::NoFinitePixels { pixels });
    }
    Ok(StaticDeviation {
        map,
        mean: deviations / (pixels - non_finite) as f64,
        normalised: (luminances != 0.0).then(|| deviations / luminances),
        non_finite,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(values: &[f32]) -> Image {
        Image::new(values.len(), 1, values.iter().map(|&v| [v, v, v, 1.0]).collect()).unwrap()
    }

    #[test]
    fn by_hand() {
        // 1 2 3 has the mean 2 and the deviation √((1 + 0 + 1) / 2) = 1; 4 4 4 has 4 and 0.
        let frames = [[1.0, 4.0, 0.0], [2.0, 4.0, f32::NAN], [3.0, 4.0, 0.0]].map(|frame| grey(&frame));
        let found = static_deviation(&frames).unwrap();
        let reds: Vec<f32> = found.map.pixels().iter().map(|pixel| pixel[0]).collect();
        assert!((reds[0] - 1.0).abs() < 1e-6 && reds[1] == 0.0 && reds[2].is_nan(), "{reds:?}");
        assert!((found.mean - 0.5).abs() < 1e-6, "{}", found.mean);
        assert!((found.normalised.unwrap() - 1.0 / 6.0).abs() < 1e-6, "{:?}", found.normalised);
        assert_eq!(found.non_finite, 1);
    }

    #[test]
    fn what_cannot_be_measured_is_told() {
        let one = [grey(&[1.0])];
        let error = static_deviation(&one).unwrap_err().to_string();
        assert!(error.contains("at least 2 frames") && error.contains("got 1"), "{error}");
        assert!(matches!(static_deviation(&[]), Err(ImageError::TooFew { found: 0, .. })));
        let error = static_deviation(&[grey(&[1.0]), grey(&[1.0, 2.0])]).unwrap_err().to_string();
        assert!(error.contains("2x1") && error.contains("1x1"), "{error}");
        let broken = [grey(&[1.0]), grey(&[f32::INFINITY])];
        assert!(matches!(static_deviation(&broken), Err(ImageError::NoFinitePixels { pixels: 1 })));
        assert_eq!(static_deviation(&[grey(&[0.0]), grey(&[0.0])]).unwrap().normalised, None);
    }
}
