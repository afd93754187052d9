//! The f64 CPU reference of `shaders/paraboloid.wgsl`, for those of the passes that share it: the same functions, by the same
//! names. See there for what they mean.

/// A vector of three.
pub type Vec3 = [f64; 3];
/// A point of the square [-1, 1]².
pub type Vec2 = [f64; 2];

/// Returns the scalar product.
pub fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Returns the difference.
pub fn sub(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Returns the multiple.
pub fn scale(a: Vec3, s: f64) -> Vec3 {
    a.map(|x| x * s)
}

/// Returns the axes x, y, z of an orthonormal, right-handed frame whose z is a unit vector (Duff et al. 2017).
pub fn frame_from_normal(n: Vec3) -> [Vec3; 3] {
    let side = if n[2] >= 0.0 { 1.0 } else { -1.0 };
    let a = -1.0 / (side + n[2]);
    let b = n[0] * n[1] * a;
    [[1.0 + side * n[0] * n[0] * a, side * b, -side * n[0]], [b, side + n[1] * n[1] * a, -n[1]], n]
}

/// Returns a vector in a frame: `v * frame` of the WGSL.
pub fn into_frame(v: Vec3, frame: &[Vec3; 3]) -> Vec3 {
    frame.map(|axis| dot(v, axis))
}

/// Returns the point of the square for a unit direction.
pub fn paraboloid_from_direction(d: Vec3) -> Vec2 {
    [d[0] / (1.0 + d[2]), d[1] / (1.0 + d[2])]
}

/// Returns the unit direction for a point of the square.
pub fn direction_from_paraboloid(at: Vec2) -> Vec3 {
    let r2 = at[0] * at[0] + at[1] * at[1];
    scale([2.0 * at[0], 2.0 * at[1], 1.0 - r2], 1.0 / (1.0 + r2))
}

/// Returns the solid angle per area of the square \[sr\].
pub fn paraboloid_density(at: Vec2) -> f64 {
    (2.0 / (1.0 + at[0] * at[0] + at[1] * at[1])).powi(2)
}

/// Returns the area of a texel in the square.
pub fn texel_area(tile: u32) -> f64 {
    (2.0 / f64::from(tile)).powi(2)
}

/// Returns the position in a tile \[px\].
pub fn tile_position(at: Vec2, tile: u32) -> Vec2 {
    at.map(|x| (x * 0.5 + 0.5) * f64::from(tile))
}

/// Returns the point of the square at the centre of a texel.
pub fn texel_centre(texel: [u32; 2], tile: u32) -> Vec2 {
    texel.map(|x| (f64::from(x) + 0.5) * (2.0 / f64::from(tile)) - 1.0)
}

/// Returns whether any of a texel is in the disc.
pub fn texel_in_hemisphere(texel: [u32; 2], tile: u32) -> bool {
    let nearest = texel_centre(texel, tile).map(|x| (x.abs() - 1.0 / f64::from(tile)).max(0.0));
    nearest[0] * nearest[0] + nearest[1] * nearest[1] < 1.0
}

/// Returns whether a point in the light's frame is an occluder and not the light's own surface.
pub fn above_horizon(local: Vec3, extent: f64) -> bool {
    local[2] > 1e-3 * dot(local, local).sqrt() + 1e-6 * extent
}
