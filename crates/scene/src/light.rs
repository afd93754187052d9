//! Lights without extent: spot, point, directional.

use std::f32::consts::PI;

use glam::Vec3;

/// What kind of light, and what only that kind has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// Shines from a point into a cone.
    Spot {
        /// Half the angle of the cone that has the full intensity \[rad\], ≤ `outer`.
        inner: f32,
        /// Half the angle of the whole cone \[rad\], in (0, π/2].
        outer: f32,
    },
    /// Shines from a point in all directions.
    Point,
    /// Shines everywhere from one direction.
    Directional,
}

/// A light.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// The name in its file, or `light 0` and so on.
    pub name: String,
    /// The kind.
    pub kind: LightKind,
    /// Where it is \[m\]; of no meaning for a directional light.
    pub position: Vec3,
    /// The way the light travels, of length 1: the axis of a spot; of no meaning for a point light.
    pub direction: Vec3,
    /// Spot and point: radiant intensity \[W/sr\]. Directional: irradiance on a plane across its direction
    /// \[W/m²\]. RGB.
    pub intensity: Vec3,
}

impl Light {
    /// Returns how many layers of a shadow map or reflective shadow map the light takes: the six faces of a cube for a
    /// point light, 1 for the others.
    pub fn layers(&self) -> u32 {
        if self.kind == LightKind::Point { 6 } else { 1 }
    }

    /// Returns the share of the intensity that goes to a direction at an angle of cosine `cos_theta` to the axis, in
    /// 0..=1. A spot falls from its inner to its outer cone as t², t linear in the cosine, as KHR_lights_punctual
    /// recommends; where both are equal it is a step.
    pub fn falloff(&self, cos_theta: f32) -> f32 {
        let LightKind::Spot { inner, outer } = self.kind else { return 1.0 };
        let (cos_inner, cos_outer) = (inner.cos(), outer.cos());
        if cos_theta >= cos_inner {
            1.0
        } else if cos_theta <= cos_outer {
            0.0
        } else {
            let t = (cos_theta - cos_outer) / (cos_inner - cos_outer);
            t * t
        }
    }

    /// Returns all the light it emits \[W\], RGB; `None` for a directional light, which has no end.
    pub fn flux(&self) -> Option<Vec3> {
        let solid_angle = match self.kind {
            // ∫ falloff dω = 2π (1 − cos inner + (cos inner − cos outer)/3).
            LightKind::Spot { inner, outer } => {
                2.0 * PI * ((1.0 - inner.cos()) + (inner.cos() - outer.cos()) / 3.0)
            }
            LightKind::Point => 4.0 * PI,
            LightKind::Directional => return None,
        };
        Some(self.intensity * solid_angle)
    }
}
