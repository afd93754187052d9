//! The CPU reference of map-clusters.wgsl in `f64`: every texel against every cluster.

use glam::{DVec3, Vec2, Vec3};
use gpu_algorithms::reference::clustering::{Texel, Texels, direction_of, flux_of, weight_of, window_of};
use interfaces::clusters::{Cluster, state};
use std::f64::consts::PI;

/// The measure of the distance of two normals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NormalDistance {
    /// 1 - |cos|.
    Cosine,
    /// The angle in units of half a turn.
    Angle,
}

/// The parameters of the mapping.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Metric {
    /// Diagonal of the scene's bounding box \[m\].
    pub(crate) extent: f64,
    /// Side of the window; 0 for the layer.
    pub(crate) window: u32,
    /// The weights of positions, normals, importance and flux; they sum to 1.
    pub(crate) weights: [f64; 4],
    /// The measure of the distance of two normals.
    pub(crate) normals: NormalDistance,
}

impl Metric {
    /// Returns the distance of a texel from a cluster, which ACRSM calls μ (Eq. 4.4).
    pub(crate) fn distance(&self, cluster: &Cluster, texel: &Texel) -> f64 {
        let position = Vec3::from(cluster.position).as_dvec3().distance(texel.position) / self.extent;
        let normal = normal_distance(direction_of(cluster.normal.into()), texel.normal, self.normals);
        let importance = (weight_of(cluster.importance) - texel.importance).abs();
        let flux = flux_distance(flux_of(cluster.centre_flux.into()), texel.flux);
        let distances = [position, normal, importance, flux];
        std::iter::zip(self.weights, distances).map(|(weight, distance)| weight * distance).sum()
    }

    /// Returns the clusters that may take a texel of the map, with their distances, in the order of their indices.
    pub(crate) fn candidates(&self, clusters: &[Cluster], map: &Texels, index: usize) -> Vec<(u32, f64)> {
        let Some(texel) = &map.texels[index] else { return Vec::new() };
        let place = map.place(index);
        let takes = |cluster: &Cluster| {
            cluster.state == state::ALIVE
                && cluster.layer == place.z
                && Vec3::from(cluster.position).is_finite()
                && window_of(Vec2::from(cluster.uv).as_dvec2(), self.window, map.size).holds(place.truncate())
        };
        let numbered = (0..).zip(clusters).filter(|(_, cluster)| takes(cluster));
        numbered.map(|(i, cluster)| (i, self.distance(cluster, texel))).collect()
    }
}

/// Returns the distance of two normals in \[0, 1\]; 1 where one of them is none.
pub(crate) fn normal_distance(a: DVec3, b: DVec3, normals: NormalDistance) -> f64 {
    if a == DVec3::ZERO || b == DVec3::ZERO {
        return 1.0;
    }
    match normals {
        NormalDistance::Cosine => 1.0 - a.dot(b).abs().min(1.0),
        NormalDistance::Angle => a.cross(b).length().atan2(a.dot(b)) / PI,
    }
}

/// Returns the distance of two fluxes in \[0, 1\]; 0 where both are dark.
pub(crate) fn flux_distance(a: DVec3, b: DVec3) -> f64 {
    let squares = a.length_squared() + b.length_squared();
    if squares == 0.0 { 0.0 } else { (a - b).length_squared() / squares }
}
