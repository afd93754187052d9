use crate::Image;

/// Number of pixels that SMC-IR §5.2 tracks in a sequence.
pub const TRACKED_PIXELS: usize = 8;

/// Error of luminance and its change with time at the same pixels of each frame (SMC-IR §5.2), frame by frame.
///
/// E is found − reference after tone mapping (display luminance, −1..=1), by the Reinhard operator without a white
/// point, L / (1 + L), as in the paper; multiply luminances by 2^exposure before if the picture is shown at
/// another exposure than 0. A negative luminance counts as 0.
#[derive(Debug, Clone, Default)]
pub struct ErrorSeries {
    /// E of each pixel in the last frame.
    last: Vec<f64>,
    frames: usize,
    /// Sums over the frames of the means over pixels, of |E| and of |ΔE|.
    errors: f64,
    changes: f64,
}

/// The errors of one frame of an [`ErrorSeries`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameError {
    /// Mean |E| over pixels (display luminance, 0..=1).
    pub error: f64,
    /// Mean |ΔE| over pixels, from the frame before; `None` for the first.
    pub change: Option<f64>,
}

impl ErrorSeries {
    /// Adds the next frame: the luminance of each pixel (exposed radiance), found and in the reference. O(pixels).
    ///
    /// Errors are NaN if a luminance is NaN or infinite, there are no pixels, or not as many as in the frame
    /// before.
    pub fn add(&mut self, pixels: impl IntoIterator<Item = (f64, f64)>) -> FrameError {
        let now: Vec<f64> =
            pixels.into_iter().map(|(found, reference)| reinhard(found) - reinhard(reference)).collect();
        let mean = |sum: f64| sum / now.len() as f64;
        let error = mean(now.iter().map(|e| e.abs()).sum());
        let change = (self.frames > 0).then(|| {
            let pairs_up = self.last.len() == now.len();
            let sum: f64 = now.iter().zip(&self.last).map(|(now, before)| (now - before).abs()).sum();
            if pairs_up { mean(sum) } else { f64::NAN }
        });
        self.frames += 1;
        self.errors += error;
        self.changes += change.unwrap_or(0.0);
        self.last = now;
        FrameError { error, change }
    }

    /// Returns the mean |E| over frames and pixels (display luminance, 0..=1); `None` without a frame, or where it
    /// is NaN.
    pub fn average_error(&self) -> Option<f64> {
        Some(self.errors / self.frames as f64).filter(|error| error.is_finite())
    }

    /// Returns the mean |E′| (1/s) over frames and pixels, where E′ = ΔE / Δt (Eq. 10) from each frame to the next,
    /// `delta_t` \[s\] apart; `None` for fewer than two frames, where it is NaN, or if `delta_t` is not above 0.
    pub fn average_change(&self, delta_t: f64) -> Option<f64> {
        let pairs = self.frames.checked_sub(1)?;
        let change = self.changes / pairs as f64 / delta_t;
        Some(change).filter(|change| change.is_finite() && delta_t > 0.0)
    }
}

/// Reinhard et al. 2002, Eq. 3.
fn reinhard(luminance: f64) -> f64 {
    // NaN stays NaN, where `max` would make it 0; and infinity becomes NaN.
    let luminance = if luminance < 0.0 { 0.0 } else { luminance };
    luminance / (1.0 + luminance)
}

/// Returns columns and rows of `count` pixels that are distributed over the visible surfaces: over the pixels
/// whose `depth` (red channel) is above 0. Returns all of these if there are fewer.
///
/// These pixels are sorted along a Hilbert curve and divided into `count` parts of equal number; the middle
/// one of each part is taken. So the choice depends only on `depth`, and each tracked pixel represents a
/// patch of the same area. O(pixels log pixels).
pub fn tracked_pixels(depth: &Image, count: usize) -> Vec<(usize, usize)> {
    let side = depth.width().max(depth.height()).next_power_of_two();
    let mut seen: Vec<(usize, usize)> = (0..depth.height())
        .flat_map(|y| (0..depth.width()).map(move |x| (x, y)))
        .filter(|&(x, y)| {
            let depth = depth.pixels()[y * depth.width() + x][0];
            depth > 0.0 && depth.is_finite()
        })
        .collect();
    seen.sort_by_cached_key(|&(x, y)| along_hilbert_curve(x, y, side));
    let count = count.min(seen.len());
    (0..count).map(|part| seen[(2 * part + 1) * seen.len() / (2 * count)]).collect()
}

/// Returns the position of a cell along the Hilbert curve through a square of `side` cells, a power of two.
fn along_hilbert_curve(mut x: usize, mut y: usize, side: usize) -> usize {
    let mut position = 0;
    let mut half = side / 2;
    while half > 0 {
        let (right, below) = (x & half != 0, y & half != 0);
        position += half * half * ((3 * usize::from(right)) ^ usize::from(below));
        // Each quadrant contains the curve again: the first transposed, the last transposed along the other
        // diagonal.
        if !below {
            if right {
                (x, y) = (side - 1 - x, side - 1 - y);
            }
            (x, y) = (y, x);
        }
        half /= 2;
    }
    position
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_goes_from_neighbour_to_neighbour_through_every_cell() {
        let mut cells = vec![None; 64];
        for (x, y) in (0..8).flat_map(|y| (0..8).map(move |x| (x, y))) {
            assert_eq!(cells[along_hilbert_curve(x, y, 8)].replace((x, y)), None);
        }
        let steps = cells.windows(2).map(|pair| pair[0].zip(pair[1]).unwrap());
        assert!(
            steps.into_iter().all(|((x, y), (u, v)): ((usize, usize), _)| x.abs_diff(u) + y.abs_diff(v) == 1)
        );
    }
}
