use serde::Serialize;

use crate::Image;

/// Number of pixels that SMC-IR §5.2 tracks in a sequence.
pub const TRACKED_PIXELS: usize = 8;

/// Error of the luminance at tracked pixels and its change with time (SMC-IR §5.2).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ErrorSeries {
    /// Mean |E| over frames and pixels (display luminance, 0..=1), where E is found − reference after tone
    /// mapping.
    pub average_error: f64,
    /// Mean |E′| (1/s), where E′ = ΔE / Δt (Eq. 10) from each frame to the next.
    pub average_change: f64,
}

impl ErrorSeries {
    /// Computes the errors of `found` with respect to `reference`: the luminance of each tracked pixel in
    /// each frame, `[frames][pixels]`, exposed radiance. `delta_t` is the time \[s\] from frame to frame.
    ///
    /// Both are mapped by the Reinhard operator without a white point, L / (1 + L), as in the paper; multiply
    /// them by 2^exposure before the call if the picture is shown at another exposure than 0. A negative
    /// luminance counts as 0.
    ///
    /// Returns `None` for fewer than two frames, no pixels, different numbers of frames or pixels, a NaN or
    /// infinite luminance, or a `delta_t` that is not above 0.
    pub fn of(found: &[Vec<f64>], reference: &[Vec<f64>], delta_t: f64) -> Option<Self> {
        let pixels = found.first()?.len();
        let pairs_up = found.len() == reference.len()
            && found.iter().chain(reference).all(|frame| frame.len() == pixels);
        let finite = found.iter().chain(reference).flatten().all(|luminance| luminance.is_finite());
        if !(pairs_up && finite && pixels > 0 && found.len() > 1 && delta_t > 0.0) {
            return None;
        }
        let errors: Vec<Vec<f64>> = found
            .iter()
            .zip(reference)
            .map(|(found, reference)| {
                found.iter().zip(reference).map(|(&f, &r)| reinhard(f) - reinhard(r)).collect()
            })
            .collect();
        let error: f64 = errors.iter().flatten().map(|e| e.abs()).sum();
        let change: f64 = errors
            .windows(2)
            .flat_map(|frames| frames[0].iter().zip(&frames[1]))
            .map(|(before, now)| (now - before).abs() / delta_t)
            .sum();
        Some(Self {
            average_error: error / (found.len() * pixels) as f64,
            average_change: change / ((found.len() - 1) * pixels) as f64,
        })
    }
}

/// Reinhard et al. 2002, Eq. 3.
fn reinhard(luminance: f64) -> f64 {
    let luminance = luminance.max(0.0);
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
