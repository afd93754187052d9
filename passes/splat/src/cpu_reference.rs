//! The algorithm in plain f64: same names and order as splat.wgsl.

pub use gpu_algorithms::reference::paraboloid;

use paraboloid::{
    Vec2, Vec3, above_horizon, dot, frame_from_normal, into_frame, paraboloid_density,
    paraboloid_from_direction, scale, sub, texel_area, tile_position,
};

/// What a point leaves in a map: a square of one distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Splat {
    /// Centre in the tile \[px\].
    pub position: Vec2,
    /// Side \[px\].
    pub side: f64,
    /// Distance from the light \[m\].
    pub distance: f64,
}

/// The settings that shape a splat, and what the scene gives.
#[derive(Clone, Copy, Debug)]
pub struct Shape {
    /// Side of a map \[px\].
    pub tile: u32,
    /// Area that a point stands for \[m²\].
    pub area: f64,
    /// Diagonal of the scene \[m\].
    pub extent: f64,
    /// Factor on the side.
    pub splat_scale: f64,
    /// Greatest side \[px\].
    pub max_splat: f64,
}

/// Returns the splat of a point, seen from a light with that position and unit normal; `None` behind its plane.
pub fn splat(
    point: Vec3,
    point_normal: Vec3,
    light: Vec3,
    light_normal: Vec3,
    shape: &Shape,
) -> Option<Splat> {
    let frame = frame_from_normal(light_normal);
    let offset = sub(point, light);
    let local = into_frame(offset, &frame);
    if !above_horizon(local, shape.extent) {
        return None;
    }
    let distance = dot(local, local).sqrt();
    let facing = dot(point_normal, offset).abs() / distance;
    let centre = paraboloid_from_direction(scale(local, 1.0 / distance));
    let texel = paraboloid_density(centre) * texel_area(shape.tile);
    let side = shape.splat_scale * (shape.area * facing / texel).sqrt() / distance;
    Some(Splat {
        position: tile_position(centre, shape.tile),
        side: side.clamp(1.0, shape.max_splat),
        distance,
    })
}

impl Splat {
    /// Returns the texels it covers: `low[i]..high[i]` for x and y.
    pub fn texels(&self, tile: u32) -> ([u32; 2], [u32; 2]) {
        let low = self.position.map(|x| (x - 0.5 * self.side - 0.5).ceil().max(0.0) as u32);
        let high = self.position.map(|x| (x + 0.5 * self.side - 0.5).ceil().min(f64::from(tile)) as u32);
        (low, high)
    }
}

/// Returns a map of these points: row by row the distance \[m\], infinite where nothing fell.
pub fn map(points: &[(Vec3, Vec3)], light: Vec3, light_normal: Vec3, shape: &Shape) -> Vec<f64> {
    let mut depth = vec![f64::INFINITY; (shape.tile * shape.tile) as usize];
    for (point, normal) in points {
        let Some(splat) = splat(*point, *normal, light, light_normal, shape) else { continue };
        let (low, high) = splat.texels(shape.tile);
        for y in low[1]..high[1] {
            for x in low[0]..high[0] {
                let texel = &mut depth[(y * shape.tile + x) as usize];
                *texel = texel.min(splat.distance);
            }
        }
    }
    depth
}
