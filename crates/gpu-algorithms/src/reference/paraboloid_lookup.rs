//! The f64 CPU reference of `shaders/paraboloid-lookup.wgsl`, without a bias for slopes: the same names. See there for what
//! they mean.

use super::paraboloid::{texel_centre, tile_position};
use glam::{DVec2, DVec3, UVec2};

/// A lookup of a map.
#[derive(Clone, Copy, Debug)]
pub struct ParaboloidLookup {
    /// Position in the map \[px\].
    pub position: DVec2,
    /// Distance of the receiver \[m\].
    pub distance: f64,
    /// Unit normal of the receiver's plane, in the light's frame.
    pub plane_normal: DVec3,
    /// The light's distance from that plane \[m\].
    pub plane_height: f64,
    /// Depth bias \[m\].
    pub bias: f64,
}

/// Returns the lookup for a receiver \[m\] above the light's plane, in the light's frame. `depth_bias` is in widths of a
/// texel.
pub fn paraboloid_lookup(
    receiver: DVec3,
    plane_normal: DVec3,
    tile: u32,
    depth_bias: f64,
) -> ParaboloidLookup {
    let distance = receiver.length();
    ParaboloidLookup {
        position: tile_position(receiver.truncate() / (distance + receiver.z), tile),
        distance,
        plane_normal,
        plane_height: plane_normal.dot(receiver),
        bias: (distance + receiver.z) * 2.0 / f64::from(tile) * depth_bias,
    }
}

/// Returns whether the receiver is seen past what a texel of the map stores \[m\].
pub fn is_seen(lookup: &ParaboloidLookup, texel: UVec2, tile: u32, stored: f64) -> bool {
    let centre = texel_centre(texel, tile);
    let r2 = centre.length_squared();
    let (normal, height) = (lookup.plane_normal, lookup.plane_height);
    let along = 2.0 * normal.truncate().dot(centre) + normal.z * (1.0 - r2);
    let own = if along * height > 0.0 { height * (1.0 + r2) / along } else { lookup.distance };
    own.clamp(0.5 * lookup.distance, lookup.distance) - lookup.bias <= stored
}
