// Hemispheres in squares: the paraboloid map (Brabec et al. 2002), and atlases of such maps.
//
// In a light's frame the normal is z. A unit direction d of the hemisphere falls on d.xy / (1 + d.z), a point of
// the unit disc; the disc is inscribed in the square [-1, 1]², which a tile of the atlas covers. x grows with the
// column, y with the row. The CPU reference is
// crates/gpu-algorithms/src/reference/paraboloid.rs.

#import "tangent-frame.wgsl"

/// The distance that an atlas holds where nothing is: more than any other. Finite, because arithmetic with
/// infinity differs between drivers.
const NOTHING: f32 = 3.0e38;

/// Point of the square for a unit direction; within the unit disc where z ≥ 0. Undefined straight down.
fn paraboloid_from_direction(direction: vec3<f32>) -> vec2<f32> {
    return direction.xy / (1.0 + direction.z);
}

/// Unit direction for a point of the square; below the horizon outside the unit disc.
fn direction_from_paraboloid(at: vec2<f32>) -> vec3<f32> {
    let r2 = dot(at, at);
    return vec3(2.0 * at, 1.0 - r2) / (1.0 + r2);
}

/// Solid angle per area of the square [sr]: 4 / (1 + r²)². Over the disc it integrates to 2π.
fn paraboloid_density(at: vec2<f32>) -> f32 {
    let side = 2.0 / (1.0 + dot(at, at));
    return side * side;
}

/// Area of a texel in the square, for tiles of that side [px].
fn texel_area(tile: u32) -> f32 {
    let side = 2.0 / f32(tile);
    return side * side;
}

/// Position in a tile [px] of a point of the square.
fn tile_position(at: vec2<f32>, tile: u32) -> vec2<f32> {
    return (at * 0.5 + 0.5) * f32(tile);
}

/// Point of the square at the centre of a texel.
fn texel_centre(texel: vec2<u32>, tile: u32) -> vec2<f32> {
    return (vec2<f32>(texel) + 0.5) * (2.0 / f32(tile)) - 1.0;
}

/// Whether any of a texel is in the disc. The others are never looked up.
fn texel_in_hemisphere(texel: vec2<u32>, tile: u32) -> bool {
    let nearest = max(abs(texel_centre(texel, tile)) - 1.0 / f32(tile), vec2(0.0));
    return dot(nearest, nearest) < 1.0;
}

/// The light's own surface lies in its plane but for two errors: the light's normal comes from a map of half floats (2⁻¹¹), and
/// positions are rounded to a part of the scene's extent.
const HORIZON_SLOPE: f32 = 1e-3;
const HORIZON_HEIGHT: f32 = 1e-6;

/// Whether a point [m, in the light's frame] is an occluder and not the light's own surface; `extent` is the scene's [m].
fn above_horizon(local: vec3<f32>, extent: f32) -> bool {
    return local.z > HORIZON_SLOPE * length(local) + HORIZON_HEIGHT * extent;
}

/// Returns column, row and layer of the first texel of a light's tile, in an atlas whose layers have these columns and
/// rows of tiles.
fn tile_origin(light: u32, columns: u32, rows: u32, tile: u32) -> vec3<u32> {
    let row = light / columns;
    let layer = row / rows;
    return vec3((light - row * columns) * tile, (row - layer * rows) * tile, layer);
}
