//! The CPU reference in `f64`, with the names of splat.wgsl.

use gpu_algorithms::reference::paraboloid;

use glam::{DVec2, DVec3, UVec2};
use paraboloid::{
    above_horizon, frame_from_normal, paraboloid_density, paraboloid_from_direction, texel_area,
    tile_position,
};

/// The trace of a point in a map: a square of one distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Splat {
    /// Centre in the tile \[px\].
    pub(crate) position: DVec2,
    /// Side \[px\].
    pub(crate) side: f64,
    /// Distance from the light \[m\].
    pub(crate) distance: f64,
}

/// The settings that shape a splat, and the values from the scene.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shape {
    /// Side of a map \[px\].
    pub(crate) tile: u32,
    /// Area that a point stands for \[m²\].
    pub(crate) area: f64,
    /// Diagonal of the scene \[m\].
    pub(crate) extent: f64,
    /// Factor on the side.
    pub(crate) splat_scale: f64,
    /// Greatest side \[px\].
    pub(crate) max_splat: f64,
}

/// Returns the splat of a point, seen from a light with that position and unit normal; `None` behind its plane.
pub(crate) fn splat(
    point: DVec3,
    point_normal: DVec3,
    light: DVec3,
    light_normal: DVec3,
    shape: &Shape,
) -> Option<Splat> {
    let frame = frame_from_normal(light_normal);
    let offset = point - light;
    let local = frame.transpose_mul_vec3(offset);
    if !above_horizon(local, shape.extent) {
        return None;
    }
    let distance = local.length();
    let facing = point_normal.dot(offset).abs() / distance;
    let centre = paraboloid_from_direction(local / distance);
    let texel = paraboloid_density(centre) * texel_area(shape.tile);
    let side = shape.splat_scale * (shape.area * facing / texel).sqrt() / distance;
    Some(Splat {
        position: tile_position(centre, shape.tile),
        side: side.clamp(1.0, shape.max_splat),
        distance,
    })
}

impl Splat {
    /// Returns the texels it covers: from the first to before the second, in x and y.
    pub(crate) fn texels(&self, tile: u32) -> (UVec2, UVec2) {
        let low = (self.position - 0.5 * self.side - 0.5).ceil();
        let high = (self.position + 0.5 * self.side - 0.5).ceil();
        (low.as_uvec2(), high.min(DVec2::splat(f64::from(tile))).as_uvec2())
    }
}

/// Returns a map of these points: row by row the distance \[m\], infinite where nothing fell.
pub(crate) fn map(points: &[(DVec3, DVec3)], light: DVec3, light_normal: DVec3, shape: &Shape) -> Vec<f64> {
    let mut depth = vec![f64::INFINITY; (shape.tile * shape.tile) as usize];
    for (point, normal) in points {
        let Some(splat) = splat(*point, *normal, light, light_normal, shape) else { continue };
        let (low, high) = splat.texels(shape.tile);
        for y in low.y..high.y {
            for x in low.x..high.x {
                let texel = &mut depth[(y * shape.tile + x) as usize];
                *texel = texel.min(splat.distance);
            }
        }
    }
    depth
}
