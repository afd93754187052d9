//! Nodes and triangles in the layout of `shaders/bvh.wgsl`.

use glam::{DVec3, Vec3, Vec4};
use std::ops::Range;

wgsl_structs::wgsl! {
    "../../shaders/bvh.wgsl" {
        pub(crate) struct BvhItem;
        pub(crate) const BVH_STACK;
    }
    "../../shaders/ray-tracing.wgsl" {
        pub(crate) const NO_HIT;
    }
    pub fn layouts;
}

/// Triangles.
impl BvhItem {
    /// A triangle that cannot be hit.
    const NO_TRIANGLE: BvhItem = BvhItem { a: [0, 0, 0, NO_HIT], b: [0; 4], c: [0; 4] };

    /// Creates the triangle with this index. It cannot be hit if its area is zero (tested exactly: products
    /// of differences of `f32` are exact in `f64`) or a vertex is not finite.
    pub(crate) fn triangle(index: u32, corners: [Vec3; 3]) -> BvhItem {
        if !corners.iter().all(|corner| corner.is_finite()) {
            return BvhItem::NO_TRIANGLE;
        }
        let [a, b, c] = corners;
        let edge = |to: Vec3| to.as_dvec3() - a.as_dvec3();
        let hit = edge(b).cross(edge(c)) != DVec3::ZERO;
        let row = |v: Vec3, last: u32| [v.x.to_bits(), v.y.to_bits(), v.z.to_bits(), last];
        BvhItem { a: row(a, if hit { index } else { NO_HIT }), b: row(b, 0), c: row(c, 0) }
    }

    /// Returns the vertices of a triangle.
    pub(crate) fn corners(&self) -> [Vec3; 3] {
        [self.a, self.b, self.c].map(first_three)
    }

    /// Returns the index of a triangle, or `NO_HIT` if it cannot be hit.
    pub(crate) fn index(&self) -> u32 {
        self.a[3]
    }

    /// Returns the bounding box of a triangle.
    pub(crate) fn bounds(&self) -> Bounds {
        let [a, b, c] = self.corners();
        Bounds { low: a.min(b).min(c), high: a.max(b).max(c) }
    }
}

/// Nodes.
impl BvhItem {
    /// Creates a node from its children and their boxes. The boxes in bytes contain those given, padded.
    pub(crate) fn node(children: Children, boxes: &[Bounds; 4], pad: f32) -> BvhItem {
        let whole = Bounds::around(boxes.iter().copied());
        let origin = (whole.low - pad).max(Vec3::MIN);
        let mut exponents = [0; 4];
        let (mut low, mut high) = ([[0; 4]; 3], [[0; 4]; 3]);
        for axis in 0..3 {
            let at =
                |coordinate: f32, pad: f32| f64::from(coordinate) + f64::from(pad) - f64::from(origin[axis]);
            exponents[axis] = exponent(at(whole.high[axis], pad));
            let step = f64::from(power(u32::from(exponents[axis])));
            for (k, _) in children.kinds.iter().enumerate().filter(|(_, kind)| **kind != Kind::NONE) {
                low[axis][k] = (at(boxes[k].low[axis], -pad) / step).floor() as u8;
                high[axis][k] = (at(boxes[k].high[axis], pad) / step).ceil() as u8;
            }
        }
        let word = u32::from_le_bytes;
        let kinds = word(children.kinds.map(|kind| kind.0));
        BvhItem {
            a: [origin.x.to_bits(), origin.y.to_bits(), origin.z.to_bits(), word(exponents)],
            b: [word(low[0]), word(low[1]), word(low[2]), word(high[0])],
            c: [word(high[1]), word(high[2]), children.first, kinds],
        }
    }

    /// Returns the origin of the boxes of a node.
    pub(crate) fn origin(&self) -> Vec3 {
        first_three(self.a)
    }

    /// Returns the unit of the coordinates of boxes along each axis.
    pub(crate) fn scale(&self) -> Vec3 {
        let [x, y, z, _] = self.a[3].to_le_bytes();
        Vec3::new(power(u32::from(x)), power(u32::from(y)), power(u32::from(z)))
    }

    /// Returns the low and the high coordinates of the four boxes along each axis, in units of
    /// [`scale`](Self::scale) from [`origin`](Self::origin).
    pub(crate) fn boxes(&self) -> [(Vec4, Vec4); 3] {
        let four = |word: u32| Vec4::from_array(word.to_le_bytes().map(f32::from));
        let (b, c) = (self.b.map(four), self.c.map(four));
        [(b[0], b[3]), (b[1], c[0]), (b[2], c[1])]
    }

    /// Returns the children of a node.
    pub(crate) fn children(&self) -> Children {
        Children { first: self.c[2], kinds: self.c[3].to_le_bytes().map(Kind) }
    }
}

fn first_three(row: [u32; 4]) -> Vec3 {
    Vec3::new(f32::from_bits(row[0]), f32::from_bits(row[1]), f32::from_bits(row[2]))
}

/// Returns the power of two with this exponent, biased as in `f32`.
fn power(exponent: u32) -> f32 {
    f32::from_bits(exponent << 23)
}

