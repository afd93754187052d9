//! The CPU reference of show-clusters.wgsl in `f64`, for the map of one light. Vectors are in the space of its layer: x
//! right, y up, the light looks along −z.

use glam::{DVec2, DVec3, UVec2};

/// Share of its brightness that a color has in shadow.
pub(crate) const IN_SHADOW: f64 = 0.35;

/// The distance behind the surface in the map at which a surface still counts as lit, in sides of a texel, times 1 + its slope.
pub(crate) const BIAS: f64 = 1.0;

/// Bound on the slope.
pub(crate) const STEEPEST: f64 = 8.0;

/// The projection of a map, which decides where it sees a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Projection {
    /// Texels of the layer.
    pub(crate) size: UVec2,
    /// Half the width and height at distance 1; in metres if the projection is parallel.
    pub(crate) half_extent: DVec2,
    /// Whether the map belongs to a spot or point light.
    pub(crate) perspective: bool,
}

impl Projection {
    /// Returns the texel that a point lies in; `None` where the map does not reach it.
    pub(crate) fn texel_of(&self, receiver: DVec3) -> Option<UVec2> {
        if self.perspective && receiver.z >= 0.0 {
            return None;
        }
        let size = self.size.as_dvec2();
        let uv =
            (receiver.truncate() / self.half_extent_at(-receiver.z) * DVec2::new(0.5, -0.5) + 0.5) * size;
        (uv.cmpge(DVec2::ZERO).all() && uv.cmplt(size).all()).then(|| uv.as_uvec2())
    }

    /// Returns whether light reaches a point with the normal `n`, where the map has seen something at the distance
    /// `seen` along its axis \[m\]; 0 for nothing.
    pub(crate) fn is_lit(&self, receiver: DVec3, n: DVec3, seen: f64) -> bool {
        let side = 2.0 * (self.half_extent_at(-receiver.z) / self.size.as_dvec2()).max_element();
        let cosine = if self.perspective { -n.dot(receiver.normalize()) } else { n.z };
        let slope = (1.0 - cosine * cosine).max(0.0).sqrt() / cosine.max(1.0 / STEEPEST);
        cosine > 0.0 && (seen == 0.0 || seen >= -receiver.z - BIAS * side * (1.0 + slope))
    }

    fn half_extent_at(&self, distance: f64) -> DVec2 {
        self.half_extent * if self.perspective { distance } else { 1.0 }
    }
}

/// Returns the color of a cluster, whose hash is `bits`.
pub(crate) fn color_of(index: u32, bits: u32) -> DVec3 {
    let hue = f64::from(index.wrapping_mul(2_654_435_769) >> 8) / 16_777_216.0 * 6.0;
    let value = 0.6 + 0.2 * f64::from(bits % 3);
    let saturation = 0.5 + 0.4 * f64::from((bits >> 8) % 2);
    let ramp = |turn: f64| (((hue + turn) % 6.0 - 3.0).abs() - 1.0).clamp(0.0, 1.0);
    DVec3::new(ramp(0.0), ramp(4.0), ramp(2.0)).map(|ramp| value * (1.0 - saturation + saturation * ramp))
}
