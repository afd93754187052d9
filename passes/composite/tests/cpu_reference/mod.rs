//! The CPU reference of composite.wgsl and shaders/tonemap.wgsl, in `f64`.

use std::f64::consts::PI;

/// A color, linear Rec. 709.
pub(crate) type Rgb = [f64; 3];

/// Returns the picture: direct + albedo/π × irradiance + glossy + emission \[W/(m² sr)\].
pub(crate) fn composite(direct: Rgb, albedo: Rgb, irradiance: Rgb, glossy: Rgb, emission: Rgb) -> Rgb {
    std::array::from_fn(|i| direct[i] + albedo[i] / PI * irradiance[i] + glossy[i] + emission[i])
}

/// Returns the relative luminance (BT.709).
pub(crate) fn luminance(rgb: Rgb) -> f64 {
    0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]
}

/// Returns the encoded color, in 0..=1, of a radiance. `name` is a choice of the setting `tonemap`; any name
/// that is not one of a curve only clamps at 1.
pub(crate) fn displayed(name: &str, radiance: Rgb, exposure: f64, white: f64) -> Rgb {
    if !radiance.iter().all(|x| x.is_finite()) {
        return [1.0, 0.0, 1.0];
    }
    let exposed = radiance.map(|x| (x * exposure.exp2()).clamp(0.0, 1e18));
    tonemap(name, exposed, white).map(|x| srgb(x.clamp(0.0, 1.0)))
}

/// Returns the curve of that name on exposed radiance.
pub(crate) fn tonemap(name: &str, rgb: Rgb, white: f64) -> Rgb {
    let l = luminance(rgb);
    let hable = |x: f64| (x * (0.15 * x + 0.05) + 0.004) / (x * (0.15 * x + 0.5) + 0.06) - 0.02 / 0.3;
    match name {
        "reinhard" => rgb.map(|x| x * (1.0 + l / (white * white)) / (1.0 + l)),
        "reinhard-simple" => rgb.map(|x| x / (1.0 + l)),
        "aces" => rgb.map(|x| x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)),
        "filmic" => rgb.map(|x| hable(x) / hable(white)),
        _ => rgb,
    }
}

/// Returns the encoding of sRGB (IEC 61966-2-1) of linear light in 0..=1.
pub(crate) fn srgb(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}