/// Returns the exponent of the least power of two of which 255 make up an extent, biased as in `f32`.
fn exponent(extent: f64) -> u8 {
    let about = (extent / 255.0).log2().ceil().clamp(-126.0, 127.0) as i32;
    // Logarithms are rounded.
    let enough = (255.0 * 2.0_f64.powi(about) >= extent) as i32;
    (about + 128 - enough).min(254) as u8
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
}

/// The children of a node: their items follow each other, in the order of the children.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Children {
    /// Index of the first item.
    pub(crate) first: u32,
    pub(crate) kinds: [Kind; 4],
}

impl Children {
    /// Returns each child; for none, no more than a number.
    pub(crate) fn each(&self) -> [Child; 4] {
        let mut first = self.first;
        self.kinds.map(|kind| {
            let child = Child(u32::from(kind.0) << 24 & Child::FLAGS | first);
            first += u32::from(kind.0 & Kind::ITEMS);
            child
        })
    }

    /// Returns the items of each child; an empty range for none.
    pub(crate) fn items(&self) -> [Range<usize>; 4] {
        let mut first = self.first as usize;
        self.kinds.map(|kind| {
            let range = first..first + usize::from(kind.0 & Kind::ITEMS);
            first = range.end;
            range
        })
    }
}

/// The type of a child: in the low four bits, the number of its items; in the high four, those of a [`Child`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Kind(pub(crate) u8);

impl Kind {
    pub(crate) const NONE: Kind = Kind(0);
    pub(crate) const NODE: Kind = Kind(1);
    const ITEMS: u8 = 15;
    /// The greatest number of triangles of a leaf.
    pub(crate) const MOST: u8 = 8;

    pub(crate) fn triangles(count: usize) -> Kind {
        debug_assert!((1..=usize::from(Self::MOST)).contains(&count), "{count} triangles");
        Kind(0x80 | (count as u8 - 1) << 4 | count as u8)
    }
}

/// A child that a ray visits: the index of an item. If it is a triangle, the highest bit is set, and the next three
/// have the number of triangles that follow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Child(u32);

impl Child {
    pub(crate) const ROOT: Child = Child(0);
    const FLAGS: u32 = 0xf000_0000;
    const TRIANGLE: u32 = 1 << 31;
    /// One more than the greatest index of an item.
    pub(crate) const END: u32 = 1 << 28;

    pub(crate) fn item(self) -> usize {
        (self.0 & !Self::FLAGS) as usize
    }

    pub(crate) fn is_triangle(self) -> bool {
        self.0 & Self::TRIANGLE != 0
    }

    /// Returns the triangle that follows, if there is one.
    pub(crate) fn next(self) -> Option<Child> {
        let more = self.0 & (Self::FLAGS ^ Self::TRIANGLE) != 0;
        // One item on, of which one fewer follow.
        more.then(|| Child(self.0 + 1 - Self::END))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Boxes of four sizes, from a point to a thousand units, about places near and far.
    fn boxes(center: Vec3, scale: f32) -> [Bounds; 4] {
        [0.0, 0.01, 1.0, 1000.0].map(|size| {
            let low = (center + Vec3::new(0.3, -0.7, 0.1) * size) * scale;
            Bounds { low, high: low + Vec3::new(size, 0.0, size * 0.37) * scale }
        })
    }

    #[test]
    fn boxes_in_bytes_contain_those_given() {
        let kinds = [Kind::triangles(3), Kind::NODE, Kind::triangles(1), Kind::NODE];
        for center in [Vec3::ZERO, Vec3::new(1e4, -3e5, 7.7), Vec3::splat(-1e6)] {
            for scale in [1e-20, 1e-3, 1.0, 1e9] {
                let given = boxes(center, scale);
                let pad = given[3].high.abs().max(given[3].low.abs()).max_element() * f32::EPSILON;
                let node = BvhItem::node(Children { first: 7, kinds }, &given, pad);
                let whole = Bounds::around(given);
                for (axis, (low, high)) in node.boxes().into_iter().enumerate() {
                    // Products with powers of two are exact, and in f64 the sums too.
                    let (origin, unit) = (f64::from(node.origin()[axis]), f64::from(node.scale()[axis]));
                    for (k, bounds) in given.iter().enumerate() {
                        let low = origin + f64::from(low[k]) * unit;
                        let high = origin + f64::from(high[k]) * unit;
                        let (inside, outside) = (f64::from(bounds.low[axis]), f64::from(bounds.high[axis]));
                        assert!(
                            low <= inside && outside <= high,
                            "box {k} about {center} × {scale}: {node:?}"
                        );
                    }
                    let extent = f64::from(whole.high[axis]) - f64::from(whole.low[axis]);
                    let least = 2.0 * (extent + 3.0 * f64::from(pad));
                    assert!(unit * 255.0 <= least, "a smaller unit would do: {node:?}");
                }
            }
        }
    }

    #[test]
    fn children_follow_each_other() {
        let kinds = [Kind::NODE, Kind::triangles(3), Kind::NONE, Kind::triangles(1)];
        let children = Children { first: 5, kinds };
        assert_eq!(children.items(), [5..6, 6..9, 9..9, 9..10]);
        let [node, three, _, one] = children.each();
        assert!(!node.is_triangle() && node.item() == 5);
        let run: Vec<usize> =
            std::iter::successors(Some(three), |child| child.next()).map(Child::item).collect();
        assert_eq!(run, [6, 7, 8]);
        assert_eq!((one.item(), one.next()), (9, None));
    }
}
