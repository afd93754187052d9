//! Twin of new-pass.wgsl, in `f64`.

/// Radiance, linear Rec. 709 \[W/(m² sr)\], times `gain`.
pub fn scale(radiance: [f64; 3], gain: f64) -> [f64; 3] {
    radiance.map(|x| gain * x)
}
