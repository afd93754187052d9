//! Nodes and triangles in the layouts of `shaders/bvh.wgsl`.

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3, Vec4};
use shader_library::{StructLayout, struct_layout};

/// The index that stands for no triangle: `NO_HIT` of shaders/ray-tracing.wgsl.
pub(crate) const NO_HIT: u32 = u32::MAX;

/// `BvhNode` of shaders/bvh.wgsl: the boxes of four children; each vector holds one coordinate of all
/// four.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct BvhNode {
    pub(crate) low_x: Vec4,
    pub(crate) low_y: Vec4,
    pub(crate) low_z: Vec4,
    pub(crate) high_x: Vec4,
    pub(crate) high_y: Vec4,
    pub(crate) high_z: Vec4,
    pub(crate) children: [Child; 4],
}

/// `BvhTriangle` of shaders/bvh.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct BvhTriangle {
    pub(crate) a: Vec3,
    /// Index of the triangle, or `NO_HIT` if it cannot be hit.
    pub(crate) index: u32,
    pub(crate) b: Vec3,
    pub(crate) pad0: u32,
    pub(crate) c: Vec3,
    pub(crate) pad1: u32,
}

/// Returns the layouts of the structs that are shared with shaders.
pub fn layouts() -> Vec<StructLayout> {
    vec![
        struct_layout!(BvhNode {
            low_x: "vec4<f32>",
            low_y: "vec4<f32>",
            low_z: "vec4<f32>",
            high_x: "vec4<f32>",
            high_y: "vec4<f32>",
            high_z: "vec4<f32>",
            children: "vec4<u32>",
        }),
        struct_layout!(BvhTriangle {
            a: "vec3<f32>",
            index: "u32",
            b: "vec3<f32>",
            pad0: "u32",
            c: "vec3<f32>",
            pad1: "u32",
        }),
    ]
}

impl BvhTriangle {
    /// A triangle that cannot be hit, for an empty tree.
    pub(crate) const NONE: BvhTriangle =
        BvhTriangle { a: Vec3::ZERO, index: NO_HIT, b: Vec3::ZERO, pad0: 0, c: Vec3::ZERO, pad1: 0 };

    /// Creates the triangle with this index. It cannot be hit if its area is zero (tested exactly: products
    /// of differences of `f32` are exact in `f64`) or a vertex is not finite.
    pub(crate) fn new(index: u32, corners: [Vec3; 3]) -> BvhTriangle {
        let [a, b, c] = corners;
        if !corners.iter().all(|corner| corner.is_finite()) {
            return BvhTriangle::NONE;
        }
        let edge = |to: Vec3| to.as_dvec3() - a.as_dvec3();
        let hit = edge(b).cross(edge(c)) != DVec3::ZERO;
        BvhTriangle { a, index: if hit { index } else { NO_HIT }, b, pad0: 0, c, pad1: 0 }
    }

    pub(crate) fn bounds(&self) -> Bounds {
        Bounds { low: self.a.min(self.b).min(self.c), high: self.a.max(self.b).max(self.c) }
    }
}

/// An axis-aligned bounding box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounds {
    pub(crate) low: Vec3,
    pub(crate) high: Vec3,
}

impl Bounds {
    pub(crate) const EMPTY: Bounds = Bounds { low: Vec3::INFINITY, high: Vec3::NEG_INFINITY };

    pub(crate) fn around(boxes: impl IntoIterator<Item = Bounds>) -> Bounds {
        boxes.into_iter().fold(Bounds::EMPTY, |all, one| Bounds {
            low: all.low.min(one.low),
            high: all.high.max(one.high),
        })
    }

    /// Returns half the surface area.
    pub(crate) fn half_area(&self) -> f64 {
        let size = (self.high - self.low).as_dvec3();
        size.x * size.y + size.y * size.z + size.z * size.x
    }

    pub(crate) fn padded(&self, by: f32) -> Bounds {
        Bounds { low: self.low - by, high: self.high + by }
    }
}

impl BvhNode {
    /// A node without children. The boxes in their place are where no ray comes, and harmless if one did.
    pub(crate) const EMPTY: BvhNode = BvhNode {
        low_x: Vec4::MAX,
        low_y: Vec4::MAX,
        low_z: Vec4::MAX,
        high_x: Vec4::MAX,
        high_y: Vec4::MAX,
        high_z: Vec4::MAX,
        children: [Child::FIRST_TRIANGLE; 4],
    };

    /// Returns the children with their boxes; they are the first of the four.
    pub(crate) fn children(&self) -> impl Iterator<Item = (Child, Bounds)> + '_ {
        (0..4)
            .map(|k| (self.children[k], self.bounds_of(k)))
            .take_while(|(_, bounds)| bounds.low.x < f32::MAX)
    }

    fn bounds_of(&self, k: usize) -> Bounds {
        Bounds {
            low: Vec3::new(self.low_x[k], self.low_y[k], self.low_z[k]),
            high: Vec3::new(self.high_x[k], self.high_y[k], self.high_z[k]),
        }
    }

    /// Returns the box around all children.
    pub(crate) fn bounds(&self) -> Bounds {
        Bounds::around(self.children().map(|(_, bounds)| bounds))
    }

    pub(crate) fn set_bounds(&mut self, k: usize, bounds: Bounds) {
        [self.low_x[k], self.low_y[k], self.low_z[k]] = bounds.low.to_array();
        [self.high_x[k], self.high_y[k], self.high_z[k]] = bounds.high.to_array();
    }
}

/// A reference to a child: the index of a node, or a range of triangles.
#[repr(transparent)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct Child(pub(crate) u32);

impl Child {
    pub(crate) const ROOT: Child = Child(0);
    const FIRST_TRIANGLE: Child = Child(Self::LEAF);
    /// The bit that is set for triangles. Three bits follow with their number minus one, then the index of
    /// the first.
    const LEAF: u32 = 1 << 31;
    const COUNT_SHIFT: u32 = 28;
    /// The greatest number of triangles of a leaf.
    pub(crate) const MOST: u32 = 8;
    /// One more than the greatest index of a first triangle.
    pub(crate) const END: u32 = 1 << Self::COUNT_SHIFT;

    pub(crate) fn triangles(first: u32, count: u32) -> Child {
        debug_assert!((1..=Self::MOST).contains(&count) && first < Self::END, "{count} from {first}");
        Child(Self::LEAF | (count - 1) << Self::COUNT_SHIFT | first)
    }

    /// Returns the triangles of a leaf; `None` for a node.
    pub(crate) fn leaf(self) -> Option<std::ops::Range<usize>> {
        let first = (self.0 & (Self::END - 1)) as usize;
        let count = (self.0 >> Self::COUNT_SHIFT & (Self::MOST - 1)) as usize + 1;
        (self.0 & Self::LEAF != 0).then_some(first..first + count)
    }
}
