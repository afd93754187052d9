//! Clusters to evaluate, and the order in which they are looked at.

use crate::cpu_reference::{Difference, Evaluation};
use interfaces::clusters::{Cluster, ClustersHeader, state};
use pass_test::random::{hash2, shuffled, unit_float};

/// The defaults.
pub(crate) const DEFAULT: Evaluation =
    Evaluation { window: 128, subset: 3, merge: 0.4, split: 0.15, difference: Difference::Absolute };

/// A number in \[0, 1).
pub(crate) fn number(i: u32, salt: u32) -> f32 {
    unit_float(hash2(hash2(i, 51), salt)) as f32
}

/// A cluster with texels.
pub(crate) fn alive(area: f32, importance: f32, uv: [f32; 2]) -> Cluster {
    Cluster { area, importance, uv, texels: 25, state: state::ALIVE, generation: 1, ..Cluster::default() }
}

/// Clusters on a map of 512² in three layers, some of which have no texels.
pub(crate) fn clusters(count: u32, salt: u32) -> Vec<Cluster> {
    let cluster = |i: u32| {
        let of = |what: u32| number(i, 100 * salt + what);
        let uv = [512.0 * of(0), 512.0 * of(1)];
        Cluster {
            position: [of(2), 1.0, 2.0],
            flux: [3.0, of(3), 1.0],
            texel: i,
            layer: (3.0 * of(4)) as u32,
            texels: (200.0 * of(5)) as u32 / 4 * u32::from(of(6) < 0.9),
            generation: 1 + i % 3,
            state: if of(7) < 0.85 { state::ALIVE } else { (4.0 * of(8)) as u32 },
            ..alive(of(9).powi(3), 0.2 + 0.8 * of(10), uv)
        }
    };
    (0..count).map(cluster).collect()
}

/// A header whose members differ.
pub(crate) fn header(count: u32, iteration: u32) -> ClustersHeader {
    ClustersHeader {
        count,
        alive: 7,
        vanished: 6,
        merged: 5,
        split: 4,
        iteration,
        greatest_area: 2.0,
        mean_share: 0.5,
        share_variance: 0.25,
        mapped_flux: [1.0, 2.0, 3.0],
        map_flux: [4.0, 5.0, 6.0],
        ..ClustersHeader::default()
    }
}

/// The cluster that is looked at in a place.
pub(crate) fn order(seed: u32, iteration: u32, count: u32) -> impl Fn(u32) -> u32 {
    move |place| shuffled(place, count, hash2(seed, iteration))
}

/// The numbers by which a cluster is placed.
pub(crate) fn random(seed: u32, iteration: u32) -> impl Fn(u32) -> [f64; 2] {
    move |index| {
        let key = hash2(hash2(seed, iteration), index);
        [unit_float(hash2(key, 0)), unit_float(hash2(key, 1))]
    }
}
