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

use build::{Item, TRAVERSAL_COST};
use glam::{Vec2, Vec3};
use gpu_data::{Bounds, BvhItem, Child, Kind};

/// Size of the traversal stack. No tree is built that needs more: median splits over [`MOST_TRIANGLES`] need 42.
pub const STACK: usize = gpu_data::BVH_STACK as usize;

/// The greatest number of triangles of a [`Bvh`], which has fewer nodes than triangles.
pub const MOST_TRIANGLES: usize = Child::END as usize / 2;

/// Size of a triangle in [`Bvh::bytes`], in bytes. Nodes come on top.
pub const TRIANGLE_BYTES: u64 = size_of::<BvhItem>() as u64;

/// The margin of boxes around their triangles, in units of the farthest coordinate of the scene: for
/// rays that lie in the plane of a side, one spacing of floats; for the origin of a node's boxes, which is
/// rounded, half of one; and for its distance along a ray, to which multiples of the unit are added, up to
/// three.
const PADDING: f32 = 5.0 * f32::EPSILON;

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
    /// The items by their places: the root first, children after their parents.
    places: Vec<Item>,
    /// The nodes and triangles at these places.
    items: Vec<BvhItem>,
    stack: usize,
    cost: f64,
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
        let triangles = (0..count as u32).map(|index| triangle(positions, indices, index).bounds());
        let mut bounds: Vec<Bounds> = triangles.collect();
        if bounds.is_empty() {
            // A triangle that does not exist: it cannot be hit.
            bounds.push(triangle(positions, indices, 0).bounds());
        }
        let build::Tree { items: places, stack } = build::tree(&bounds, STACK);
        let items = vec![bytemuck::Zeroable::zeroed(); places.len()];
        let mut bvh = Bvh { places, items, stack, cost: 0.0, built_cost: 0.0 };
        bvh.fit(positions, indices);
        bvh.built_cost = bvh.cost;
        bvh
    }

    /// Updates the tree after vertices have moved; the indices must be those of [`Bvh::build`]. Rebuilds the
    /// tree if its cost has grown by more than [`REBUILD_FACTOR`].
    pub fn refit(&mut self, positions: &[[f32; 3]], indices: &[u32]) -> Refit {
        self.fit(positions, indices);
        if self.cost <= self.built_cost * REBUILD_FACTOR {
            return Refit::Refitted;
        }
        *self = Bvh::build(positions, indices);
        Refit::Rebuilt
    }

    /// Computes triangles, boxes and the cost, from the leaves up.
    fn fit(&mut self, positions: &[[f32; 3]], indices: &[u32]) {
        let mut bounds = vec![Bounds::EMPTY; self.items.len()];
        for ((place, item), bounds) in self.places.iter().zip(&mut self.items).zip(&mut bounds) {
            if let Item::Triangle(index) = place {
                *item = triangle(positions, indices, *index);
                *bounds = item.bounds();
            }
        }
        let whole = Bounds::around(bounds.iter().copied());
        let pad = whole.low.abs().max(whole.high.abs()).max_element() * PADDING;
        let whole = whole.half_area();
        let part = |bounds: &Bounds| if whole > 0.0 { bounds.half_area() / whole } else { 1.0 };
        let node = f64::from(TRAVERSAL_COST);
        self.cost = node;
        for (index, place) in self.places.iter().enumerate().rev() {
            let Item::Node(children) = place else { continue };
            let items = children.items();
            let boxes = items.clone().map(|range| Bounds::around(bounds[range].iter().copied()));
            bounds[index] = Bounds::around(boxes);
            self.items[index] = BvhItem::node(*children, &boxes, pad);
            for ((kind, items), bounds) in children.kinds.iter().zip(items).zip(&boxes) {
                let work = if *kind == Kind::NODE { node } else { items.len() as f64 };
                self.cost += if work > 0.0 { work * part(bounds) } else { 0.0 };
            }
        }
    }

    /// Returns the expected cost of a ray by the surface area heuristic, in units of a ray-triangle test.
    pub fn cost(&self) -> f64 {
        self.cost
    }

    /// Returns the size of the stack that a traversal needs: at most [`STACK`].
    pub fn stack(&self) -> usize {
        self.stack
    }

    /// Returns the nodes and triangles in the layout of `scene_bvh` in shaders/bvh.wgsl.
    pub fn bytes(&self) -> &[u8] {
        bytemuck::cast_slice(&self.items)
    }
}

fn triangle(positions: &[[f32; 3]], indices: &[u32], index: u32) -> BvhItem {
    let corner = |k: usize| {
        let vertex = indices.get(index as usize * 3 + k).and_then(|vertex| positions.get(*vertex as usize));
        vertex.map_or(Vec3::NAN, |position| Vec3::from(*position))
    };
    BvhItem::triangle(index, [corner(0), corner(1), corner(2)])
}
