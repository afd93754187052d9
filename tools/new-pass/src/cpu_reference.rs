//! The CPU reference of new-pass.wgsl, in `f64`.

/// Multiplies the radiance, linear Rec. 709 \[W/(m² sr)\], by `gain`.
pub fn scale(radiance: [f64; 3], gain: f64) -> [f64; 3] {
    radiance.map(|x| gain * x)
}
