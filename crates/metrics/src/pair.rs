use rayon::prelude::*;
use serde::Serialize;

use crate::image::is_finite;
use crate::{Image, ImageError};

/// The share of pixels that [`Pair::trimmed_rel_mse`] leaves out by default: 0.1 %, as in papers on path
/// guiding, since a few fireflies would otherwise dominate the value.
pub const DEFAULT_TRIM: f64 = 1e-3;

/// The ε of [`Pair::rel_mse`], which bounds the weight of dark pixels.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Epsilon {
    /// ε = k · (mean of the reference over pixels and RGB)². The measure then stays the same when
    /// image and reference are scaled together, at any light intensity.
    Relative(f64),
    /// ε itself (squared radiance), as most papers state it (10⁻² to 10⁻⁴, for pictures exposed
    /// near 1).
    Absolute(f64),
}

impl Default for Epsilon {
    /// Returns a relative ε of 10⁻².
    fn default() -> Self {
        Self::Relative(1e-2)
    }
}

/// An image and the reference it is compared with: of the same size, and with at least one pixel that is
/// finite in both.
///
/// A pixel with a NaN or infinite red, green or blue in either image is left out of the numeric measures;
/// [`Pair::non_finite`] returns how many there are. Alpha is never compared.
#[derive(Debug, Clone, Copy)]
pub struct Pair<'a> {
    image: &'a Image,
    reference: &'a Image,
    non_finite: NonFinite,
}

/// Pixels with a NaN or infinite channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct NonFinite {
    /// Number of such pixels in the image.
    pub image: usize,
    /// Number of such pixels in the reference.
    pub reference: usize,
    /// Pixels left out of the numeric measures: NaN or infinite in either image.
    pub excluded: usize,
}

impl<'a> Pair<'a> {
    /// Pairs an image with its reference. O(pixels).
    ///
    /// # Errors
    /// [`ImageError::SizesDiffer`]; [`ImageError::NoFinitePixels`] if no pixel is finite in both.
    pub fn new(image: &'a Image, reference: &'a Image) -> Result<Self, ImageError> {
        image.expect_size_of(reference, "the image", "the reference")?;
        let mut non_finite = NonFinite { image: 0, reference: 0, excluded: 0 };
        for (&i, &r) in image.pixels().iter().zip(reference.pixels()) {
            let broken = [!is_finite(i), !is_finite(r)];
            non_finite.image += usize::from(broken[0]);
            non_finite.reference += usize::from(broken[1]);
            non_finite.excluded += usize::from(broken[0] || broken[1]);
        }
        if non_finite.excluded == image.pixels().len() {
            return Err(ImageError::NoFinitePixels { pixels: non_finite.excluded });
        }
        Ok(Self { image, reference, non_finite })
    }

