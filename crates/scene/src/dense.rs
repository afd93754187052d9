//! The extent of a scene without the empty space around what lies far from all else.

use crate::scene::{Instance, Scene, Vertex};
use glam::{DVec3, Vec3};

/// A slab without geometry does not count if it is this many times as wide as all else together.
const EMPTY: f64 = 100.0;

impl Scene {
    /// Returns [`Scene::extent`] \[m\] without empty space: slabs across an axis that meet no instance do not count where they
    /// are more than a hundred times as wide as what remains. One block that lies far from a room does not make lengths of
    /// the room, which are shares of this, as large as the way to it. Where instances move, all space counts.
    pub fn dense_extent(&self) -> f32 {
        self.dense_extent
    }
}

/// Computes what [`Scene::dense_extent`] returns; `extent` is that of all triangles.
pub(crate) fn dense_extent(vertices: &[Vertex], indices: &[u32], instances: &[Instance], extent: f32) -> f32 {
    if instances.iter().any(|instance| instance.moves) {
        return extent;
    }
    let boxes: Vec<(Vec3, Vec3)> = instances.iter().filter_map(|i| box_of(vertices, indices, i)).collect();
    let mut size = DVec3::ZERO;
    let mut gaps = Vec::new();
    for axis in 0..3 {
        let (width, between) = slabs(boxes.iter().map(|(min, max)| (min[axis], max[axis])).collect());
        size[axis] = width;
        gaps.extend(between.into_iter().map(|gap| (gap, axis)));
    }
    // In rising order, gaps belong to the scene until one is far wider than all else.
    gaps.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    for (gap, axis) in gaps {
        let all_else = size.length();
        if all_else > 0.0 && gap > EMPTY * all_else {
            return all_else as f32;
        }
        size[axis] += gap;
    }
    extent
}

/// Returns the box around the triangles of an instance, if it has any.
fn box_of(vertices: &[Vertex], indices: &[u32], instance: &Instance) -> Option<(Vec3, Vec3)> {
    let first = instance.first_index as usize;
    let places = indices[first..first + instance.index_count as usize]
        .iter()
        .map(|i| Vec3::from(vertices[*i as usize].position));
    places.map(|at| (at, at)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
}

/// Returns the length of an axis that intervals cover, and the widths of the gaps between them.
fn slabs(mut intervals: Vec<(f32, f32)>) -> (f64, Vec<f64>) {
    intervals.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    let (mut covered, mut gaps) = (0.0, Vec::new());
    let mut end: Option<f32> = None;
    for (min, max) in intervals {
        let from = end.unwrap_or(min);
        if min > from {
            gaps.push(f64::from(min) - f64::from(from));
        }
        covered += (f64::from(max) - f64::from(min.max(from))).max(0.0);
        end = Some(max.max(from));
    }
    (covered, gaps)
}
