//! The f64 CPU reference of `shaders/paraboloid.wgsl`, for those of the passes that share it: the same functions, by the same
//! names. See there for what they mean.

use glam::{DMat3, DVec2, DVec3, UVec2, dvec2, dvec3};

/// Returns the axes x, y, z of an orthonormal, right-handed frame whose z is a unit vector (Duff et al. 2017).
pub fn frame_from_normal(n: DVec3) -> DMat3 {
    let side = if n.z >= 0.0 { 1.0 } else { -1.0 };
    let a = -1.0 / (side + n.z);
    let b = n.x * n.y * a;
    let x = dvec3(1.0 + side * n.x * n.x * a, side * b, -side * n.x);
    let y = dvec3(b, side + n.y * n.y * a, -n.y);
    DMat3::from_cols(x, y, n)
}

/// Returns the point of the square [-1, 1]² for a unit direction.
pub fn paraboloid_from_direction(d: DVec3) -> DVec2 {
    dvec2(d.x, d.y) / (1.0 + d.z)
}

/// Returns the unit direction for a point of the square.
pub fn direction_from_paraboloid(at: DVec2) -> DVec3 {
    let r2 = at.length_squared();
    (2.0 * at).extend(1.0 - r2) / (1.0 + r2)
}

/// Returns the solid angle per area of the square \[sr\].
pub fn paraboloid_density(at: DVec2) -> f64 {
    (2.0 / (1.0 + at.length_squared())).powi(2)
}

/// Returns the area of a texel in the square.
pub fn texel_area(tile: u32) -> f64 {
    (2.0 / f64::from(tile)).powi(2)
}

/// Returns the position in a tile \[px\].
pub fn tile_position(at: DVec2, tile: u32) -> DVec2 {
    (at * 0.5 + 0.5) * f64::from(tile)
}

/// Returns the point of the square at the centre of a texel.
pub fn texel_centre(texel: UVec2, tile: u32) -> DVec2 {
    (texel.as_dvec2() + 0.5) * (2.0 / f64::from(tile)) - 1.0
}

/// Returns whether any of a texel is in the disc.
pub fn texel_in_hemisphere(texel: UVec2, tile: u32) -> bool {
    let nearest = (texel_centre(texel, tile).abs() - 1.0 / f64::from(tile)).max(DVec2::ZERO);
    nearest.length_squared() < 1.0
}

/// Returns whether a point in the light's frame is an occluder and not the light's own surface.
pub fn above_horizon(local: DVec3, extent: f64) -> bool {
    local.z > 1e-3 * local.length() + 1e-6 * extent
}
