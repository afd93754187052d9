//! The CPU reference of average-clusters.wgsl and map-flux.wgsl in `f64`.

use glam::{DVec2, DVec3, Vec3};
use gpu_algorithms::reference::clustering::{Texel, Texels, direction_of};
use interfaces::clusters::{Cluster, state};
use std::f64::consts::PI;

/// The definition of the area of a cluster.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Area {
    /// The sum of the areas of its texels.
    Texels,
    /// That of the circle through its farthest texel.
    Disk,
}

/// A cluster with texels.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Averaged {
    /// Mean position \[m\].
    pub(crate) position: DVec3,
    /// Unit.
    pub(crate) normal: DVec3,
    /// Mean importance.
    pub(crate) importance: f64,
    /// Flux of all texels \[W\].
    pub(crate) flux: DVec3,
    /// \[m²\]
    pub(crate) area: f64,
    /// Distance from the centre to the farthest texel \[m\].
    pub(crate) radius: f64,
    /// Mean place in the layer \[texels\].
    pub(crate) uv: DVec2,
    /// Its texels.
    pub(crate) texels: Vec<usize>,
    /// The one of them that is nearest to `uv`.
    pub(crate) texel: usize,
    /// Flux of that texel.
    pub(crate) centre_flux: DVec3,
}

/// A summary of all clusters.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Summary {
    /// The number of those that have texels.
    pub(crate) alive: u32,
    /// The number of those that have lost theirs.
    pub(crate) vanished: u32,
    /// \[m²\]
    pub(crate) greatest_area: f64,
    /// Mean of area · importance.
    pub(crate) mean_share: f64,
    /// Variance of it.
    pub(crate) share_variance: f64,
    /// Flux of the texels of all clusters \[W\].
    pub(crate) mapped_flux: DVec3,
}

/// Length of the mean of unit normals below which it has no direction.
const LEAST_MEAN: f64 = 1e-3;

/// Returns the cluster `index` with its texels in `map`; `None` where it has none.
pub(crate) fn average(index: u32, old: &Cluster, map: &[u32], rsm: &Texels, area: Area) -> Option<Averaged> {
    if old.state != state::ALIVE {
        return None;
    }
    let own: Vec<(usize, DVec2, &Texel)> = rsm
        .lit()
        .filter(|(i, at, _)| map[*i] == index && at.z == old.layer)
        .map(|(i, at, texel)| (i, at.truncate().as_dvec2() + 0.5, texel))
        .collect();
    let share = 1.0 / own.len() as f64;
    let position = share * own.iter().map(|(_, _, texel)| texel.position).sum::<DVec3>();
    let normal = share * own.iter().map(|(_, _, texel)| texel.normal).sum::<DVec3>();
    let has_direction = normal.length() > LEAST_MEAN;
    let uv = share * own.iter().map(|(_, uv, _)| uv).sum::<DVec2>();
    let nearest = own.iter().min_by(|a, b| a.1.distance(uv).total_cmp(&b.1.distance(uv)))?;
    let radius = own.iter().map(|(_, _, texel)| texel.position.distance(position)).fold(0.0, f64::max);
    Some(Averaged {
        position,
        normal: if has_direction { normal.normalize() } else { direction_of(Vec3::from(old.normal)) },
        importance: share * own.iter().map(|(_, _, texel)| texel.importance).sum::<f64>(),
        flux: own.iter().map(|(_, _, texel)| texel.flux).sum(),
        area: match area {
            Area::Texels => own.iter().map(|(_, _, texel)| texel.area).sum(),
            Area::Disk => PI * radius * radius,
        },
        radius,
        uv,
        texels: own.iter().map(|(i, ..)| *i).collect(),
        texel: nearest.0,
        centre_flux: nearest.2.flux,
    })
}

/// Returns the flux of all texels \[W\].
pub(crate) fn map_flux(rsm: &Texels) -> DVec3 {
    rsm.lit().map(|(_, _, texel)| texel.flux).sum()
}

/// Returns the summary of these clusters, which were those `before`.
pub(crate) fn summarise(before: &[Cluster], averaged: &[Option<Averaged>]) -> Summary {
    let alive: Vec<&Averaged> = averaged.iter().flatten().collect();
    let share_of = |cluster: &Averaged| cluster.area * cluster.importance;
    let count = alive.len().max(1) as f64;
    let mean = alive.iter().map(|cluster| share_of(cluster)).sum::<f64>() / count;
    let lost = before.iter().zip(averaged).filter(|(old, now)| old.state == state::ALIVE && now.is_none());
    Summary {
        alive: alive.len() as u32,
        vanished: lost.count() as u32,
        greatest_area: alive.iter().map(|cluster| cluster.area).fold(0.0, f64::max),
        mean_share: mean,
        share_variance: alive.iter().map(|cluster| (share_of(cluster) - mean).powi(2)).sum::<f64>() / count,
        mapped_flux: alive.iter().map(|cluster| cluster.flux).sum(),
    }
}