    /// Returns the image that is compared.
    pub fn image(&self) -> &'a Image {
        self.image
    }

    /// Returns the reference.
    pub fn reference(&self) -> &'a Image {
        self.reference
    }

    /// Returns how many pixels are NaN or infinite.
    pub fn non_finite(&self) -> NonFinite {
        self.non_finite
    }

    /// Returns the mean squared error (squared radiance): mean over pixels and RGB of (I − R)².
    pub fn mse(&self) -> f64 {
        self.mean_over_channels(|i, r| (i - r).powi(2))
    }

    /// Returns the root mean squared error (radiance): √[`mse`](Self::mse).
    pub fn rmse(&self) -> f64 {
        self.mse().sqrt()
    }

    /// Returns the RMSE over the mean of the reference, over pixels and RGB (1); `None` where that mean is 0.
    pub fn normalised_rmse(&self) -> Option<f64> {
        ratio(self.rmse(), self.mean_over_channels(|_, r| r))
    }

    /// Returns the relative mean squared error (1): mean over pixels and RGB of (I − R)² / (R² + ε), after Rousselle et
    /// al. 2011, "Adaptive Sampling and Reconstruction using Greedy Error Minimization", who take an absolute ε of
    /// 10⁻². `None` where ε is 0, as a relative one is by a black reference.
    ///
    /// The value depends strongly on ε if the picture has dark parts: state ε with the value.
    pub fn rel_mse(&self, epsilon: Epsilon) -> Option<f64> {
        let epsilon = self.squared_radiance(epsilon)?;
        Some(self.mean_over_channels(|i, r| (i - r).powi(2) / (r * r + epsilon)))
    }

    /// Returns [`rel_mse`](Self::rel_mse) without the worst pixels: the relative squared error of each pixel
    /// is its mean over RGB, and the share `trim` (0..=1, rounded down to whole pixels) of the pixels with
    /// the greatest errors is left out of the mean over pixels. `None` as for `rel_mse`, and if no pixel is
    /// left.
    ///
    /// It hides fireflies: state it together with the untrimmed value. [`DEFAULT_TRIM`] leaves nothing out of
    /// a picture of fewer than 1000 pixels. O(pixels log pixels).
    pub fn trimmed_rel_mse(&self, epsilon: Epsilon, trim: f64) -> Option<f64> {
        let epsilon = self.squared_radiance(epsilon)?;
        let term = |i: f64, r: f64| (i - r).powi(2) / (r * r + epsilon);
        let mut errors: Vec<f64> = self
            .finite()
            .map(|(i, r)| [0, 1, 2].map(|c| term(i[c], r[c])).iter().sum::<f64>() / 3.0)
            .collect();
        errors.sort_unstable_by(f64::total_cmp);
        // Slightly more, so that a share that is whole in decimals is not rounded down by one pixel.
        let left_out = (trim.clamp(0.0, 1.0) * errors.len() as f64 + 1e-6) as usize;
        let kept = &errors[..errors.len() - left_out];
        (!kept.is_empty()).then(|| kept.iter().sum::<f64>() / kept.len() as f64)
    }

    /// Returns the mean absolute relative error (1; 100 times it is a percentage): mean over pixels and RGB of |I − R|
    /// / (|R| + √ε). ε is the squared radiance of [`rel_mse`](Self::rel_mse), so both measures stop being relative at
    /// the same radiance √ε; a relative ε of 10⁻² is 0.1 of the reference's mean here. `None` where ε is 0.
    pub fn mape(&self, epsilon: Epsilon) -> Option<f64> {
        let knee = self.squared_radiance(epsilon)?.sqrt();
        Some(self.mean_over_channels(|i, r| (i - r).abs() / (r.abs() + knee)))
    }

    /// Returns the largest |I − R| over pixels and RGB (radiance); 0 only for identical pictures.
    pub fn max_abs_difference(&self) -> f64 {
        self.finite().flat_map(|(i, r)| [0, 1, 2].map(|c| (i[c] - r[c]).abs())).fold(0.0, f64::max)
    }

    /// Returns the mean of each RGB channel of the image and of the reference (radiance), over the same pixels.
    pub fn means(&self) -> [[f64; 3]; 2] {
        let n = (self.image.pixels().len() - self.non_finite.excluded) as f64;
        let [a, b, c, d, e, f] = self.sum(|i, r| [i[0], i[1], i[2], r[0], r[1], r[2]]).map(|sum| sum / n);
        [[a, b, c], [d, e, f]]
    }

    /// Returns the mean energy of the image over that of the reference, over all RGB (1): 1 where no energy is lost or
    /// gained; `None` where the reference's is 0.
    pub fn energy_ratio(&self) -> Option<f64> {
        ratio(self.mean_over_channels(|i, _| i), self.mean_over_channels(|_, r| r))
    }

    /// Returns the energy that the image has too much and too little, over that of the reference (1): the sum of I − R where it is
    /// above 0, and of R − I where that is; the [energy ratio](Self::energy_ratio) is 1 + the first − the second. Against the same
    /// lights seen by rays, these are the light of what maps falsely hold lit, and of what they falsely hold hidden, as far as
    /// they do not cancel within a pixel. `None` where the reference's energy is 0.
    pub fn excess_and_missing(&self) -> Option<[f64; 2]> {
        let [excess, missing, whole] = self.sum(|i, r| {
            let sum = |term: fn(f64, f64) -> f64| (0..3).map(|c| term(i[c], r[c])).sum();
            [sum(|i, r| (i - r).max(0.0)), sum(|i, r| (r - i).max(0.0)), sum(|_, r| r)]
        });
        Some([ratio(excess, whole)?, ratio(missing, whole)?])
    }

    /// Returns ε as squared radiance, if it is above 0.
    fn squared_radiance(&self, epsilon: Epsilon) -> Option<f64> {
        let epsilon = match epsilon {
            Epsilon::Relative(share) => share * self.mean_over_channels(|_, r| r).powi(2),
            Epsilon::Absolute(epsilon) => epsilon,
        };
        (epsilon > 0.0).then_some(epsilon)
    }

    fn mean_over_channels(&self, term: impl Fn(f64, f64) -> f64 + Sync) -> f64 {
        let n = 3 * (self.image.pixels().len() - self.non_finite.excluded);
        let [sum] = self.sum(|i, r| [term(i[0], r[0]) + term(i[1], r[1]) + term(i[2], r[2])]);
        sum / n as f64
    }

    fn finite(&self) -> impl Iterator<Item = ([f64; 3], [f64; 3])> {
        finite_pixels(self.image.pixels(), self.reference.pixels())
    }

    /// Sums over the finite pixels: each row on some thread, then over the rows in order.
    fn sum<const N: usize>(&self, term: impl Fn([f64; 3], [f64; 3]) -> [f64; N] + Sync) -> [f64; N] {
        let width = self.image.width();
        let rows = self.image.pixels().par_chunks(width).zip(self.reference.pixels().par_chunks(width));
        let rows: Vec<[f64; N]> = rows
            .map(|(image, reference)| {
                finite_pixels(image, reference).fold([0.0; N], |sum, (i, r)| add(sum, term(i, r)))
            })
            .collect();
        rows.into_iter().fold([0.0; N], add)
    }
}

