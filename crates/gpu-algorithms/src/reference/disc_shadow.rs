//! The f64 CPU reference of `shaders/disc-shadow.wgsl`: the same functions, by the same names. See there for what they mean.

use glam::{DVec2, UVec2};
use std::f64::consts::PI;

/// Returns the radius of a light of that area \[m²\].
pub fn disc_radius(area: f64) -> f64 {
    (area.max(0.0) / PI).sqrt()
}

/// Returns the radius around the receiver of the region that blockers are looked for in.
pub fn search_radius(radius: f64, nearest: f64) -> f64 {
    radius * (1.0 - nearest) / nearest
}

/// Returns half the width of the penumbra that blockers cast on a receiver, both at a height above the light's plane.
pub fn penumbra_radius(radius: f64, receiver: f64, blocker: f64) -> f64 {
    radius * (receiver - blocker).max(0.0) / blocker
}

/// Returns the texel of a map in which a receiver falls.
pub fn texel_of(position: DVec2, tile: u32) -> UVec2 {
    position.clamp(DVec2::ZERO, DVec2::splat(f64::from(tile - 1))).as_uvec2()
}
