//! Lights without extent: spot, point, directional.

use std::f32::consts::PI;

use glam::Vec3;
use serde::Serialize;

/// The type of a light, with the properties that only this type has.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum LightKind {
    /// Emits from a point into a cone.
    Spot {
        /// Half the angle of the cone with full intensity \[rad\], ≤ `outer`.
        inner: f32,
        /// Half the angle of the whole cone \[rad\], in (0, π/2].
        outer: f32,
    },
    /// Emits from a point in all directions.
    Point,
    /// Arrives everywhere from one direction.
    Directional,
}

/// A light.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Light {
    /// The name in its file, or `light 0` and so on if it has none.
    #[serde(skip)]
    pub name: String,
    /// The type.
    pub kind: LightKind,
    /// Position \[m\]; ignored for a directional light.
    pub position: Vec3,
    /// The direction in which the light travels, of length 1: the axis of a spot light; ignored for a point
    /// light.
    pub direction: Vec3,
    /// RGB. For spot and point lights: radiant intensity \[W/sr\]. For directional lights: irradiance on a
    /// plane perpendicular to the direction \[W/m²\].
    pub intensity: Vec3,
}

/// The most that a light may send in one channel \[W/sr or W/m²\]: sums over lights and pixels, divided by densities, are then
/// below what 32 bits hold.
pub const BRIGHTEST: f32 = 1e30;

/// Half the angle \[rad\] of the widest cone that one plane map shows well: 75°. A texel at its corner has a 30th of the solid
/// angle of one in the middle, and at 90° the plane has no end.
const WIDEST_PLANE: f32 = 75.0 / 180.0 * PI;

impl Light {
    /// Returns the number of layers that the light takes in a shadow map or reflective shadow map: 6 for a
    /// point light and for a spot of more than 75° to each side (the faces of a cube), 1 for the others.
    pub fn layers(&self) -> u32 {
        match self.kind {
            LightKind::Point => 6,
            LightKind::Spot { outer, .. } if outer > WIDEST_PLANE => 6,
            LightKind::Spot { .. } | LightKind::Directional => 1,
        }
    }

    /// Returns the share of the intensity in a direction at an angle of cosine `cos_theta` to the axis, in
    /// 0..=1. From the inner to the outer cone of a spot light it falls as t², where t is linear in the
    /// cosine, as KHR_lights_punctual recommends; if both cones are equal it is a step.
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

    /// Returns the total emitted flux \[W\], RGB; `None` for a directional light, which is unbounded.
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
