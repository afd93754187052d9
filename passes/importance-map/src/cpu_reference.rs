//! `view-samples.wgsl`, `importance-map.wgsl` and `mix.wgsl` in double precision.

use std::f64::consts::PI;

/// Three numbers: a position, a direction, or a colour in linear Rec. 709.
pub type Vec3 = [f64; 3];

/// Weights of the channels in luminance (BT.709).
pub const LUMINANCE: Vec3 = [0.2126, 0.7152, 0.0722];

/// A sample of what the camera sees, with lengths in units of the scene's extent.
#[derive(Clone, Copy, Debug, Default)]
pub struct ViewSample {
    /// From the corner of the scene's bounding box.
    pub position: Vec3,
    /// Unit.
    pub normal: Vec3,
    /// Luminance of radiance per channel of irradiance \[1/sr\].
    pub response: Vec3,
}

/// Returns the pixel that two numbers in [0, 1) pick.
pub fn pixel(numbers: [f64; 2], size: (u32, u32)) -> (u32, u32) {
    let pick = |number: f64, of: u32| ((number * f64::from(of)) as u32).min(of - 1);
    (pick(numbers[0], size.0), pick(numbers[1], size.1))
}

/// Returns the `response` of a surface of that albedo.
pub fn response(albedo: Vec3) -> Vec3 {
    [0, 1, 2].map(|c| LUMINANCE[c] * albedo[c] / PI)
}

/// Returns the relative luminance (BT.709).
pub fn luminance(rgb: Vec3) -> f64 {
    dot(rgb, LUMINANCE)
}

/// Returns the geometry term of Eq. 2 \[1/extents²\].
pub fn geometry(position: Vec3, normal: Vec3, at: &ViewSample, min_distance: f64) -> f64 {
    let way = [0, 1, 2].map(|c| at.position[c] - position[c]);
    let squared = dot(way, way).max(1e-20);
    let cosines = dot(normal, way).max(0.0) * (-dot(at.normal, way)).max(0.0) / squared;
    cosines / (PI * (squared + min_distance * min_distance))
}

/// Returns the importance by contribution (Eq. 1) of a texel with that position \[extents\], normal and flux \[W\].
pub fn contribution(
    position: Vec3,
    normal: Vec3,
    flux: Vec3,
    samples: &[ViewSample],
    min_distance: f64,
) -> f64 {
    let sum = samples
        .iter()
        .map(|sample| dot(flux, sample.response) * geometry(position, normal, sample, min_distance));
    sum.sum::<f64>() / samples.len() as f64
}

/// Returns the mixture of contributions with flux: `defensive` is δ. The mean is 1; less where the view sees none of
/// the lights, or they reflect nothing.
pub fn mix_with_flux(contribution: &[f64], flux: &[f64], defensive: f64) -> Vec<f64> {
    let whole = |values: &[f64]| values.iter().sum::<f64>();
    let (by_view, by_flux) = (whole(contribution), whole(flux));
    let share = |value: f64, whole: f64| if whole > 0.0 { value / whole } else { 0.0 };
    let texels = contribution.len() as f64;
    std::iter::zip(contribution, flux)
        .map(|(c, f)| texels * ((1.0 - defensive) * share(*c, by_view) + defensive * share(*f, by_flux)))
        .collect()
}

fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
