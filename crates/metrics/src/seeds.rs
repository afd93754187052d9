//! Estimates bias and variance separately, from pictures of several seeds.

use serde::Serialize;

use crate::image::is_finite;
use crate::{Image, ImageError};

/// The error of an estimator, decomposed: mse = bias² + variance, each a mean over pixels and RGB (squared
/// radiance).
///
/// With K pictures I of independent seeds, their mean M and the reference R, at each pixel and channel:
///
/// * variance = Σ (I − M)² / (K − 1),
/// * bias² = (M − R)² − variance / K, since the mean of K pictures still contains that much noise,
/// * mse = Σ (I − R)² / K, the sum of the two.
///
/// All three are unbiased. Therefore bias² is sometimes slightly below 0 if the true bias is small; it is not
/// clamped, since that would raise averages over many estimates. Noise of the reference counts as bias: its
/// variance is added.
///
/// bias² and variance have one value for all pictures. Their intervals come from leaving out one picture at a
/// time (jackknife): picture i gives the pseudo-value K θ − (K − 1) θᵢ, where θ is the estimate and θᵢ that
/// without the picture. Both estimates are means over pairs of pictures (U-statistics), so the mean of the
/// pseudo-values is the estimate itself, and Student's interval of that mean is its interval. Pictures are left
/// out and not pixels, since pixels of one picture share their virtual lights and are not independent. In
/// simulations with five pictures the interval of bias² contains the truth in 95 of 100 repetitions, and in more
/// where there is no bias; that of the variance in as many if pixels are independent, but in 84 if half of the
/// noise is shared by all pixels (crates/metrics/tests).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Decomposition {
    /// Number K of pictures.
    pub seeds: usize,
    /// Mean squared error of one picture.
    pub mse: f64,
    /// The squared error that remains in the mean of any number of seeds; may be slightly negative.
    pub bias_squared: f64,
    /// The variance between seeds.
    pub variance: f64,
    /// √(variance / K) (radiance): the noise, as root mean square over pixels and RGB, that remains in the
    /// mean of the K pictures.
    pub standard_error: f64,
    /// A pseudo-value of bias² and variance for each picture, in their order. Of two pictures none can be left
    /// out: both have the estimate itself.
    pub by_seed: Vec<PseudoValues>,
    /// Pixels left out: NaN or infinite in the reference or in any picture.
    pub non_finite: usize,
}

/// The contribution of one picture to the estimates (squared radiance). Their means are the estimates.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PseudoValues {
    /// The pseudo-value of bias².
    pub bias_squared: f64,
    /// The pseudo-value of the variance; may be negative, unlike the estimate.
    pub variance: f64,
}

impl Decomposition {
    /// Decomposes the error of pictures that differ only in their seeds. O(pictures · pixels).
    ///
    /// # Errors
    /// [`ImageError::TooFew`] for fewer than two pictures; [`ImageError::SizesDiffer`];
    /// [`ImageError::NoFinitePixels`] where each pixel is broken in some picture.
    pub fn of(pictures: &[Image], reference: &Image) -> Result<Self, ImageError> {
        if pictures.len() < 2 {
            return Err(ImageError::TooFew { what: "pictures", expected: 2, found: pictures.len() });
        }
        for picture in pictures {
            picture.expect_size_of(reference, "a picture", "the reference")?;
        }
        // With errors e = I − R and their sum S over the seeds, the means of e² and of e·S for each seed
        // suffice.
        let mut squares = vec![0.0; pictures.len()];
        let mut products = vec![0.0; pictures.len()];
        let mut non_finite = 0;
        for (pixel, &expected) in reference.pixels().iter().enumerate() {
            let values = || pictures.iter().map(|picture| picture.pixels()[pixel]);
            if !(is_finite(expected) && values().all(is_finite)) {
                non_finite += 1;
                continue;
            }
            for channel in 0..3 {
                let errors =
                    || values().map(|value| f64::from(value[channel]) - f64::from(expected[channel]));
                let sum: f64 = errors().sum();
                for ((square, product), error) in squares.iter_mut().zip(&mut products).zip(errors()) {
                    *square += error * error;
                    *product += error * sum;
                }
            }
        }
        let pixels = reference.pixels().len();
        if non_finite == pixels {
            return Err(ImageError::NoFinitePixels { pixels });
        }
        let terms = 3.0 * (pixels - non_finite) as f64;
        for value in squares.iter_mut().chain(&mut products) {
            *value /= terms;
        }

        let k = pictures.len() as f64;
        let (all_squares, all_products): (f64, f64) = (squares.iter().sum(), products.iter().sum());
        // The mean of the products of errors of two different seeds, which does not contain noise.
        let bias_squared = (all_products - all_squares) / (k * (k - 1.0));
        let mse = all_squares / k;
        // It is not below 0, except for rounding.
        let variance = (mse - bias_squared).max(0.0);
        let pseudo_values = |(square, product): (&f64, &f64)| {
            if pictures.len() == 2 {
                return PseudoValues { bias_squared, variance };
            }
            // Of the sum over ordered pairs, those with this picture; without it, (K − 1)(K − 2) pairs remain.
            let without = (all_products - all_squares - 2.0 * (product - square)) / (k - 2.0);
            let bias_squared = k * bias_squared - without;
            PseudoValues { bias_squared, variance: square - bias_squared }
        };
        let by_seed = squares.iter().zip(&products).map(pseudo_values).collect();
        Ok(Self {
            seeds: pictures.len(),
            mse,
            bias_squared,
            variance,
            standard_error: (variance / k).sqrt(),
            by_seed,
            non_finite,
        })
    }
}

/// Returns the mean of each channel of each pixel, alpha included; NaN or infinite if one of the images is.
///
/// # Errors
/// [`ImageError::TooFew`] for no images; [`ImageError::SizesDiffer`].
pub fn mean_image(images: &[Image]) -> Result<Image, ImageError> {
    let Some(first) = images.first() else {
        return Err(ImageError::TooFew { what: "images", expected: 1, found: 0 });
    };
    for image in images {
        image.expect_size_of(first, "an image", "the first image")?;
    }
    let mut mean = first.clone();
    for (pixel, out) in mean.pixels_mut().iter_mut().enumerate() {
        *out = std::array::from_fn(|channel| {
            let sum: f64 = images.iter().map(|image| f64::from(image.pixels()[pixel][channel])).sum();
            (sum / images.len() as f64) as f32
        });
    }
    Ok(mean)
}
