//! The CPU reference of evaluate-clusters.wgsl in `f64`, which needs no scaling by powers of two.

use interfaces::clusters::{Cluster, ClustersHeader, NO_TEXEL, state};

/// The measure by which a cluster is smaller or greater than its neighbours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Difference {
    /// δ - mean.
    Absolute,
    /// δ / mean - 1.
    Relative,
}

/// The settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Evaluation {
    /// Half the side of the square of neighbours \[px\]; 0 for the whole layer.
    pub(crate) window: u32,
    /// One in `subset` is looked at.
    pub(crate) subset: u32,
    /// Least difference of what is merged.
    pub(crate) merge: f64,
    /// Least difference of what is split.
    pub(crate) split: f64,
    /// The measure of that difference.
    pub(crate) difference: Difference,
}

/// δ of a cluster, and its mean over the neighbours.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Delta {
    /// Eq. 4.6; 0 of a cluster that takes no part.
    pub(crate) own: f64,
    /// Eq. 4.7.
    pub(crate) mean: f64,
}

/// The clusters that are merged and those that are split, both in the order in which they are looked at.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Ranks {
    /// Indices of the free clusters.
    pub(crate) merged: Vec<u32>,
    /// Indices of all that are great enough.
    pub(crate) split: Vec<u32>,
}

/// Returns whether a cluster is evaluated.
pub(crate) fn takes_part(cluster: &Cluster) -> bool {
    cluster.state == state::ALIVE && cluster.texels > 0
}

/// NaN and what is negative count as 0, infinity as the greatest number.
fn weight_of(x: f32) -> f64 {
    if x > 0.0 { f64::from(x.min(f32::MAX)) } else { 0.0 }
}

/// Returns δ of all clusters.
pub(crate) fn measure(clusters: &[Cluster]) -> Vec<f64> {
    let part = clusters.iter().filter(|cluster| takes_part(cluster));
    let greatest = part.map(|cluster| weight_of(cluster.area)).fold(0.0, f64::max);
    let delta = |cluster: &Cluster| weight_of(cluster.area) / greatest * weight_of(cluster.importance);
    clusters.iter().map(|one| if takes_part(one) && greatest > 0.0 { delta(one) } else { 0.0 }).collect()
}

/// Returns the mean of δ over the neighbours of a cluster, weighted by itself.
pub(crate) fn mean_delta(index: usize, clusters: &[Cluster], deltas: &[f64], window: u32) -> f64 {
    let own = &clusters[index];
    let near = |other: &Cluster| {
        let apart = |axis: usize| (other.uv[axis] - own.uv[axis]).abs();
        other.layer == own.layer && (window == 0 || apart(0).max(apart(1)) <= window as f32)
    };
    let neighbours =
        || std::iter::zip(clusters, deltas).filter(|(other, _)| near(other)).map(|(_, delta)| delta);
    let sum: f64 = neighbours().sum();
    if sum > 0.0 { neighbours().map(|delta| delta * (delta / sum)).sum() } else { 0.0 }
}

/// Returns δ and its mean for all clusters.
pub(crate) fn compare(clusters: &[Cluster], window: u32) -> Vec<Delta> {
    let deltas = measure(clusters);
    let of = |index: usize| Delta { own: deltas[index], mean: mean_delta(index, clusters, &deltas, window) };
    (0..clusters.len()).map(of).collect()
}

impl Evaluation {
    /// Returns by how much a cluster is greater than its neighbours; 0 if it takes no part.
    pub(crate) fn difference_of(&self, cluster: &Cluster, delta: Delta) -> f64 {
        let difference = delta.own - delta.mean;
        match self.difference {
            _ if !takes_part(cluster) => 0.0,
            Difference::Absolute => difference,
            Difference::Relative if delta.mean > 0.0 => difference / delta.mean,
            Difference::Relative => 0.0,
        }
    }

    /// Returns what is merged and split; `shuffled` returns the cluster that is looked at in a place.
    pub(crate) fn rank(
        &self,
        clusters: &[Cluster],
        deltas: &[Delta],
        shuffled: impl Fn(u32) -> u32,
    ) -> Ranks {
        let mut ranks = Ranks::default();
        for place in 0..(clusters.len() as u32).div_ceil(self.subset) {
            let index = shuffled(place);
            let difference = self.difference_of(&clusters[index as usize], deltas[index as usize]);
            if difference < -self.merge {
                ranks.merged.push(index);
            } else if difference > self.split {
                ranks.split.push(index);
            }
        }
        ranks
    }

    /// Returns the clusters after a frame's evaluation; `random` returns two numbers in \[0, 1) for a cluster.
    pub(crate) fn evaluate(
        &self,
        header: &ClustersHeader,
        clusters: &[Cluster],
        shuffled: impl Fn(u32) -> u32,
        random: impl Fn(u32) -> [f64; 2],
    ) -> (ClustersHeader, Vec<Cluster>) {
        let deltas = compare(clusters, self.window);
        let ranks = self.rank(clusters, &deltas, shuffled);
        let measured = |(cluster, delta): (&Cluster, &Delta)| match takes_part(cluster) {
            true => Cluster { delta: delta.own as f32, mean_delta: delta.mean as f32, ..*cluster },
            false => *cluster,
        };
        let mut evaluated: Vec<Cluster> = std::iter::zip(clusters, &deltas).map(measured).collect();
        for (rank, free) in ranks.merged.iter().enumerate() {
            let generation = clusters[*free as usize].generation;
            let freed = Cluster { texel: NO_TEXEL, generation, state: state::TO_SEED, ..Cluster::default() };
            evaluated[*free as usize] = match ranks.split.get(rank) {
                Some(taken) => place_in(&clusters[*taken as usize], random(*free), freed),
                None => freed,
            };
        }
        let split = ranks.split.len().min(ranks.merged.len()) as u32;
        (ClustersHeader { merged: ranks.merged.len() as u32, split, ..*header }, evaluated)
    }
}

/// Returns a free cluster at a place within another: uniform in the disc of as many texels as that has.
fn place_in(cluster: &Cluster, random: [f64; 2], freed: Cluster) -> Cluster {
    let distance = (f64::from(cluster.texels) / std::f64::consts::PI * random[0]).sqrt();
    let (sin, cos) = (std::f64::consts::TAU * (random[1] - 0.5)).sin_cos();
    let [u, v] = cluster.uv.map(f64::from);
    Cluster {
        uv: [u + distance * cos, v + distance * sin].map(|at| at as f32),
        layer: cluster.layer,
        state: state::PLACED,
        ..freed
    }
}
