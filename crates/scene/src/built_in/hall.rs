//! A hall of flat walls with two rows of pillars, divided into as many triangles as asked for: the same surfaces
//! at any number, so that pictures are alike and only the cost differs. 12 m × 8 m × 4 m.

use glam::Vec3;

use super::builder::{Builder, MaterialId};
use crate::material::Material;
use crate::model::Model;

/// Half its size along x and z, and its height \[m\].
const SIZE: Vec3 = Vec3::new(6.0, 4.0, 4.0);
/// Half the width of a pillar \[m\].
const PILLAR: f32 = 0.25;
/// Pillars of a row, and the distance between them along x \[m\].
const PILLARS: usize = 5;
const GAP: f32 = 2.0;

/// Returns the hall of 1024 · `pieces`² triangles: 512 cells, of 1 m × 1 m on its walls and ½ m × 1 m on its
/// pillars, each in `pieces` × `pieces` quads.
pub(super) fn hall(pieces: usize) -> Model {
    let mut builder = Builder::default();
    let mut matte = |name, albedo| builder.material(Material::matte(name, albedo));
    let [floor, plaster, stone] = [
        matte("floor", [0.42, 0.38, 0.34]),
        matte("plaster", [0.72, 0.68, 0.62]),
        matte("stone", [0.60, 0.54, 0.46]),
    ];
    let [red, green] = [matte("red", [0.62, 0.08, 0.06]), matte("green", [0.12, 0.42, 0.14])];
    let (x, z) = (Vec3::X * (2.0 * SIZE.x), Vec3::Z * (2.0 * SIZE.y));
    let up = Vec3::Y * SIZE.z;
    let corner = Vec3::new(-SIZE.x, 0.0, -SIZE.y);
    let mut wall =
        |material, corner, along: [Vec3; 2]| rectangle(&mut builder, material, corner, along, pieces);
    wall(floor, corner, [z, x]);
    wall(plaster, corner + up, [x, z]);
    wall(plaster, corner, [x, up]);
    wall(plaster, corner + z, [up, x]);
    wall(red, corner, [up, z]);
    wall(green, corner + x, [z, up]);
    for row in [-0.5 * SIZE.y, 0.5 * SIZE.y] {
        for number in 0..PILLARS {
            let middle = (number as f32 - 0.5 * (PILLARS - 1) as f32) * GAP;
            pillar(&mut builder, stone, Vec3::new(middle, 0.0, row), pieces);
        }
    }
    builder.finish("hall")
}

/// Adds the four sides of a pillar, from floor to ceiling.
fn pillar(builder: &mut Builder, material: MaterialId, foot: Vec3, pieces: usize) {
    let up = Vec3::Y * SIZE.z;
    for out in [Vec3::X, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Z] {
        let along = up.normalize().cross(out);
        let corner = foot + (out - along) * PILLAR;
        rectangle(builder, material, corner, [along * (2.0 * PILLAR), up], pieces);
    }
}

/// Adds a rectangle from a corner along two edges, in cells of at most 1 m, each of `pieces` × `pieces` quads. It
/// faces along the cross product of the edges.
fn rectangle(
    builder: &mut Builder,
    material: MaterialId,
    corner: Vec3,
    [along, across]: [Vec3; 2],
    pieces: usize,
) {
    let [columns, rows] = [along, across].map(|edge| edge.length().ceil() as usize * pieces);
    let normal = along.cross(across);
    builder.surface(material, columns, rows, |u, v| (corner + along * u + across * v, normal));
}
