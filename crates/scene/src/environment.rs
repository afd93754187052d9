//! Light from infinitely far, as radiance over all directions.

use std::f64::consts::PI;
use std::path::Path;

use metrics::{FileFormat, Image};
use serde::Serialize;

use crate::emitters::cumulative;
use crate::light::BRIGHTEST;

/// The most texels of a map that is kept as it is; larger ones are halved.
const MOST_TEXELS: usize = 1 << 21;
/// The greatest side of a map that is kept as it is: WebGPU guarantees textures of that side.
const MOST_SIDE: u32 = 8192;

/// The light that arrives from outside of the scene, the same at every point of it: a map of the sphere by longitude and
/// latitude, each texel of one radiance.
///
/// Row 0 lies at the zenith (+Y), the last at the nadir. The middle of a row is the direction −Z, and a quarter of a turn to the
/// right +X, where the map is not rotated.
#[derive(Clone, PartialEq, Serialize)]
pub struct Environment {
    /// Columns, ≥ 1.
    pub width: u32,
    /// Rows, ≥ 1.
    pub height: u32,
    /// Radiance \[W/(m² sr)\], RGB, row by row: finite, and not negative.
    #[serde(skip)]
    pub texels: Vec<[f32; 3]>,
    /// Angle by which the map is turned about +Y, counter-clockwise from above \[rad\].
    pub rotation: f32,
}

impl std::fmt::Debug for Environment {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Environment({} x {}, turned by {} rad)", self.width, self.height, self.rotation)
    }
}

impl Environment {
    /// Returns the same radiance from everywhere.
    pub fn uniform(radiance: [f32; 3]) -> Environment {
        Environment { width: 1, height: 1, texels: vec![radiance], rotation: 0.0 }
    }

    /// Whether the ending of a file is that of a map of radiance.
    pub fn may_be(path: &Path) -> bool {
        !matches!(FileFormat::of(path), Some(FileFormat::Png) | None)
    }

    /// Reads a map from a Radiance HDR, EXR or PFM file, times a factor.
    ///
    /// # Errors
    /// What is wrong with the file and, of a value, which pixel has it.
    pub(crate) fn read(path: &Path, factor: [f32; 3]) -> Result<Environment, String> {
        if !Self::may_be(path) {
            return Err(format!("{}: expected a map of radiance: .hdr, .exr or .pfm", path.display()));
        }
        let image = Image::read(path).map_err(|error| error.to_string())?;
        let width = image.width();
        let mut texels = Vec::with_capacity(image.pixels().len());
        for (i, [r, g, b, _]) in image.pixels().iter().enumerate() {
            let found = [*r, *g, *b];
            let texel = [0, 1, 2].map(|c| found[c] * factor[c]);
            if !texel.iter().chain(&found).all(|x| (0.0..=BRIGHTEST).contains(x)) {
                let (x, y) = (i % width, i / width);
                return Err(format!(
                    "{}: the pixel ({x}, {y}) is {found:?}; radiance must be from 0 to 10³⁰, also times {factor:?}",
                    path.display()
                ));
            }
            texels.push(texel);
        }
        Ok(Environment { width: width as u32, height: image.height() as u32, texels, rotation: 0.0 })
    }

    /// Halves the map until it is small enough. Returns its former size where it was not.
    pub(crate) fn shrink(&mut self) -> Option<(u32, u32)> {
        let size = (self.width, self.height);
        while self.texels.len() > MOST_TEXELS || self.width.max(self.height) > MOST_SIDE {
            self.halve();
        }
        (size != (self.width, self.height)).then_some(size)
    }

    /// Takes the mean of each 2 × 2 texels, by their solid angles.
    fn halve(&mut self) {
        let (width, height) = (self.width.div_ceil(2), self.height.div_ceil(2));
        let mut texels = Vec::with_capacity(width as usize * height as usize);
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            let (mut sum, mut weights) = ([0.0; 3], 0.0);
            for row in (2 * y..2 * y + 2).filter(|row| *row < self.height) {
                let weight = self.solid_angle(row);
                for column in (2 * x..2 * x + 2).filter(|column| *column < self.width) {
                    let texel = self.texels[row as usize * self.width as usize + column as usize];
                    weights += weight;
                    (0..3).for_each(|c| sum[c] += weight * f64::from(texel[c]));
                }
            }
            texels.push(sum.map(|sum| (sum / weights) as f32));
        }
        (self.width, self.height, self.texels) = (width, height, texels);
    }

    /// Whether no light arrives.
    pub fn is_black(&self) -> bool {
        self.texels.iter().flatten().all(|x| *x == 0.0)
    }

    /// Returns the solid angle of each texel of a row \[sr\].
    pub fn solid_angle(&self, row: u32) -> f64 {
        let angle = |row: u32| PI * f64::from(row) / f64::from(self.height);
        // The difference of the cosines, without its cancellation at the poles.
        let (middle, half) = (0.5 * (angle(row) + angle(row + 1)), 0.5 * PI / f64::from(self.height));
        4.0 * PI / f64::from(self.width) * middle.sin() * half.sin()
    }

    /// Returns the numbers of 32 bits that sample the texels by luminance times solid angle: texel i is sampled by those from
    /// entry i to before entry i + 1. The last entry is `u32::MAX`, or 0 where all is black.
    pub fn table(&self) -> Vec<u32> {
        let solid_angles: Vec<f64> = (0..self.height).map(|row| self.solid_angle(row)).collect();
        let rows = self.texels.chunks_exact(self.width as usize).zip(solid_angles);
        let weights = rows.flat_map(|(row, solid_angle)| {
            row.iter().map(move |[r, g, b]| {
                let luminance = 0.2126 * f64::from(*r) + 0.7152 * f64::from(*g) + 0.0722 * f64::from(*b);
                luminance * solid_angle
            })
        });
        cumulative(&weights.collect::<Vec<_>>())
    }

    /// Returns a clear sky: blue, brighter towards the horizon, over a dim ground, with a sun of 6° at 45° above the horizon
    /// towards +X and −Z, times a factor.
    pub(crate) fn sky(factor: [f32; 3]) -> Environment {
        let (width, height) = (128, 64);
        let sun = glam::DVec3::new(0.5, std::f64::consts::FRAC_1_SQRT_2, -0.5);
        let texel = |i: u32| {
            let (x, y) = (f64::from(i % width) + 0.5, f64::from(i / width) + 0.5);
            let (longitude, latitude) = (2.0 * PI * (x / f64::from(width) - 0.5), PI * y / f64::from(height));
            let level = latitude.sin();
            let to = glam::DVec3::new(level * longitude.sin(), latitude.cos(), -level * longitude.cos());
            let radiance = if to.dot(sun) > 3.0_f64.to_radians().cos() {
                [400.0, 360.0, 300.0]
            } else if to.y > 0.0 {
                let haze = (1.0 - to.y).powi(3);
                [0.35 + 0.55 * haze, 0.6 + 0.4 * haze, 1.1 + 0.1 * haze]
            } else {
                [0.12, 0.11, 0.1]
            };
            [0, 1, 2].map(|c| radiance[c] as f32 * factor[c])
        };
        Environment { width, height, texels: (0..width * height).map(texel).collect(), rotation: 0.0 }
    }
}
