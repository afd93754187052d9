//! Structural similarity: Wang et al. 2004, "Image Quality Assessment: From Error Visibility to
//! Structural Similarity".

use rayon::prelude::*;

use crate::image::{is_finite, luminance};
use crate::{Display, Pair, srgb_from_linear};

/// Width of the window and standard deviation of its Gaussian (pixels) (§III-C).
const WINDOW: usize = 11;
const SIGMA: f64 = 1.5;
/// C₁ and C₂: (K₁ L)² and (K₂ L)² with a range L of 1 (§III-C).
const C1: f64 = 0.01 * 0.01;
const C2: f64 = 0.03 * 0.03;

impl Pair<'_> {
    /// Returns the mean structural similarity, −1..=1, where 1 is equality (Wang et al. 2004, Eq. 13 and 17),
    /// between the two pictures after applying `display`, as sRGB-encoded luma (Rec. 709 weights, 0..=1):
    /// windows of 11×11 pixels weighted by a Gaussian of σ 1.5, K₁ = 0.01, K₂ = 0.03.
    ///
    /// Only windows that lie completely inside count, as in the authors' program: the outer 5 pixels are the
    /// centre of none. A picture with fewer than 11 pixels across or down has windows that are as wide or as
    /// high as itself. As in [`flip`](fn@crate::flip), a pixel that is NaN or infinite in either picture
    /// counts as black in both for its neighbours, and the window around it (around the pixel after the
    /// middle, if that is between two) counts as 0.
    pub fn ssim(&self, display: Display) -> f64 {
        let (image, reference) = (self.image(), self.reference());
        let (width, height) = (image.width(), image.height());
        let pixels: Vec<[f64; 2]> =
            image
                .pixels()
                .par_iter()
                .zip(reference.pixels())
                .map(|(&i, &r)| {
                    if is_finite(i) && is_finite(r) { [luma(i, display), luma(r, display)] } else { [0.0; 2] }
                })
                .collect();
        let (across, down) = (kernel(width), kernel(height));
        let (columns, rows) = (width + 1 - across.len(), height + 1 - down.len());

        // Means of x, y, x², y² and xy: filtered along the rows, then along the columns.
        let filtered: Vec<[f64; 5]> = pixels
            .par_chunks(width)
            .flat_map_iter(|row| {
                (0..columns).map(|x| {
                    weighted(&across, |tap| {
                        let [x, y] = row[x + tap];
                        [x, y, x * x, y * y, x * y]
                    })
                })
            })
            .collect();
        let sums: Vec<f64> = (0..rows)
            .into_par_iter()
            .map(|y| {
                let windows = (0..columns).map(|x| {
                    let centre = (y + down.len() / 2) * width + x + across.len() / 2;
                    let broken =
                        !(is_finite(image.pixels()[centre]) && is_finite(reference.pixels()[centre]));
                    let moments = || weighted(&down, |tap| filtered[(y + tap) * columns + x]);
                    if broken { 0.0 } else { similarity(moments()) }
                });
                windows.sum()
            })
            .collect();
        sums.into_iter().sum::<f64>() / (rows * columns) as f64
    }
}

/// Computes Eq. 13 from the window's means of x, y, x², y² and xy.
fn similarity([x, y, xx, yy, xy]: [f64; 5]) -> f64 {
    let (variance_x, variance_y, covariance) = (xx - x * x, yy - y * y, xy - x * y);
    ((2.0 * x * y + C1) * (2.0 * covariance + C2)) / ((x * x + y * y + C1) * (variance_x + variance_y + C2))
}

fn luma([r, g, b, _]: [f32; 4], display: Display) -> f64 {
    f64::from(luminance(display.map([r, g, b]).map(srgb_from_linear)))
}

/// Returns a Gaussian around the middle of `WINDOW` pixels, or of all if there are fewer, with a sum of 1.
fn kernel(length: usize) -> Vec<f64> {
    let taps = length.min(WINDOW);
    let middle = (taps - 1) as f64 * 0.5;
    let weights = (0..taps).map(|tap| (-((tap as f64 - middle) / SIGMA).powi(2) * 0.5).exp());
    let sum: f64 = weights.clone().sum();
    weights.map(|weight| weight / sum).collect()
}

fn weighted<const N: usize>(kernel: &[f64], value: impl Fn(usize) -> [f64; N]) -> [f64; N] {
    kernel.iter().enumerate().fold([0.0; N], |sum, (tap, weight)| {
        let value = value(tap);
        std::array::from_fn(|k| sum[k] + weight * value[k])
    })
}
