//! Which approximation owes the error of each pixel.

use crate::estimate::{Pictures, References, Weights};
use crate::game::{Game, Subset};
use crate::player::{Player, frames};
use metrics::Image;

/// Pixels on each side of a pixel whose errors are taken together: single pixels are noise.
const REACH: usize = 2;

/// The error of each pixel, and who owes most of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// Size \[px\].
    pub size: (usize, usize),
    /// Of each pixel the player whose share of the error around it is greatest; `None` where most of it stays when all are
    /// exact.
    pub owner: Vec<Option<usize>>,
    /// Of each pixel the root of the relative squared error around it.
    pub error: Vec<f32>,
}

/// Squared errors of the pixels of a subset, summed over RGB: bias² and variance.
pub(crate) struct Errors {
    bias_squared: Vec<f64>,
    variance: Vec<f64>,
}

impl Errors {
    pub(crate) fn new(pictures: &Pictures, references: &References, weights: &Weights) -> Errors {
        let reference = weights.scaled(references.mean());
        let scaled: Vec<Image> = pictures.images.iter().map(|image| weights.scaled(image)).collect();
        let count = scaled.len() as f64;
        let (mut bias_squared, mut variance) = (Vec::new(), Vec::new());
        for (pixel, expected) in reference.pixels().iter().enumerate() {
            let (mut of_mean, mut spread) = (0.0, 0.0);
            for (channel, expected) in expected[..3].iter().enumerate() {
                let values = || scaled.iter().map(|image| f64::from(image.pixels()[pixel][channel]));
                let mean = values().sum::<f64>() / count;
                let own = values().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0);
                of_mean += (mean - f64::from(*expected)).powi(2) - own / count;
                spread += own;
            }
            let finite = |value: f64| if value.is_finite() { value } else { 0.0 };
            bias_squared.push(finite(of_mean));
            variance.push(finite(spread));
        }
        let size = (reference.width(), reference.height());
        Errors { bias_squared: around(&bias_squared, size), variance: around(&variance, size) }
    }
}

impl Map {
    /// Shares out the error of each pixel. `cell` returns the index of a subset in `cells`.
    pub fn new(
        game: &Game,
        players: &[Player],
        size: (usize, usize),
        cells: &[(&Pictures, &References)],
        weights: &Weights,
        cell: &dyn Fn(Subset) -> usize,
    ) -> Map {
        let errors: Vec<Errors> =
            cells.iter().map(|(pictures, references)| Errors::new(pictures, references, weights)).collect();
        let all: Subset = (1 << players.len()) - 1;
        let (mut owner, mut error) = (Vec::new(), Vec::new());
        for pixel in 0..size.0 * size.1 {
            let value = |subset: Subset| {
                let of = &errors[cell(subset)];
                of.bias_squared[pixel] + of.variance[pixel] / frames(players, subset)
            };
            let shares = game.shares(&value);
            let greatest = shares.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
            let owes = greatest.filter(|(_, share)| **share > value(all));
            owner.push(owes.map(|(player, _)| player));
            error.push((value(0).max(0.0) / 3.0).sqrt() as f32);
        }
        Map { size, owner, error }
    }
}

/// Means over the window around each pixel.
fn around(values: &[f64], (width, height): (usize, usize)) -> Vec<f64> {
    let mut means = Vec::with_capacity(values.len());
    for y in 0..height {
        for x in 0..width {
            let rows = y.saturating_sub(REACH)..(y + REACH + 1).min(height);
            let columns = x.saturating_sub(REACH)..(x + REACH + 1).min(width);
            let count = (rows.len() * columns.len()) as f64;
            let sum: f64 =
                rows.flat_map(|y| &values[y * width + columns.start..y * width + columns.end]).sum();
            means.push(sum / count);
        }
    }
    means
}
