//! Shapes: vertices in the space of their mesh, and their deformation and transform to the world.

use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use glam::{Affine3A, Mat3A, Vec3, Vec3A};
use rayon::prelude::*;

use crate::hash::Hash;
use crate::model::{Influences, Mesh, Primitive};

/// With fewer vertices than this, a separate thread does not pay off.
const VERTICES_A_TASK: usize = 8192;

/// The displacement of a vertex by a morph target at weight 1.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
struct Displacement {
    vertex: u32,
    position: Vec3,
    normal: Vec3,
}

/// All vertices of a mesh.
#[derive(Clone, Debug, Default)]
pub(crate) struct Shape {
    positions: Vec<Vec3>,
    /// Unit vectors.
    normals: Vec<Vec3>,
    /// Ranges of vertices in which every three consecutive ones are a flat-shaded triangle.
    faceted: Vec<Range<usize>>,
    /// For each morph target, the vertices that it moves.
    targets: Vec<Vec<Displacement>>,
    influences: Influences,
}

/// The transform and deformation of a shape.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Placement {
    /// Transform from the mesh's space to world space; the identity if joints are used instead.
    pub(crate) world: Affine3A,
    /// Transform from the mesh's space to world space for each joint; empty without a skin.
    pub(crate) joints: Vec<Affine3A>,
    /// Weights of the morph targets.
    pub(crate) weights: Vec<f32>,
}

impl Shape {
    /// Collects the vertices of all primitives, one primitive after the other.
    pub(crate) fn new(mesh: &Mesh) -> Shape {
        let mut shape = Shape::default();
        let count = mesh.primitives.iter().map(|p| p.targets.len()).max().unwrap_or(0);
        shape.targets.resize(count, Vec::new());
        let bound = mesh.primitives.iter().all(Primitive::is_bound);
        for primitive in &mesh.primitives {
            let first = shape.positions.len();
            shape.positions.extend(&primitive.positions);
            shape.normals.extend(&primitive.normals);
            let vertices = primitive.positions.len();
            if primitive.faceted {
                shape.faceted.push(first..first + vertices);
            }
            for (moved, target) in shape.targets.iter_mut().zip(&primitive.targets) {
                let of = |list: &[Vec3], i: usize| list.get(i).copied().unwrap_or(Vec3::ZERO);
                moved.extend((0..vertices).filter_map(|i| {
                    let (position, normal) = (of(&target.positions, i), of(&target.normals, i));
                    let moves = position != Vec3::ZERO || normal != Vec3::ZERO;
                    moves.then_some(Displacement { vertex: (first + i) as u32, position, normal })
                }));
            }
            for vertex in (0..vertices).filter(|_| bound) {
                shape.influences.push(primitive.influences.of(vertex).iter().copied());
            }
        }
        shape
    }

    /// Returns the number of vertices.
    pub(crate) fn len(&self) -> usize {
        self.positions.len()
    }

    /// Returns whether most of the shape is mirrored.
    pub(crate) fn mirrors(&self, placement: &Placement) -> bool {
        if placement.joints.is_empty() {
            return Normals::new(&placement.world).mirrors;
        }
        let mirrored = |vertex: &usize| Normals::new(&self.bent(*vertex, &placement.joints)).mirrors;
        2 * (0..self.len()).filter(mirrored).count() > self.len()
    }

    /// Returns position and unit normal of each vertex in world space. Positions need not be finite. With
    /// `mirrors`, the winding of triangles in world space is opposite to that in the mesh, and normals stay
    /// on the side from which triangles are counter-clockwise.
    pub(crate) fn posed(&self, placement: &Placement, mirrors: bool) -> Vec<(Vec3, Vec3)> {
        let morphed = self.morphed(&placement.weights);
        let (positions, normals) = match &morphed {
            Some((positions, normals)) => (positions, normals),
            None => (&self.positions, &self.normals),
        };
        let place = |world: &Affine3A, cofactors: &Normals, vertex: usize| {
            let position = world.transform_point3(positions[vertex]);
            (position, cofactors.to_world(normals[vertex], mirrors))
        };
        let vertices = (0..self.len()).into_par_iter().with_min_len(VERTICES_A_TASK);
        let mut posed: Vec<(Vec3, Vec3)> = if placement.joints.is_empty() {
            let cofactors = Normals::new(&placement.world);
            vertices.map(|vertex| place(&placement.world, &cofactors, vertex)).collect()
        } else {
            let bent = vertices.map(|vertex| {
                let world = self.bent(vertex, &placement.joints);
                place(&world, &Normals::new(&world), vertex)
            });
            bent.collect()
        };
        // The normal of a rigid triangle needs no correction.
        if morphed.is_some() || !placement.joints.is_empty() {
            for range in &self.faceted {
                posed[range.clone()].chunks_exact_mut(3).for_each(|triangle| facet(triangle, mirrors));
            }
        }
        posed
    }

