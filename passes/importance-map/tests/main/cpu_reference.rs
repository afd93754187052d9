//! `view-samples.wgsl` and `importance-map.wgsl` in double precision.

use glam::DVec3;
use std::f64::consts::PI;

/// Weights of the channels in luminance (BT.709).
pub(crate) const LUMINANCE: DVec3 = DVec3::new(0.2126, 0.7152, 0.0722);

/// A sample of what the camera sees, with lengths in units of the scene's extent.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ViewSample {
    /// From the corner of the scene's bounding box.
    pub(crate) position: DVec3,
    /// Unit.
    pub(crate) normal: DVec3,
    /// Luminance of radiance per channel of irradiance \[1/sr\].
    pub(crate) response: DVec3,
}

/// Returns the pixel that two numbers in [0, 1) select.
pub(crate) fn pixel(numbers: [f64; 2], size: (u32, u32)) -> (u32, u32) {
    let pick = |number: f64, of: u32| ((number * f64::from(of)) as u32).min(of - 1);
    (pick(numbers[0], size.0), pick(numbers[1], size.1))
}

/// Returns the `response` of a surface of that albedo.
pub(crate) fn response(albedo: DVec3) -> DVec3 {
    LUMINANCE * albedo / PI
}

/// Returns the relative luminance (BT.709) of a linear color.
pub(crate) fn luminance(rgb: DVec3) -> f64 {
    rgb.dot(LUMINANCE)
}

/// Returns the geometry term of Eq. 2 \[1/extents²\].
pub(crate) fn geometry(position: DVec3, normal: DVec3, at: &ViewSample, min_distance: f64) -> f64 {
    let way = at.position - position;
    let squared = way.length_squared().max(1e-20);
    let cosines = normal.dot(way).max(0.0) * (-at.normal.dot(way)).max(0.0) / squared;
    cosines / (PI * (squared + min_distance * min_distance))
}

/// Returns what each sample counts, from what it receives. Those that see no surface are not in the mean.
pub(crate) fn weights(samples: &[ViewSample], received: &[f64]) -> Vec<f64> {
    let surfaces = samples.iter().filter(|sample| sample.response != DVec3::ZERO).count();
    let mean = received.iter().sum::<f64>() / surfaces as f64;
    received.iter().map(|received| mean / (received + 0.2 * mean)).collect()
}

/// Returns the response of the view to a light at that position \[extents\] with that normal \[1/extents²\]: the sum of
/// Eq. 1 per channel of flux.
pub(crate) fn view_response(
    position: DVec3,
    normal: DVec3,
    samples: &[ViewSample],
    min_distance: f64,
) -> DVec3 {
    let each =
        samples.iter().map(|sample| sample.response * geometry(position, normal, sample, min_distance));
    each.sum::<DVec3>() / samples.len() as f64
}

/// Returns the importance of a texel that reflects that flux \[W\]: Eq. 1, and `defensive` times its luminance.
pub(crate) fn importance(flux: DVec3, response: DVec3, defensive: f64) -> f64 {
    flux.dot(response) + defensive * luminance(flux)
}

/// Returns what a texel reflects of the flux that the light sends into it \[W\]: ACRSM Eq. 4.1 with Eq. 5.1-5.2. `specular` is
/// the reflectance at normal incidence, and roughness.
pub(crate) fn reflected(beam: DVec3, albedo: DVec3, specular: (DVec3, f64), diffuse_weight: f64) -> f64 {
    let diffuse = (albedo * beam).max_element();
    diffuse_weight * diffuse + (1.0 - diffuse_weight) * (specular.0 * beam).max_element() * (1.0 - specular.1)
}

/// Returns the mean cosine under which samples of the view see a position \[extents\]: ACRSM Eq. 4.2.
pub(crate) fn seen(position: DVec3, samples: &[ViewSample]) -> f64 {
    let cosine =
        |sample: &ViewSample| sample.normal.dot((position - sample.position).normalize_or_zero()).max(0.0);
    samples.iter().map(cosine).sum::<f64>() / samples.len() as f64
}

/// Returns the importance of texels by what each reflects and how it is seen, greatest value 1: ACRSM Eq. 4.3.
pub(crate) fn by_reflectance(texels: &[(f64, f64)], view_weight: f64) -> Vec<f64> {
    let part = |value: f64, greatest: f64| if greatest > 0.0 { value / greatest } else { 0.0 };
    let greatest = texels.iter().map(|(reflected, _)| *reflected).fold(0.0, f64::max);
    let combined = |(reflected, seen): &(f64, f64)| {
        (1.0 - view_weight) * part(*reflected, greatest) + view_weight * seen
    };
    let values: Vec<f64> = texels.iter().map(combined).collect();
    let greatest = values.iter().copied().fold(0.0, f64::max);
    values.into_iter().map(|value| part(value, greatest)).collect()
}