fn finite_pixels<'p>(
    image: &'p [[f32; 4]],
    reference: &'p [[f32; 4]],
) -> impl Iterator<Item = ([f64; 3], [f64; 3])> + 'p {
    let rgb = |[r, g, b, _]: [f32; 4]| [r, g, b].map(f64::from);
    let pairs = image.iter().zip(reference).filter(|&(&i, &r)| is_finite(i) && is_finite(r));
    pairs.map(move |(&i, &r)| (rgb(i), rgb(r)))
}

fn add<const N: usize>(a: [f64; N], b: [f64; N]) -> [f64; N] {
    std::array::from_fn(|k| a[k] + b[k])
}

fn ratio(over: f64, under: f64) -> Option<f64> {
    (under != 0.0).then(|| over / under)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(pixels: &[[f32; 3]]) -> Image {
        Image::new(pixels.len(), 1, pixels.iter().map(|&[r, g, b]| [r, g, b, 1.0]).collect()).unwrap()
    }

    fn close(a: f64, b: f64) {
        assert!((a - b).abs() < 1e-12, "{a} is not {b}");
    }

    #[test]
    fn by_hand() {
        let i = image(&[[1.0, 2.0, 3.0], [0.0, 0.5, 1.0]]);
        let r = image(&[[1.0, 1.0, 1.0], [2.0, 0.5, 0.0]]);
        let pair = Pair::new(&i, &r).unwrap();
        // Differences 0 1 2 −2 0 1, squares 0 1 4 4 0 1, sum 10 over 6.
        close(pair.mse(), 10.0 / 6.0);
        close(pair.rmse(), (10.0_f64 / 6.0).sqrt());
        // The reference's sum is 5.5.
        close(pair.normalised_rmse().unwrap(), (10.0_f64 / 6.0).sqrt() / (5.5 / 6.0));
        // ε = 1/2: 1/1.5 + 4/1.5 + 4/4.5 + 1/0.5
        let rel_mse = (5.0 / 1.5 + 4.0 / 4.5 + 2.0) / 6.0;
        close(pair.rel_mse(Epsilon::Absolute(0.5)).unwrap(), rel_mse);
        // The reference's mean is 5.5/6.
        let share = 0.5 / (5.5_f64 / 6.0).powi(2);
        close(pair.rel_mse(Epsilon::Relative(share)).unwrap(), rel_mse);
        // √ε = 1/2: 0 + 1/1.5 + 2/1.5 in the first pixel, 2/2.5 + 0 + 1/0.5 in the second.
        close(pair.mape(Epsilon::Absolute(0.25)).unwrap(), (2.0 + 0.8 + 2.0) / 6.0);
        close(pair.max_abs_difference(), 2.0);
        assert_eq!(pair.means(), [[0.5, 1.25, 2.0], [1.5, 0.75, 0.5]]);
        close(pair.energy_ratio().unwrap(), 7.5 / 5.5);
        let [excess, missing] = pair.excess_and_missing().unwrap();
        close(excess, 4.0 / 5.5);
        close(missing, 2.0 / 5.5);
    }

    #[test]
    fn trimming_leaves_the_worst_pixels_out() {
        // Against black with ε = 1 the errors of the pixels are 1/3, 16 and 4, and one is NaN.
        let i = image(&[[1.0, 0.0, 0.0], [4.0; 3], [2.0; 3], [f32::NAN; 3]]);
        let r = image(&[[0.0; 3]; 4]);
        let pair = Pair::new(&i, &r).unwrap();
        let trimmed = |trim| pair.trimmed_rel_mse(Epsilon::Absolute(1.0), trim);
        close(trimmed(0.0).unwrap(), pair.rel_mse(Epsilon::Absolute(1.0)).unwrap());
        close(trimmed(0.33).unwrap(), (1.0 / 3.0 + 16.0 + 4.0) / 3.0);
        close(trimmed(1.0 / 3.0).unwrap(), (1.0 / 3.0 + 4.0) / 2.0);
        close(trimmed(0.67).unwrap(), 1.0 / 3.0);
        assert_eq!(trimmed(1.0), None);
        assert_eq!(pair.trimmed_rel_mse(Epsilon::default(), 0.0), None, "the reference is black");
        // Whole shares are whole: 29 of 100 pixels, though 0.29 · 100 is 28.999999999999996, and 1 of 1000.
        for (bad, all, share) in [(29, 100, 0.29), (1, 1000, DEFAULT_TRIM)] {
            let i = image(&[vec![[9.0; 3]; bad], vec![[1.0; 3]; all - bad]].concat());
            let r = image(&vec![[1.0; 3]; all]);
            let trimmed = Pair::new(&i, &r).unwrap().trimmed_rel_mse(Epsilon::Absolute(1.0), share);
            assert_eq!(trimmed, Some(0.0), "{share}");
        }
    }

    #[test]
    fn broken_pixels_are_counted_and_left_out() {
        let i = image(&[[f32::NAN, 0.0, 0.0], [2.0, 2.0, 2.0], [0.0, f32::INFINITY, 0.0]]);
        let r = image(&[[1.0, 1.0, 1.0], [1.0, 1.0, 1.0], [0.0, 0.0, f32::NEG_INFINITY]]);
        let pair = Pair::new(&i, &r).unwrap();
        assert_eq!(pair.non_finite(), NonFinite { image: 2, reference: 1, excluded: 2 });
        close(pair.rmse(), 1.0);
        assert_eq!(pair.means(), [[2.0; 3], [1.0; 3]]);
        close(pair.max_abs_difference(), 1.0);
        let broken = image(&[[f32::NAN; 3]; 3]);
        assert!(matches!(Pair::new(&i, &broken), Err(ImageError::NoFinitePixels { pixels: 3 })));
    }

    #[test]
    fn sizes_that_differ_are_both_named() {
        let error = Pair::new(&image(&[[0.0; 3]; 2]), &image(&[[0.0; 3]; 3])).unwrap_err();
        let text = error.to_string();
        assert!(text.contains("2x1") && text.contains("3x1"), "{text}");
    }

    #[test]
    fn a_black_reference_has_no_ratio() {
        let pair = (image(&[[1.0; 3]]), image(&[[0.0; 3]]));
        let pair = Pair::new(&pair.0, &pair.1).unwrap();
        assert_eq!(pair.normalised_rmse(), None);
        assert_eq!(pair.energy_ratio(), None);
        assert_eq!(pair.excess_and_missing(), None);
        assert_eq!(pair.rel_mse(Epsilon::default()), None);
        assert_eq!(pair.mape(Epsilon::default()), None);
        close(pair.rel_mse(Epsilon::Absolute(1e-2)).unwrap(), 100.0);
    }

    #[test]
    fn relative_measures_do_not_depend_on_the_light() {
        let (i, r) = (image(&[[1.0, 2.0, 3.0], [0.0, 0.5, 1.0]]), image(&[[1.0; 3], [2.0, 0.5, 0.0]]));
        let [bright_i, bright_r] = [&i, &r].map(|image| image.map_rgb(|rgb| rgb.map(|c| c * 1024.0)));
        let (pair, bright) = (Pair::new(&i, &r).unwrap(), Pair::new(&bright_i, &bright_r).unwrap());
        let epsilon = Epsilon::default();
        close(pair.rel_mse(epsilon).unwrap(), bright.rel_mse(epsilon).unwrap());
        close(pair.mape(epsilon).unwrap(), bright.mape(epsilon).unwrap());
        close(pair.normalised_rmse().unwrap(), bright.normalised_rmse().unwrap());
        close(pair.energy_ratio().unwrap(), bright.energy_ratio().unwrap());
    }

    #[test]
    fn a_small_term_beside_a_large_one_survives() {
        // In f32 the second pixel would vanish beside the first: 10^8 + 1 = 10^8.
        let pair = (image(&[[1e4; 3], [1.0; 3]]), image(&[[0.0; 3]; 2]));
        close(Pair::new(&pair.0, &pair.1).unwrap().mse() * 2.0, 1e8 + 1.0);
    }
}
