//! The CPU reference in `f64`: the sum over all lights that few samples estimate.

use glam::DVec3;
use interfaces::virtual_lights::VirtualLight;
use std::f64::consts::PI;

/// The kind of a light infinitely far.
pub(crate) const INFINITELY_FAR: u32 = 1;

/// The greatest distance at which a light is bounded \[m\], a fifth of the extent of the scene `plane`.
const MOST_BOUND: f64 = 0.4 * std::f64::consts::SQRT_2;

/// Returns the geometry term of a light \[1/m²\], bounded at `radii` of the disc that it stands for: what remains, and what the bound
/// removes.
pub(crate) fn geometry(light: &VirtualLight, at: DVec3, normal: DVec3, radii: f64) -> (f64, f64) {
    let of_light = DVec3::from(light.normal.map(f64::from));
    if light.kind == INFINITELY_FAR {
        return ((-normal.dot(of_light)).max(0.0), 0.0);
    }
    let offset = at - DVec3::from(light.position.map(f64::from));
    let distance2 = offset.length_squared();
    let cosines = (-normal.dot(offset)).max(0.0) * of_light.dot(offset).max(0.0) / distance2;
    let least = (radii * radii * f64::from(light.area)).min(PI * MOST_BOUND * MOST_BOUND);
    let kept = cosines / (PI * distance2).max(least);
    (kept, cosines / (PI * distance2) - kept)
}

/// Returns the irradiance of all lights at a point \[W/m²\], and in the last component the luminance of what the bound removes.
pub(crate) fn irradiance(lights: &[VirtualLight], at: DVec3, normal: DVec3, radii: f64) -> [f64; 4] {
    let mut sum = [0.0; 4];
    for light in lights {
        let (kept, removed) = geometry(light, at, normal, radii);
        let flux = light.flux.map(f64::from);
        for (sum, flux) in sum.iter_mut().zip(flux) {
            *sum += flux * kept;
        }
        sum[3] += removed * std::iter::zip([0.2126, 0.7152, 0.0722], flux).map(|(w, f)| w * f).sum::<f64>();
    }
    sum
}
