//! The tools of the generators: quads and surfaces, collected by material.

use glam::{Quat, Vec2, Vec3};

use crate::material::Material;
use crate::model::{Mesh, Model, Node, Primitive};

/// Index of a material.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) struct MaterialId(u32);

/// Geometry that is being built: one node with one mesh, which has one primitive per material.
#[derive(Default)]
pub(super) struct Builder {
    materials: Vec<Material>,
    primitives: Vec<Primitive>,
}

impl Builder {
    pub(super) fn material(&mut self, material: Material) -> MaterialId {
        let id = self.materials.len() as u32;
        self.materials.push(material);
        self.primitives.push(Primitive { material: id, ..Primitive::default() });
        MaterialId(id)
    }

    /// Adds a flat quad; its corners are counter-clockwise seen from the side it faces.
    pub(super) fn quad(&mut self, material: MaterialId, corners: [Vec3; 4]) {
        // Computed from both diagonals, so that a quad with two corners at the same point still has a normal.
        let normal = (corners[2] - corners[0]).cross(corners[3] - corners[1]).normalize_or(Vec3::Y);
        self.smooth_quad(material, corners, [normal; 4]);
    }

    /// Adds a flat quad whose texture repeats that often along its first and its second edge.
    pub(super) fn tiled_quad(&mut self, material: MaterialId, corners: [Vec3; 4], repeats: Vec2) {
        self.quad(material, corners);
        let uvs = &mut self.primitives[material.0 as usize].uvs;
        let first = uvs.len() - corners.len();
        uvs[first..].iter_mut().for_each(|uv| *uv *= repeats);
    }

    /// Adds a quad with a normal at each corner.
    pub(super) fn smooth_quad(&mut self, material: MaterialId, corners: [Vec3; 4], normals: [Vec3; 4]) {
        let uvs = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
        let primitive = &mut self.primitives[material.0 as usize];
        let first = primitive.positions.len() as u32;
        primitive.positions.extend(corners);
        primitive.normals.extend(normals);
        primitive.uvs.extend(uvs);
        for [a, b, c] in [[0, 1, 2], [0, 2, 3]] {
            let [p, q, r] = [corners[a], corners[b], corners[c]];
            if (q - p).cross(r - p) != Vec3::ZERO {
                primitive.indices.extend([a, b, c].map(|i| first + i as u32));
            }
        }
    }

    /// Adds a box with its faces outwards.
    pub(super) fn cuboid(&mut self, material: MaterialId, min: Vec3, max: Vec3) {
        self.faces(material, |x, y, z| Vec3::new([min.x, max.x][x], [min.y, max.y][y], [min.z, max.z][z]));
    }

    /// Adds a box with these half sides, turned about its middle.
    pub(super) fn turned_cuboid(&mut self, material: MaterialId, middle: Vec3, half: Vec3, turn: Quat) {
        let side = |x: usize, y: usize, z: usize| Vec3::new(x as f32, y as f32, z as f32) * 2.0 - 1.0;
        self.faces(material, |x, y, z| middle + turn * (side(x, y, z) * half));
    }

    /// Adds the faces of a box, whose corners are low or high along each axis.
    fn faces(&mut self, material: MaterialId, c: impl Fn(usize, usize, usize) -> Vec3) {
        self.quad(material, [c(0, 0, 1), c(1, 0, 1), c(1, 1, 1), c(0, 1, 1)]);
        self.quad(material, [c(1, 0, 0), c(0, 0, 0), c(0, 1, 0), c(1, 1, 0)]);
        self.quad(material, [c(1, 0, 1), c(1, 0, 0), c(1, 1, 0), c(1, 1, 1)]);
        self.quad(material, [c(0, 0, 0), c(0, 0, 1), c(0, 1, 1), c(0, 1, 0)]);
        self.quad(material, [c(0, 1, 1), c(1, 1, 1), c(1, 1, 0), c(0, 1, 0)]);
        self.quad(material, [c(0, 0, 0), c(1, 0, 0), c(1, 0, 1), c(0, 0, 1)]);
    }

    /// Adds a smooth surface over a grid of `columns`×`rows` cells: `point` returns position and normal for
    /// (u, v) in 0..=1 each. The normal determines which side is the outer one.
    pub(super) fn surface(
        &mut self,
        material: MaterialId,
        columns: usize,
        rows: usize,
        point: impl Fn(f32, f32) -> (Vec3, Vec3),
    ) {
        let primitive = &mut self.primitives[material.0 as usize];
        let first = primitive.positions.len() as u32;
        for row in 0..=rows {
            for column in 0..=columns {
                let uv = Vec2::new(column as f32 / columns as f32, row as f32 / rows as f32);
                let (position, normal) = point(uv.x, uv.y);
                primitive.positions.push(position);
                primitive.normals.push(normal.normalize_or(Vec3::Y));
                primitive.uvs.push(uv);
            }
        }
        let at = |column: usize, row: usize| first + (row * (columns + 1) + column) as u32;
        for row in 0..rows {
            for column in 0..columns {
                let [a, b] = [at(column, row), at(column + 1, row)];
                let [c, d] = [at(column + 1, row + 1), at(column, row + 1)];
                // The diagonals of the four quarters meet in the middle, so that the creases of a groin
                // vault, which run along the diagonals of its bay, are edges.
                let rising = (column < columns / 2) == (row < rows / 2);
                let pair = if rising { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
                for [i, j, k] in pair {
                    let [p, q, r] = [i, j, k].map(|i| primitive.positions[i as usize]);
                    let [n, m, o] = [i, j, k].map(|i| primitive.normals[i as usize]);
                    let facing = (q - p).cross(r - p).dot(n + m + o);
                    if facing > 0.0 {
                        primitive.indices.extend([i, j, k]);
                    } else if facing < 0.0 {
                        primitive.indices.extend([i, k, j]);
                    }
                }
            }
        }
    }

    /// Adds a surface of revolution around the vertical axis through `foot`: its outline is points of
    /// (radius, height), going up, joined by straight lines; `sides` quads around.
    pub(super) fn lathe(&mut self, material: MaterialId, foot: Vec3, outline: &[[f32; 2]], sides: usize) {
        for pair in outline.windows(2) {
            let [[r0, y0], [r1, y1]] = [pair[0], pair[1]];
            let slope = Vec2::new(y1 - y0, r0 - r1);
            self.surface(material, sides, 1, |u, v| {
                // The two ends of the seam must be bitwise the same point.
                let angle = if u == 1.0 { 0.0 } else { u * std::f32::consts::TAU };
                let (sin, cos) = angle.sin_cos();
                let (radius, height) = (r0 + (r1 - r0) * v, y0 + (y1 - y0) * v);
                (
                    foot + Vec3::new(radius * cos, height, radius * sin),
                    Vec3::new(slope.x * cos, slope.y, slope.x * sin),
                )
            });
        }
    }

    /// Returns the model, with one node of this name.
    pub(super) fn finish(self, name: &str) -> Model {
        let mut primitives = self.primitives;
        primitives.retain(|primitive| !primitive.indices.is_empty());
        Model {
            materials: self.materials,
            meshes: vec![Mesh { name: name.into(), primitives }],
            nodes: vec![Node { name: name.into(), mesh: Some(0), ..Node::default() }],
            ..Model::default()
        }
    }
}
