//! The CPU reference of flux.wgsl and of the lights of shaders/lights.wgsl, in `f64`.

/// How a layer spreads the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Layer {
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
pub fn incident_flux(layer: Layer, texel: [u32; 2], size: u32, half_extent: [f64; 2]) -> f64 {
    let corner = |at: [u32; 2]| {
        let ndc = at.map(|a| f64::from(a) / f64::from(size) * 2.0 - 1.0);
        [ndc[0] * half_extent[0], -ndc[1] * half_extent[1]]
    };
    let (low, high) = (corner(texel), corner(texel.map(|t| t + 1)));
    if layer == Layer::Directional {
        return ((high[0] - low[0]) * (high[1] - low[1])).abs();
    }
    let middle = [0, 1].map(|i| 0.5 * (low[i] + high[i]));
    let cosine = 1.0 / (middle[0] * middle[0] + middle[1] * middle[1] + 1.0).sqrt();
    falloff(layer, cosine) * solid_angle(low, high)
}

/// Returns the share of the intensity at an angle of that cosine to the axis: the square of a ramp, as
/// KHR_lights_punctual recommends.
pub fn falloff(layer: Layer, cosine: f64) -> f64 {
    match layer {
        Layer::Spot { cos_inner, cos_outer } => {
            ((cosine - cos_outer) / (cos_inner - cos_outer).max(1e-6)).clamp(0.0, 1.0).powi(2)
        }
        _ => 1.0,
    }
}

/// Returns the solid angle \[sr\] of a rectangle on the plane at distance 1, given two opposite corners.
pub fn solid_angle(low: [f64; 2], high: [f64; 2]) -> f64 {
    let volume = ((high[0] - low[0]) * (high[1] - low[1])).abs();
    let [a, b, c, d] = [low, [high[0], low[1]], high, [low[0], high[1]]].map(|[x, y]| [x, y, 1.0]);
    triangle_solid_angle(a, b, c, volume) + triangle_solid_angle(a, c, d, volume)
}

/// Computes the solid angle by Van Oosterom & Strackee 1983, Eq. 8; `volume` is |a · (b × c)|.
pub fn triangle_solid_angle(a: [f64; 3], b: [f64; 3], c: [f64; 3], volume: f64) -> f64 {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let [la, lb, lc] = [a, b, c].map(|v| dot(v, v).sqrt());
    2.0 * (volume / (la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb)).atan()
}
