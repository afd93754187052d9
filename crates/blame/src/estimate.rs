//! The error of a subset of exact approximations, from pictures of several seeds.

use crate::shares::Cell;
use metrics::seeds::{Decomposition, mean_image};
use metrics::{Image, ImageError};

/// ε of the relative squared error, as a share of the squared mean of the reference: that of the measure relMSE.
const EPSILON: f64 = 1e-2;

/// Two references of independent noise, by which the noise of their mean is known.
#[derive(Clone, Debug)]
pub struct References {
    mean: Image,
    /// The squared standard error of `mean`, relative as the error is, as a mean over pixels and RGB.
    noise: f64,
    /// Mean over pixels and RGB.
    energy: f64,
}

/// The pictures of a subset, one for each seed.
#[derive(Clone, Debug, Default)]
pub struct Pictures {
    /// The pictures.
    pub images: Vec<Image>,
    /// GPU time of each \[ms\]; empty where it is not known.
    pub ms: Vec<f64>,
}

/// The square roots of the weights of squared errors, for each pixel and channel.
#[derive(Clone, Debug)]
pub struct Weights(Image);

impl References {
    /// Takes two pictures of different seeds; errors are relative to `weights`.
    ///
    /// # Errors
    /// Pictures of different sizes.
    pub fn new(halves: [Image; 2], weights: &Weights) -> Result<References, ImageError> {
        let mean = mean_image(&halves)?;
        let [a, b] = halves.each_ref().map(|half| weights.scaled(half));
        let squares = values(&a).zip(values(&b)).map(|(a, b)| (a - b).powi(2) / 4.0);
        let noise = mean_of(squares);
        let energy = mean_of(values(&mean));
        Ok(References { mean, noise, energy })
    }

    /// Returns their mean.
    pub fn mean(&self) -> &Image {
        &self.mean
    }
}

impl Weights {
    /// Returns the weights of errors that are relative to a reference: 1/(R² + ε).
    pub fn relative_to(reference: &Image) -> Weights {
        let mean = mean_of(values(reference));
        let epsilon = (EPSILON * mean * mean).max(f64::MIN_POSITIVE);
        let mut weights = reference.clone();
        for pixel in weights.pixels_mut() {
            *pixel = pixel.map(|value| (1.0 / (f64::from(value).powi(2) + epsilon).sqrt()) as f32);
        }
        Weights(weights)
    }

    /// Returns a picture whose squared error is the relative one.
    pub(crate) fn scaled(&self, image: &Image) -> Image {
        let mut scaled = image.clone();
        for (pixel, weights) in scaled.pixels_mut().iter_mut().zip(self.0.pixels()) {
            *pixel = std::array::from_fn(|channel| pixel[channel] * weights[channel]);
        }
        scaled
    }
}

impl Pictures {
    /// Returns what they cost and how wrong they are.
    ///
    /// # Errors
    /// Pictures of different sizes, fewer than two, and those without a finite pixel.
    pub fn cell(&self, references: &References, weights: &Weights) -> Result<Cell, ImageError> {
        let scaled: Vec<Image> = self.images.iter().map(|image| weights.scaled(image)).collect();
        let found = Decomposition::of(&scaled, &weights.scaled(&references.mean))?;
        let bias = found.by_seed.iter().map(|seed| seed.bias_squared - references.noise);
        Ok(Cell {
            bias_squared: bias.collect(),
            variance: found.by_seed.iter().map(|seed| seed.variance).collect(),
            energy: self.images.iter().map(|image| mean_of(values(image)) / references.energy).collect(),
            ms: self.ms.clone(),
        })
    }
}

/// The RGB values of all pixels.
pub(crate) fn values(image: &Image) -> impl Iterator<Item = f64> + '_ {
    image.pixels().iter().flat_map(|pixel| pixel[..3].iter().map(|value| f64::from(*value)))
}

/// The mean of the finite values.
fn mean_of(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values
        .filter(|value| value.is_finite())
        .fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    if count > 0.0 { sum / count } else { 0.0 }
}
