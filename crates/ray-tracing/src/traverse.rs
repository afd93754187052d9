//! Traverses the tree: the CPU reference of `shaders/bvh.wgsl`, with the same steps in the same
//! order.

use crate::gpu_data::{BvhItem, Child, Kind, NO_HIT};
use crate::{Bvh, Hit, STACK};
use glam::{Mat3, Vec2, Vec3, Vec4};

/// Values of a ray that the tests of boxes and triangles need.
struct Ray {
    origin: Vec3,
    inverse: Vec3,
    /// Transforms a vertex, relative to the origin, to a space in which the ray is the z axis, with the
    /// length of its direction as unit.
    shear: Mat3,
}

impl Ray {
    fn new(origin: Vec3, direction: Vec3) -> Ray {
        let size = direction.abs();
        let least = size.max_element() * 1e-12;
        let away = |d: f32| if d.abs() >= least { d } else { least.copysign(d) };
        let inverse = 1.0 / Vec3::new(away(direction.x), away(direction.y), away(direction.z));
        // Woop et al. 2013, §3: the longest axis becomes z; the other two are sheared.
        let d = direction;
        let shear = if size.x >= size.y && size.x >= size.z {
            Mat3::from_cols_array(&[-d.y / d.x, -d.z / d.x, 1.0 / d.x, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0])
        } else if size.y >= size.z {
            Mat3::from_cols_array(&[0.0, 1.0, 0.0, -d.z / d.y, -d.x / d.y, 1.0 / d.y, 1.0, 0.0, 0.0])
        } else {
            Mat3::from_cols_array(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, -d.x / d.z, -d.y / d.z, 1.0 / d.z])
        };
        Ray { origin, inverse, shear }
    }

    /// Returns where the ray enters the boxes of each of four children, at least `nearest`; `MISS` if it
    /// does not before `farthest`.
    fn enter(&self, node: &BvhItem, nearest: f32, farthest: f32) -> Vec4 {
        let start = (node.origin() - self.origin) * self.inverse;
        let step = node.scale() * self.inverse;
        let (mut first, mut last) = (Vec4::splat(nearest), Vec4::MAX);
        for (axis, (low, high)) in node.boxes().into_iter().enumerate() {
            let (near, far) = if self.inverse[axis] < 0.0 { (high, low) } else { (low, high) };
            first = first.max(near * step[axis] + start[axis]);
            last = last.min(far * step[axis] + start[axis]);
        }
        // Less than anything for no child.
        let farthest = node.children().kinds.map(|kind| if kind == Kind::NONE { f32::MIN } else { farthest });
        let exit = (last * ROUNDING).min(Vec4::from_array(farthest));
        Vec4::select(first.cmple(exit), first, Vec4::splat(MISS))
    }

    fn triangle(&self, triangle: &BvhItem) -> Option<(f32, Vec2)> {
        if triangle.index() == NO_HIT {
            return None;
        }
        let [a, b, c] = triangle.corners().map(|corner| self.shear * (corner - self.origin));
        let weights = Vec3::new(side(c, b), side(a, c), side(b, a));
        let sum = weights.x + weights.y + weights.z;
        if (weights.min_element() < 0.0 && weights.max_element() > 0.0) || sum == 0.0 {
            return None;
        }
        let weights = weights / sum;
        let distance = weights.dot(Vec3::new(a.z, b.z, c.z));
        Some((distance, Vec2::new(weights.y, weights.z)))
    }
}

const MISS: f32 = f32::MAX;
/// A factor that covers the rounding of the distances to the sides of a box (Ize 2013).
const ROUNDING: f32 = 1.0 + 1e-6;

/// Returns on which side of the edge from `a` to `b` the ray passes.
fn side(a: Vec3, b: Vec3) -> f32 {
    let swap = a.x > b.x || (a.x == b.x && a.y > b.y);
    let (p, q) = if swap { (b, a) } else { (a, b) };
    let side = p.x * q.y - p.y * q.x;
    if swap { -side } else { side }
}

impl Bvh {
    /// Returns the closest hit with a distance in (`nearest`, `farthest`), in units of the length of
    /// `direction`.
    pub fn intersect(&self, origin: Vec3, direction: Vec3, nearest: f32, farthest: f32) -> Option<Hit> {
        self.search(origin, direction, nearest, farthest, false)
    }

    /// Returns whether anything is hit at a distance in (`nearest`, `farthest`), in units of the length of
    /// `direction`.
    pub fn occluded(&self, origin: Vec3, direction: Vec3, nearest: f32, farthest: f32) -> bool {
        self.search(origin, direction, nearest, farthest, true).is_some()
    }

    fn search(&self, origin: Vec3, direction: Vec3, nearest: f32, farthest: f32, any: bool) -> Option<Hit> {
        let ray = Ray::new(origin, direction);
        let mut closest = farthest;
        let mut hit = None;
        // Children that wait, and where the ray enters their boxes.
        let mut stack = [(MISS, Child::ROOT); STACK];
        let mut height = 0;
        let mut current = Child::ROOT;
        loop {
            let item = &self.items[current.item()];
            let mut next = None;
            if current.is_triangle() {
                if let Some((distance, barycentrics)) = ray.triangle(item)
                    && distance > nearest
                    && distance < closest
                {
                    hit = Some(Hit { distance, triangle: item.index(), barycentrics });
                    closest = distance;
                    if any {
                        return hit;
                    }
                }
                next = current.next();
            } else {
                let enter = ray.enter(item, nearest, closest);
                let children = item.children().each();
                let mut near: [(f32, Child); 4] = std::array::from_fn(|k| (enter[k], children[k]));
                for (a, b) in [(0, 1), (2, 3), (0, 2), (1, 3), (1, 2)] {
                    if near[a].0 > near[b].0 {
                        near.swap(a, b);
                    }
                }
                // The nearest box is next; of the others, the farthest is the last to be popped.
                if near[0].0 < MISS {
                    next = Some(near[0].1);
                    for waiting in near.into_iter().skip(1).rev().filter(|(enter, _)| *enter < MISS) {
                        stack[height] = waiting;
                        height += 1;
                    }
                }
            }
            current = loop {
                if let Some(next) = next {
                    break next;
                }
                if height == 0 {
                    return hit;
                }
                height -= 1;
                // A box beyond a hit that was found since it was pushed is left out.
                let (enter, child) = stack[height];
                next = (enter < closest).then_some(child);
            };
        }
    }
}
