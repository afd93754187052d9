//! Traverses the tree: the CPU reference of `shaders/bvh.wgsl`, with the same steps in the same
//! order.

use crate::gpu_data::{BvhNode, BvhTriangle, Child, NO_HIT};
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

    /// Returns where the ray enters each of four boxes, at least `nearest`; `MISS` if it does not before
    /// `farthest`.
    fn enter(&self, node: &BvhNode, nearest: f32, farthest: f32) -> Vec4 {
        let (origin, inverse) = (self.origin, self.inverse);
        let (low_x, high_x) = ((node.low_x - origin.x) * inverse.x, (node.high_x - origin.x) * inverse.x);
        let (low_y, high_y) = ((node.low_y - origin.y) * inverse.y, (node.high_y - origin.y) * inverse.y);
        let (low_z, high_z) = ((node.low_z - origin.z) * inverse.z, (node.high_z - origin.z) * inverse.z);
        let first = low_x.min(high_x).max(low_y.min(high_y)).max(low_z.min(high_z));
        let last = low_x.max(high_x).min(low_y.max(high_y)).min(low_z.max(high_z));
        let enter = first.max(Vec4::splat(nearest));
        let exit = (last * ROUNDING).min(Vec4::splat(farthest));
        Vec4::select(enter.cmple(exit), enter, Vec4::splat(MISS))
    }

    fn triangle(&self, triangle: &BvhTriangle) -> Option<(f32, Vec2)> {
        if triangle.index == NO_HIT {
            return None;
        }
        let a = self.shear * (triangle.a - self.origin);
        let b = self.shear * (triangle.b - self.origin);
        let c = self.shear * (triangle.c - self.origin);
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
        let mut stack = [Child::ROOT; STACK];
        let mut height = 0;
        let mut current = Child::ROOT;
        loop {
            if let Some(run) = current.leaf() {
                for triangle in &self.triangles[run] {
                    if let Some((distance, barycentrics)) = ray.triangle(triangle)
                        && distance > nearest
                        && distance < closest
                    {
                        hit = Some(Hit { distance, triangle: triangle.index, barycentrics });
                        closest = distance;
                        if any {
                            return hit;
                        }
                    }
                }
            } else {
                let node = &self.nodes[current.0 as usize];
                let enter = ray.enter(node, nearest, closest);
                let mut near: [(f32, Child); 4] = std::array::from_fn(|k| (enter[k], node.children[k]));
                for (a, b) in [(0, 1), (2, 3), (0, 2), (1, 3), (1, 2)] {
                    if near[a].0 > near[b].0 {
                        near.swap(a, b);
                    }
                }
                // The nearest box is next; of the others, the farthest is the last to be popped.
                if near[0].0 < MISS {
                    current = near[0].1;
                    for k in [3, 2, 1] {
                        if near[k].0 < MISS {
                            stack[height] = near[k].1;
                            height += 1;
                        }
                    }
                    continue;
                }
            }
            if height == 0 {
                return hit;
            }
            height -= 1;
            current = stack[height];
        }
    }
}