    /// Returns positions and normals with the morph targets added; `None` if all weights are 0.
    fn morphed(&self, weights: &[f32]) -> Option<(Vec<Vec3>, Vec<Vec3>)> {
        let targets = || self.targets.iter().zip(weights).filter(|(_, weight)| **weight != 0.0);
        targets().next()?;
        let (mut positions, mut normals) = (self.positions.clone(), self.normals.clone());
        for (target, weight) in targets() {
            for displacement in target {
                let vertex = displacement.vertex as usize;
                positions[vertex] += displacement.position * *weight;
                normals[vertex] += displacement.normal * *weight;
            }
        }
        for (normal, base) in normals.iter_mut().zip(&self.normals) {
            *normal = normal.normalize_or(*base);
        }
        Some((positions, normals))
    }

    /// Returns the mean of the transforms of the joints of a vertex, by weight: linear blend skinning.
    fn bent(&self, vertex: usize, joints: &[Affine3A]) -> Affine3A {
        let none = Affine3A { matrix3: Mat3A::ZERO, translation: Vec3A::ZERO };
        self.influences.of(vertex).iter().fold(none, |sum, influence| {
            let joint = &joints[influence.joint as usize];
            Affine3A {
                matrix3: sum.matrix3 + joint.matrix3 * influence.weight,
                translation: sum.translation + joint.translation * influence.weight,
            }
        })
    }

    /// Adds the content of the shape to a hash.
    pub(crate) fn hash(&self, hash: &mut Hash) {
        let Shape { positions, normals, faceted, targets, influences } = self;
        hash.slice(positions);
        hash.slice(normals);
        hash.value(faceted);
        targets.iter().for_each(|target| hash.slice(target));
        influences.hash(hash);
    }
}

/// Sets the normals of a triangle to its own, if it has one.
fn facet(triangle: &mut [(Vec3, Vec3)], mirrors: bool) {
    let [a, b, c] = [0, 1, 2].map(|i| triangle[i].0);
    let sign = if mirrors { -1.0 } else { 1.0 };
    if let Some(normal) = (b - a).cross(c - a).try_normalize() {
        triangle.iter_mut().for_each(|vertex| vertex.1 = normal * sign);
    }
}

/// Returns whether a position is usable in computations: finite, with a finite square.
pub(crate) fn usable(position: Vec3) -> bool {
    position.abs().max_element() < 1e18
}

/// Transforms normals to world space, also for mirrors and non-uniform scales.
struct Normals {
    cofactors: [Vec3; 3],
    /// Whether the transform mirrors.
    mirrors: bool,
}

impl Normals {
    fn new(world: &Affine3A) -> Normals {
        let [x, y, z] = [world.matrix3.x_axis, world.matrix3.y_axis, world.matrix3.z_axis].map(Vec3::from);
        // The matrix of cofactors is det · inverse transpose, and exists even if the inverse does not. The
        // matrix is scaled down before, since the cofactors are products of its entries.
        let scale = x.abs().max(y.abs()).max(z.abs()).max_element().max(f32::MIN_POSITIVE).recip();
        let [x, y, z] = [x, y, z].map(|axis| axis * scale);
        let (yz, zx, xy) = (y.cross(z), z.cross(x), x.cross(y));
        Normals { cofactors: [yz, zx, xy], mirrors: x.dot(yz) < 0.0 }
    }

    /// The cross product of two edges is transformed by the cofactors; `mirrors` reverses it.
    fn to_world(&self, normal: Vec3, mirrors: bool) -> Vec3 {
        let [x, y, z] = self.cofactors;
        let normal = if mirrors { -normal } else { normal };
        (x * normal.x + y * normal.y + z * normal.z).normalize_or(Vec3::Y)
    }
}
