//! Finds the triangle that a ray hits: builds a bounding volume hierarchy (BVH) in the layout that
//! `shaders/bvh.wgsl` traverses, and traverses it on the CPU (the CPU reference of that shader) with
//! the same hits.
//!
//! ```
//! use glam::Vec3;
//! let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0f32]];
//! let bvh = ray_tracing::Bvh::build(&positions, &[0, 1, 2]);
//! let hit = bvh.intersect(Vec3::new(0.25, 0.5, 2.0), Vec3::NEG_Z, 0.0, f32::MAX).unwrap();
//! assert_eq!((hit.distance, hit.triangle, hit.barycentrics.to_array()), (2.0, 0, [0.25, 0.5]));
//! ```
//!
//! Triangles have two sides. The intersection test is that of Woop, Benthin and Wald 2013 ("Watertight
//! ray/triangle intersection"): no ray passes between triangles that share an edge or a vertex. Triangles
//! whose area is zero, or with vertices that are not finite, are never hit.

mod build;
mod gpu_data;
mod traverse;

pub use gpu_data::layouts;

use build::{TRAVERSAL_COST, Tree};
use glam::{Vec2, Vec3};
use gpu_data::{Bounds, BvhNode, BvhTriangle, Child};

/// Size of the traversal stack: `BVH_STACK` of shaders/bvh.wgsl. No tree is built that needs more:
/// median splits over [`MOST_TRIANGLES`] need 42.
pub const STACK: usize = 64;

/// The greatest number of triangles of a [`Bvh`].
pub const MOST_TRIANGLES: usize = Child::END as usize;

/// Size of a triangle in [`Bvh::triangles_bytes`], in bytes.
pub const TRIANGLE_BYTES: u64 = size_of::<BvhTriangle>() as u64;

/// A refitted tree is rebuilt if its cost is more than this times the cost when it was built.
pub const REBUILD_FACTOR: f64 = 1.5;

/// The intersection of a ray with a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance along the ray, in units of the length of its direction.
    pub distance: f32,
    /// Index of the triangle: the position of its first vertex index, divided by three.
    pub triangle: u32,
    /// Barycentric weights of its second and third vertex.
    pub barycentrics: Vec2,
}

/// The result of [`Bvh::refit`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refit {
    /// The tree is the same, with new boxes.
    Refitted,
    /// The tree was rebuilt: the number of nodes may differ.
    Rebuilt,
}

/// A bounding volume hierarchy over triangles.
#[derive(Clone, Debug)]
pub struct Bvh {
    /// The nodes, with children after their parents.
    nodes: Vec<BvhNode>,
    /// The triangles, in the order of the leaves.
    triangles: Vec<BvhTriangle>,
    /// The indices of the triangles, including those that cannot be hit.
    order: Vec<u32>,
    stack: usize,
    built_cost: f64,
}

impl Bvh {
    /// Builds a tree over triangles, each given by three indices into `positions`. A triangle with an index
    /// out of range is never hit.
    ///
    /// # Panics
    /// Panics for more than [`MOST_TRIANGLES`].
    pub fn build(positions: &[[f32; 3]], indices: &[u32]) -> Bvh {
        let count = indices.len() / 3;
        assert!(count <= MOST_TRIANGLES, "{count} triangles; a hierarchy takes {MOST_TRIANGLES}");
        let mut triangles: Vec<BvhTriangle> =
            (0..count as u32).map(|index| triangle(positions, indices, index)).collect();
        if triangles.is_empty() {
            triangles.push(BvhTriangle::NONE);
        }
        let Tree { nodes, order, stack } = build::tree(&triangles, STACK);
        let triangles = order.iter().map(|index| triangles[*index as usize]).collect();
        let mut bvh = Bvh { nodes, triangles, order, stack, built_cost: 0.0 };
        bvh.fit();
        bvh.built_cost = bvh.cost();
        bvh
    }

    /// Updates the tree after vertices have moved; the indices must be those of [`Bvh::build`]. Rebuilds the
    /// tree if its cost has grown by more than [`REBUILD_FACTOR`].
    pub fn refit(&mut self, positions: &[[f32; 3]], indices: &[u32]) -> Refit {
        for (place, index) in self.triangles.iter_mut().zip(&self.order) {
            *place = triangle(positions, indices, *index);
        }
        self.fit();
        if self.cost() <= self.built_cost * REBUILD_FACTOR {
            return Refit::Refitted;
        }
        *self = Bvh::build(positions, indices);
        Refit::Rebuilt
    }

    /// Computes the boxes from the leaves up.
    fn fit(&mut self) {
        // Boxes are padded for rounding of rays that lie in the plane of a side: by the spacing of floats at
        // the farthest corner.
        let whole = Bounds::around(self.triangles.iter().map(BvhTriangle::bounds));
        let pad = whole.low.abs().max(whole.high.abs()).max_element() * f32::EPSILON;
        for index in (0..self.nodes.len()).rev() {
            for k in 0..self.nodes[index].children().count() {
                let child = self.nodes[index].children[k];
                let bounds = match child.leaf() {
                    Some(run) => {
                        Bounds::around(self.triangles[run].iter().map(BvhTriangle::bounds)).padded(pad)
                    }
                    None => self.nodes[child.0 as usize].bounds(),
                };
                self.nodes[index].set_bounds(k, bounds);
            }
        }
    }

    /// Returns the expected cost of a ray by the surface area heuristic, in units of a ray-triangle test.
    pub fn cost(&self) -> f64 {
        let whole = self.nodes[0].bounds().half_area();
        let node = f64::from(TRAVERSAL_COST);
        let mut cost = node;
        for (child, bounds) in self.nodes.iter().flat_map(BvhNode::children) {
            let work = child.leaf().map_or(node, |run| run.len() as f64);
            cost += if whole > 0.0 { work * bounds.half_area() / whole } else { work };
        }
        cost
    }

    /// Returns the size of the stack that a traversal needs: at most [`STACK`].
    pub fn stack(&self) -> usize {
        self.stack
    }

    /// Returns the nodes in the layout of `scene_bvh` in shaders/bvh.wgsl.
    pub fn nodes_bytes(&self) -> &[u8] {
        bytemuck::cast_slice(&self.nodes)
    }

    /// Returns the triangles in the layout of `scene_bvh_triangles` in shaders/bvh.wgsl.
    pub fn triangles_bytes(&self) -> &[u8] {
        bytemuck::cast_slice(&self.triangles)
    }
}

fn triangle(positions: &[[f32; 3]], indices: &[u32], index: u32) -> BvhTriangle {
    let corner = |k: usize| {
        let vertex = indices.get(index as usize * 3 + k).and_then(|vertex| positions.get(*vertex as usize));
        vertex.map_or(Vec3::NAN, |position| Vec3::from(*position))
    };
    BvhTriangle::new(index, [corner(0), corner(1), corner(2)])
}
