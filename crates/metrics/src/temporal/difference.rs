use serde::Serialize;

use super::Pinhole;
use crate::image::{is_finite, luminance};
use crate::{Image, ImageError};

/// A frame with the depth of its pixels.
#[derive(Debug, Clone, Copy)]
pub struct View<'a> {
    /// The picture.
    pub image: &'a Image,
    /// Distance along the viewing axis \[m\] in the red channel, of the picture's size; 0 where a pixel sees
    /// nothing.
    pub depth: &'a Image,
    /// The camera of the picture.
    pub camera: Pinhole,
}

/// The difference between the surfaces of two frames: the sum and the counts of [`temporal_difference`].
///
/// Every pixel of the previous frame that sees something is in one of the four counts.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct TemporalDifference {
    /// Σ (L₁ − L₀)² over the matched pixels, where L is luminance (squared units of the picture).
    pub sum_of_squares: f64,
    /// Pixels of the previous frame whose surface the current frame sees.
    pub matched: usize,
    /// Pixels whose surface is hidden by another in the current frame, or no longer in the line of sight.
    pub disoccluded: usize,
    /// Pixels whose surface left the frame.
    pub outside: usize,
    /// Pixels left out because one of the two colors is NaN or infinite.
    pub non_finite: usize,
}

impl TemporalDifference {
    /// Returns the root mean square of the differences (units of the picture); `None` if nothing matched.
    pub fn rms(&self) -> Option<f64> {
        (self.matched > 0).then(|| (self.sum_of_squares / self.matched as f64).sqrt())
    }
}

/// Compares the same surfaces in two frames (TCAS §6.2): each pixel of the previous frame is projected, by
/// the world position of its centre, to the current frame, and its luminance is compared with that of the
/// pixel it falls in, without interpolation. If the depth there differs from that of the point by more than
/// the share `tolerance`, the pixel sees another surface and is left out.
///
/// The result measures flicker if radiance does not depend on the view and nothing but the camera moves. The
/// paper says "intensities"; here they are luminances of the pictures as given, so the caller chooses
/// radiance or display light. Detail smaller than a pixel counts as difference. O(pixels), in order of the
/// pixels.
///
/// # Errors
/// [`ImageError::SizesDiffer`] if the four images do not have the same size.
pub fn temporal_difference(
    previous: &View<'_>,
    current: &View<'_>,
    tolerance: f64,
) -> Result<TemporalDifference, ImageError> {
    current.depth.expect_size_of(current.image, "the current depth", "the current picture")?;
    previous.image.expect_size_of(current.image, "the previous picture", "the current picture")?;
    previous.depth.expect_size_of(current.image, "the previous depth", "the current picture")?;
    let (width, height) = (current.image.width(), current.image.height());
    let inside = |at: f64, length: usize| (at >= 0.0 && at < length as f64).then_some(at as usize);

    let mut found = TemporalDifference::default();
    for (pixel, (&before, &[depth, ..])) in
        previous.image.pixels().iter().zip(previous.depth.pixels()).enumerate()
    {
        if !(depth > 0.0 && depth.is_finite()) {
            continue;
        }
        let centre = ((pixel % width) as f64 + 0.5, (pixel / width) as f64 + 0.5);
        let point = previous.camera.world(centre.0, centre.1, f64::from(depth), (width, height));
        let target = current.camera.project(point, (width, height));
        let target = target.and_then(|(x, y, depth)| Some((inside(x, width)?, inside(y, height)?, depth)));
        let Some((x, y, expected)) = target else {
            found.outside += 1;
            continue;
        };
        let at = y * width + x;
        let seen = f64::from(current.depth.pixels()[at][0]);
        let now = current.image.pixels()[at];
        let same_surface = seen > 0.0 && (seen - expected).abs() <= tolerance * expected;
        if !same_surface {
            found.disoccluded += 1;
        } else if !(is_finite(before) && is_finite(now)) {
            found.non_finite += 1;
        } else {
            let [before, now] = [before, now].map(|[r, g, b, _]| f64::from(luminance([r, g, b])));
            found.matched += 1;
            found.sum_of_squares += (now - before).powi(2);
        }
    }
    Ok(found)
}

/// The temporal image difference of a camera path (TCAS §6.2): the root mean square over all matched pixels
/// of all consecutive pairs of frames.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Tid {
    sum_of_squares: f64,
    matched: usize,
}

impl Tid {
    /// Adds the next pair of frames.
    pub fn add(&mut self, pair: &TemporalDifference) {
        self.sum_of_squares += pair.sum_of_squares;
        self.matched += pair.matched;
    }

    /// Returns the measure of the pairs so far (units of the picture); `None` as long as nothing matched.
    pub fn value(&self) -> Option<f64> {
        (self.matched > 0).then(|| (self.sum_of_squares / self.matched as f64).sqrt())
    }
}
