// From linear radiance to what a screen shows: exposure, a curve, and the encoding of sRGB.

#option TONEMAP reinhard one_of [reinhard, reinhard-simple, aces, filmic, none] // The curve from radiance to `display`; `image` stays linear.

#import "color.wgsl"

/// The encoded color, in 0..1, of a radiance [W/(m² sr)].
///
/// `exposure` [EV] doubles the radiance with each step; `white` is the exposed luminance that becomes white, where
/// the curve has one. A channel that is infinite or no number shows as magenta, which no curve makes of light.
fn displayed(radiance: vec3<f32>, exposure: f32, white: f32) -> vec3<f32> {
    if !all_finite(radiance) {
        return vec3(1.0, 0.0, 1.0);
    }
    // Beyond this the curves' squares leave single precision, and white they are anyway.
    let exposed = clamp(radiance * exp2(exposure), vec3(0.0), vec3(1e18));
    return srgb(clamp(tonemap(exposed, white), vec3(0.0), vec3(1.0)));
}

#if TONEMAP == reinhard
/// Reinhard et al. 2002, Eq. 4, on luminance: L (1 + L/w²) / (1 + L).
fn tonemap(rgb: vec3<f32>, white: f32) -> vec3<f32> {
    let l = luminance(rgb);
    return rgb * ((1.0 + l / (white * white)) / (1.0 + l));
}
#elif TONEMAP == reinhard-simple
/// Reinhard et al. 2002, Eq. 3, on luminance: L / (1 + L).
fn tonemap(rgb: vec3<f32>, white: f32) -> vec3<f32> {
    return rgb / (1.0 + luminance(rgb));
}
#elif TONEMAP == aces
/// A fit to the ACES filmic curve, a channel at a time (Narkowicz 2015).
fn tonemap(rgb: vec3<f32>, white: f32) -> vec3<f32> {
    return rgb * (2.51 * rgb + 0.03) / (rgb * (2.43 * rgb + 0.59) + 0.14);
}
#elif TONEMAP == filmic
/// Hable 2010 (Uncharted 2), a channel at a time, scaled so that `white` becomes 1.
fn tonemap(rgb: vec3<f32>, white: f32) -> vec3<f32> {
    return hable(rgb) / hable(vec3(white));
}

/// (x (0.15 x + 0.05) + 0.004) / (x (0.15 x + 0.5) + 0.06) - 0.02 / 0.3, over one denominator: of dark colors, the difference
/// has no digits.
fn hable(x: vec3<f32>) -> vec3<f32> {
    return x * (0.14 * x + 1.0 / 60.0) / (x * (0.15 * x + 0.5) + 0.06);
}
#else
/// Cut at 1.
fn tonemap(rgb: vec3<f32>, white: f32) -> vec3<f32> {
    return rgb;
}
#endif

/// The encoding of sRGB (IEC 61966-2-1) of linear light in 0..1.
fn srgb(linear: vec3<f32>) -> vec3<f32> {
    return select(1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055, 12.92 * linear, linear <= vec3(0.0031308));
}

/// By their bits, as comparisons with infinity and NaN may be optimised away.
fn all_finite(v: vec3<f32>) -> bool {
    return all((bitcast<vec3<u32>>(v) & vec3(0x7f800000u)) != vec3(0x7f800000u));
}
