//! The CPU reference in `f64`, with the names of lookup.wgsl.

use glam::{DVec2, DVec3};
use gpu_algorithms::reference::disc_shadow::{disc_radius, penumbra_radius, search_radius, texel_of};
use gpu_algorithms::reference::paraboloid_lookup::{is_seen, paraboloid_lookup};

/// One map of a light, and how it is looked up.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Map<'a> {
    /// Distances \[m\], row by row.
    pub(crate) distances: &'a [f64],
    /// Side \[px\].
    pub(crate) tile: u32,
    /// Depth bias, in widths of a texel at the receiver.
    pub(crate) depth_bias: f64,
    /// Taps that look for blockers.
    pub(crate) search: usize,
    /// Taps that are filtered.
    pub(crate) taps: usize,
    /// Least height of a blocker above the light's plane, as a share of the receiver's.
    pub(crate) nearest: f64,
}

/// Returns the points of the kernel, as the WGSL has them.
pub(crate) fn poisson_disc() -> Vec<DVec2> {
    let points = include_str!("../../poisson-disc.wgsl").lines().filter_map(|line| {
        let (x, y) = line.trim().strip_prefix("vec2(")?.strip_suffix("),")?.split_once(", ")?;
        Some(DVec2::new(x.parse().ok()?, y.parse().ok()?))
    });
    points.collect()
}

impl Map<'_> {
    /// Returns whether a point of the light's frame is seen through its texel, and what is stored there \[m\].
    fn look_up(&self, at: DVec3, plane_normal: DVec3) -> (bool, f64) {
        let lookup = paraboloid_lookup(at, plane_normal, self.tile, self.depth_bias);
        let texel = texel_of(lookup.position, self.tile);
        let stored = self.distances[(texel.y * self.tile + texel.x) as usize];
        (is_seen(&lookup, texel, self.tile, stored), stored)
    }

    fn look_up_beside(&self, receiver: DVec3, plane_normal: DVec3, beside: DVec3) -> (bool, f64) {
        let (plane_height, along) = (plane_normal.dot(receiver), plane_normal.dot(beside));
        let share = if along * plane_height > 0.0 { (plane_height / along).min(1.0) } else { 1.0 };
        let at = beside * share;
        let (seen, stored) = self.look_up(at, plane_normal);
        (seen, stored * at.z / at.length())
    }

    /// Returns the part of a disc of that area \[m²\] that is seen from a receiver \[m\] with a unit normal, both in the
    /// disc's frame.
    pub(crate) fn visibility(&self, area: f64, receiver: DVec3, plane_normal: DVec3) -> f64 {
        if receiver.z <= 0.0 {
            return 0.0;
        }
        let radius = disc_radius(area);
        if radius == 0.0 {
            return f64::from(u8::from(self.look_up(receiver, plane_normal).0));
        }
        let kernel = poisson_disc();
        let tap = |radius: f64, i: usize| {
            self.look_up_beside(receiver, plane_normal, receiver + (radius * kernel[i]).extend(0.0))
        };
        let reach = search_radius(radius, self.nearest);
        let blockers: Vec<f64> = (0..self.search)
            .map(|i| tap(reach, i))
            .filter_map(|(seen, height)| (!seen).then_some(height))
            .collect();
        if blockers.is_empty() {
            return 1.0;
        }
        let blocker = (blockers.iter().sum::<f64>() / blockers.len() as f64).max(self.nearest * receiver.z);
        let penumbra = penumbra_radius(radius, receiver.z, blocker);
        let seen = (0..self.taps).filter(|i| tap(penumbra, *i).0).count();
        seen as f64 / self.taps as f64
    }
}
