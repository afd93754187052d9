//! The CPU reference in `f64`, with the names of gather.wgsl.

use glam::DVec3;
use std::f64::consts::PI;

/// A virtual light of one channel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct VirtualLight {
    /// \[m\]
    pub(crate) position: DVec3,
    /// Unit.
    pub(crate) normal: DVec3,
    /// Φ \[W\].
    pub(crate) flux: f64,
    /// A \[m²\].
    pub(crate) area: f64,
}

/// The bound of a geometry term.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Bound {
    /// That at this many radii of a disc of the light's area, at most a fifth of the extent.
    Radii(f64),
    /// The term of a disc straight ahead.
    PointToDisc,
}

/// Returns the geometry term of a light without its visibility \[1/m²\]: what remains after the bound, and what
/// the bounds remove. Nearer than `near` \[m\], d² / near² remains of a light; `extent` is that of the scene \[m\].
pub(crate) fn geometry(
    light: &VirtualLight,
    at: DVec3,
    normal: DVec3,
    (bound, near): (Bound, f64),
    extent: f64,
) -> (f64, f64) {
    let offset = at - light.position;
    let distance2 = offset.length_squared().max((1e-6 * extent).powi(2));
    let cosines = (-normal.dot(offset)).max(0.0) * light.normal.dot(offset).max(0.0) / distance2;
    let (closest2, area) = match bound {
        Bound::Radii(radii) => ((radii.powi(2) * light.area / PI).min((0.2 * extent).powi(2)), 0.0),
        Bound::PointToDisc => (0.0, light.area),
    };
    let term = |distance2: f64| cosines / (PI * distance2 + area);
    let kept = term(distance2.max(closest2)) * (distance2 / near.powi(2)).min(1.0);
    (kept, term(distance2) - kept)
}

/// Indices of the lights of subset `s` of `subsets`, in runs or in strides.
pub(crate) fn subset(s: u32, subsets: u32, count: u32, runs: bool) -> Vec<u32> {
    if runs {
        (s * count / subsets..(s + 1) * count / subsets).collect()
    } else {
        (s..count).step_by(subsets as usize).collect()
    }
}
