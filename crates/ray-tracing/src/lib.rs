//! Which triangle a ray meets: a bounding volume hierarchy (BVH) in the layout that `shaders/ray-tracing.wgsl`
//! traverses, and its CPU reference on the CPU, which gives the same hits.
//!
//! ```
//! use glam::Vec3;
//! let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0f32]];
//! let bvh = ray_tracing::Bvh::build(&positions, &[0, 1, 2]);
//! let hit = bvh.intersect(Vec3::new(0.25, 0.5, 2.0), Vec3::NEG_Z, 0.0, f32::MAX).unwrap();
//! assert_eq!((hit.distance, hit.triangle, hit.barycentrics.to_array()), (2.0, 0, [0.25, 0.5]));
//! ```
//!
//! Triangles have two sides. The test of Woop, Benthin and Wald 2013 ("Watertight ray/triangle intersection")
//! lets no ray through between triangles that share an edge or a vertex. Triangles without area, or with
//! vertices that are not finite, are never hit.

mod build;
mod gpu_data;
mod traverse;

pub use gpu_data::layouts;

use build::{TRAVERSAL_COST, Tree};
use glam::{Vec2, Vec3};
use gpu_data::{Bounds, BvhNode, BvhTriangle, Child};

/// Children that can wait on a ray's way: `BVH_STACK` of shaders/ray-tracing.wgsl. No tree is built that needs
/// more: one by halves over [`MOST_TRIANGLES`] needs 42.
pub const STACK: usize = 64;

/// Triangles of a [`Bvh`], at most.
pub const MOST_TRIANGLES: usize = Child::END as usize;

/// Bytes of a triangle in [`Bvh::triangles_bytes`].
pub const TRIANGLE_BYTES: u64 = size_of::<BvhTriangle>() as u64;

/// A refitted tree whose cost is more than this times the cost when it was built is rebuilt.
pub const REBUILD_FACTOR: f64 = 1.5;

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Along the ray, in lengths of its direction.
    pub distance: f32,
    /// Index of the triangle: that of its first index over three.
    pub triangle: u32,
    /// Weights of its second and third vertex.
    pub barycentrics: Vec2,
}

/// What [`Bvh::refit`] did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refit {
    /// New boxes for the tree as it was.
    Refitted,
    /// A new tree: nodes may be more or fewer.
    Rebuilt,
}

/// A bounding volume hierarchy over triangles.
#[derive(Clone, Debug)]
pub struct Bvh {
    /// Children behind their parents.
    nodes: Vec<BvhNode>,
    /// In the order of the leaves.
    triangles: Vec<BvhTriangle>,
    /// Their indices, also of those that cannot be hit.
    order: Vec<u32>,
    stack: usize,
    built_cost: f64,
}

impl Bvh {
    /// Builds it over triangles of three indices each into `positions`. An index without a position makes its triangle
    /// one that is never hit.
    ///
    /// # Panics
    /// Over more than [`MOST_TRIANGLES`].
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

    /// Takes the places to which the vertices have moved; the indices are those of [`Bvh::build`]. Builds the
    /// tree again where its cost has grown by more than [`REBUILD_FACTOR`].
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

    /// Boxes from the leaves up.
    fn fit(&mut self) {
        // Rounding of what lies in the plane of a box's side: the spacing of floats at the farthest corner.
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

    /// Returns the cost of a ray by the surface area heuristic, in tests of a triangle.
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

    /// Returns the children that wait on a ray's way, at most: no more than [`STACK`].
    pub fn stack(&self) -> usize {
        self.stack
    }

    /// Returns the nodes as `scene_bvh` of shaders/ray-tracing.wgsl has them.
    pub fn nodes_bytes(&self) -> &[u8] {
        bytemuck::cast_slice(&self.nodes)
    }

    /// Returns the triangles as `scene_bvh_triangles` of shaders/ray-tracing.wgsl has them.
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
