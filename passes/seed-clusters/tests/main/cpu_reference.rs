//! The CPU reference of seed-clusters.wgsl, without the sequence itself.

use interfaces::clusters::{Cluster, ClustersHeader, NO_TEXEL, state};

/// Returns the element of the sequence, modulo 2³², that a cluster takes when it has been seeded `generation` times.
pub(crate) fn element(index: u32, generation: u32, count: u32) -> u32 {
    count.wrapping_mul(generation).wrapping_add(index).wrapping_add(1)
}

/// Returns the cluster with a seed in the unit square; `halton` returns an element of the sequence.
pub(crate) fn seeded_again(
    index: u32,
    generation: u32,
    count: u32,
    halton: impl Fn(u32) -> [f64; 2],
) -> Cluster {
    Cluster {
        uv: halton(element(index, generation, count)).map(|x| x as f32),
        texel: NO_TEXEL,
        generation: generation + 1,
        state: state::SEEDED,
        ..Cluster::default()
    }
}

/// Seeds those of `count` clusters that wait for it; all of them where there is no past of as many clusters.
pub(crate) fn seed(
    past: Option<(ClustersHeader, Vec<Cluster>)>,
    count: u32,
    halton: impl Fn(u32) -> [f64; 2],
) -> (ClustersHeader, Vec<Cluster>) {
    let new = || (ClustersHeader { count, ..Default::default() }, vec![Cluster::default(); count as usize]);
    let (header, mut clusters) = past.filter(|(header, _)| header.count == count).unwrap_or_else(new);
    for (index, cluster) in (0..).zip(&mut clusters) {
        if cluster.state == state::TO_SEED {
            *cluster = seeded_again(index, cluster.generation, count, &halton);
        }
    }
    (header, clusters)
}
