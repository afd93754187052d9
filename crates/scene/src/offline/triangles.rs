//! The triangles of a shape, before they have a material.

use std::collections::BTreeSet;

use glam::{DMat4, DVec3, Vec2, Vec3};

use crate::import::meshes::smooth_normals;

/// Triangles in the space of their shape. Lists that are there have one entry for each vertex; indices are below their number,
/// and three for each triangle.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Triangles {
    pub(super) positions: Vec<Vec3>,
    /// Normals of any length. Without them, each triangle has its own.
    pub(super) normals: Option<Vec<Vec3>>,
    pub(super) uvs: Option<Vec<Vec2>>,
    pub(super) indices: Vec<u32>,
}

impl Triangles {
    /// Turns the other side out.
    pub(super) fn flip(&mut self) {
        self.indices.chunks_exact_mut(3).for_each(|triangle| triangle.swap(1, 2));
        self.normals.iter_mut().flatten().for_each(|normal| *normal = -*normal);
    }

    /// Turns each triangle so that it is counter-clockwise from the side of its normals.
    pub(super) fn follow_normals(&mut self) {
        let Some(normals) = &self.normals else { return };
        for triangle in self.indices.chunks_exact_mut(3) {
            let [a, b, c] = [triangle[0], triangle[1], triangle[2]].map(|i| i as usize);
            let [p, q, r] = [a, b, c].map(|i| self.positions[i]);
            if (q - p).cross(r - p).dot(normals[a] + normals[b] + normals[c]) < 0.0 {
                triangle.swap(1, 2);
            }
        }
    }

    /// Gives vertices without normals the mean of those of their triangles.
    pub(super) fn smooth(&mut self) {
        if self.normals.is_none() {
            self.normals = Some(smooth_normals(&self.positions, &self.indices));
        }
    }

    /// Returns the area once it is transformed.
    pub(super) fn area(&self, transform: &DMat4) -> f64 {
        let corners = |triangle: &[u32]| {
            [0, 1, 2].map(|i| transform.transform_point3(self.positions[triangle[i] as usize].as_dvec3()))
        };
        let triangles = self.indices.chunks_exact(3).map(corners);
        triangles.map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length()).sum()
    }

    /// Returns whether the triangles enclose a volume, and their front is outside.
    pub(super) fn is_closed(&self) -> bool {
        let bits = |index: u32| self.positions[index as usize].to_array().map(|x| (x + 0.0).to_bits());
        let mut edges = BTreeSet::new();
        let mut volume = 0.0;
        for triangle in self.indices.chunks_exact(3) {
            let corners = [0, 1, 2].map(|i| bits(triangle[i]));
            let [a, b, c] = [0, 1, 2].map(|i| self.positions[triangle[i] as usize].as_dvec3());
            volume += a.dot(b.cross(c));
            for (from, to) in [(0, 1), (1, 2), (2, 0)].map(|(i, j)| (corners[i], corners[j])) {
                // An edge that collapses, as at the poles of a sphere, has no other side.
                if from != to && !edges.remove(&(to, from)) && !edges.insert((from, to)) {
                    return false;
                }
            }
        }
        edges.is_empty() && volume > 0.0
    }

    /// Returns the box around the vertices; `None` without any.
    pub(super) fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let places = self.positions.iter().map(|at| at.as_dvec3());
        places.fold(None, |bounds, at| match bounds {
            None => Some((at, at)),
            Some((min, max)) => Some((at.min(min), at.max(max))),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offline::shapes;

    #[test]
    fn a_sphere_is_closed_and_a_disk_is_not() {
        let mut sphere = shapes::sphere(1.0);
        assert!(sphere.is_closed());
        assert!(shapes::cube().is_closed());
        assert!(!shapes::disk().is_closed() && !shapes::rectangle().is_closed());
        sphere.flip();
        assert!(!sphere.is_closed(), "its front is inside");
        sphere.follow_normals();
        assert!(!sphere.is_closed(), "its normals are inside, too");
    }

    #[test]
    fn areas_are_those_of_the_shapes_but_for_their_facets() {
        let of = |triangles: &Triangles| triangles.area(&DMat4::IDENTITY);
        let pi = std::f64::consts::PI;
        assert!((of(&shapes::rectangle()) - 4.0).abs() < 1e-6);
        assert!((of(&shapes::cube()) - 24.0).abs() < 1e-6);
        for (found, expected) in [
            (of(&shapes::sphere(2.0)), 16.0 * pi),
            (of(&shapes::disk()), pi),
            (of(&shapes::cylinder(Vec3::ZERO, Vec3::Y * 3.0, 0.5)), 3.0 * pi),
        ] {
            assert!(found < expected && found > 0.995 * expected, "{found}, not {expected}");
        }
        let wide = DMat4::from_scale(DVec3::new(3.0, 2.0, 1.0));
        assert!((shapes::rectangle().area(&wide) - 24.0).abs() < 1e-6);
    }
}
