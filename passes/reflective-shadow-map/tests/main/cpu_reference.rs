//! The CPU reference of `flux` of reflective-shadow-map.wgsl and of the lights of shaders/lights.wgsl, in `f64`.

use glam::{DVec2, DVec3, UVec2};

/// The distribution of light over a layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Layer {
    /// A spot: intensity 1 W/sr on its axis, cosines of the half angles of its cones.
    Spot {
        /// Within it, the whole intensity.
        cos_inner: f64,
        /// Beyond it, nothing.
        cos_outer: f64,
    },
    /// A face of a point light: intensity 1 W/sr everywhere.
    Point,
    /// Parallel light: 1 W/m² across its direction.
    Directional,
}

/// Returns what the light sends through the texel `(x, y)` of a map of `size`² texels \[W\].
///
/// `half_extent` is half the width and height of the image plane at distance 1, for [`Layer::Directional`] in metres.
pub(crate) fn incident_flux(layer: Layer, texel: UVec2, size: u32, half_extent: DVec2) -> f64 {
    let corner = |at: UVec2| {
        let ndc = at.as_dvec2() / f64::from(size) * 2.0 - 1.0;
        ndc * half_extent * DVec2::new(1.0, -1.0)
    };
    let (low, high) = (corner(texel), corner(texel + 1));
    if layer == Layer::Directional {
        return (high - low).element_product().abs();
    }
    let cosine = 1.0 / (0.5 * (low + high)).extend(1.0).length();
    falloff(layer, cosine) * rectangle_solid_angle(low, high)
}

/// Returns the share of the intensity at an angle of that cosine to the axis: the square of a ramp, as
/// KHR_lights_punctual recommends.
pub(crate) fn falloff(layer: Layer, cosine: f64) -> f64 {
    match layer {
        Layer::Spot { cos_inner, cos_outer } => {
            ((cosine - cos_outer) / (cos_inner - cos_outer).max(1e-6)).clamp(0.0, 1.0).powi(2)
        }
        _ => 1.0,
    }
}

/// Returns the solid angle \[sr\] of a rectangle on the plane at distance 1, given two opposite corners.
pub(crate) fn rectangle_solid_angle(low: DVec2, high: DVec2) -> f64 {
    let volume = (high - low).element_product().abs();
    let [a, b, c, d] = [low, low.with_x(high.x), high, low.with_y(high.y)].map(|corner| corner.extend(1.0));
    triangle_solid_angle(a, b, c, volume) + triangle_solid_angle(a, c, d, volume)
}

/// Computes the solid angle by Van Oosterom & Strackee 1983, Eq. 8; `volume` is |a · (b × c)|.
pub(crate) fn triangle_solid_angle(a: DVec3, b: DVec3, c: DVec3, volume: f64) -> f64 {
    let [la, lb, lc] = [a, b, c].map(DVec3::length);
    2.0 * (volume / (la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb)).atan()
}
