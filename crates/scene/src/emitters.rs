//! The triangles that emit light, and the tables by which they are sampled.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use crate::material::{Encoding, Material, Texture};
use crate::scene::{Emitter, Scene};

/// Paths sample emitters that are at least this many times as bright as the mean of all surfaces. Paths find the others
/// often enough by themselves: where all surfaces emit alike, each path that meets one is exact.
const LEAST_CONTRAST: f64 = 2.0;

/// The emitters of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Emitters {
    /// Luminance of the flux that all of them emit at 0 s, on both sides \[W\].
    pub power: f32,
    /// The emitters by their triangles, and one entry more: emitter i is sampled by the numbers from those in entry i to
    /// those in entry i + 1. Both columns end at `u32::MAX`, or at 0 where nothing is sampled.
    pub table: Vec<Emitter>,
}

impl Scene {
    /// Returns the triangles that emit. Photons begin at them in proportion to their power at 0 s: their area, times the
    /// luminance of their emission, or of its mean over the texture. Paths sample them in the same proportion, but only
    /// those that are at least twice as bright as the mean of all surfaces.
    pub fn emitters(&self) -> Emitters {
        self.emitters_of(|_| true)
    }

    /// Returns the same of the materials that are `chosen` by their names: the others are dark.
    pub fn emitters_of(&self, chosen: impl Fn(&str) -> bool) -> Emitters {
        let mut means = BTreeMap::new();
        let luminances: Vec<f64> = self
            .materials
            .iter()
            .map(|material| match chosen(&material.name) {
                true => self.mean_luminance(material, &mut means),
                false => 0.0,
            })
            .collect();
        if luminances.iter().all(|luminance| *luminance == 0.0) {
            return Emitters {
                power: 0.0,
                table: vec![Emitter { triangle: u32::MAX, for_photons: 0, for_paths: 0 }],
            };
        }
        let luminance = |triangle: usize| {
            let vertex = self.indices[3 * triangle] as usize;
            luminances[self.vertices[vertex].material as usize]
        };
        // Triangle, power over π on one side, and luminance.
        let emitters: Vec<(u32, f64, f64)> = self
            .areas()
            .enumerate()
            .map(|(triangle, area)| (triangle as u32, area * luminance(triangle), luminance(triangle)))
            .filter(|(_, power, _)| *power > 0.0)
            .collect();
        let total: f64 = emitters.iter().map(|(_, power, _)| power).sum();
        let least = LEAST_CONTRAST * total / self.area();
        let photons: Vec<f64> = emitters.iter().map(|(_, power, _)| *power).collect();
        let paths: Vec<f64> = emitters
            .iter()
            .map(|(_, power, luminance)| if *luminance >= least { *power } else { 0.0 })
            .collect();
        let triangles = emitters.iter().map(|(triangle, ..)| *triangle).chain([u32::MAX]);
        let table = triangles
            .zip(cumulative(&photons).into_iter().zip(cumulative(&paths)))
            .map(|(triangle, (for_photons, for_paths))| Emitter { triangle, for_photons, for_paths })
            .collect();
        Emitters { power: (2.0 * PI * total).min(f64::from(f32::MAX)) as f32, table }
    }

    /// Returns the luminance of what a material emits, on average over its texture. `means` holds those of textures.
    fn mean_luminance(&self, material: &Material, means: &mut BTreeMap<u32, [f64; 3]>) -> f64 {
        if !material.is_emissive() {
            return 0.0;
        }
        let texture = material.emission_texture.and_then(|i| Some((i, self.textures.get(i as usize)?)));
        let mean = texture.map_or([1.0; 3], |(i, texture)| *means.entry(i).or_insert_with(|| mean(texture)));
        let weights = [0.2126, 0.7152, 0.0722];
        (0..3).map(|c| weights[c] * f64::from(material.emission[c].max(0.0)) * mean[c]).sum()
    }
}

/// Returns the mean of a texture, in linear light.
fn mean(texture: &Texture) -> [f64; 3] {
    let value = |byte: u8| {
        let value = f32::from(byte) / 255.0;
        f64::from(if texture.encoding == Encoding::Srgb { metrics::linear_from_srgb(value) } else { value })
    };
    let values: Vec<f64> = (0..=u8::MAX).map(value).collect();
    let texels = texture.pixels.chunks_exact(4);
    let count = texels.len().max(1) as f64;
    let sums = texels.fold([0.0; 3], |sums: [f64; 3], texel| {
        std::array::from_fn(|c| sums[c] + values[usize::from(texel[c])])
    });
    sums.map(|sum| sum / count)
}

/// Returns the sums of the first i weights, as shares of all of them times 2³², rounded, and at most `u32::MAX`; zeros if
/// all weights are 0.
pub(crate) fn cumulative(weights: &[f64]) -> Vec<u32> {
    let total: f64 = weights.iter().sum();
    let mut sum = 0.0;
    let shares = weights.iter().map(|weight| {
        sum += if total > 0.0 { weight / total } else { 0.0 };
        // `as` saturates at u32::MAX, the value of the last entry.
        (sum * 4_294_967_296.0).round() as u32
    });
    std::iter::once(0).chain(shares).collect()
}
