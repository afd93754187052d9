// What a cluster is to its neighbours. [ACRSM §4.8]

#import "clusters.wgsl"

/// The layer of a cluster that takes no part, and is nobody's neighbour.
const NO_LAYER: u32 = 0xffffffffu;

struct Centre {
    /// [texels]
    uv: vec2<f32>,
    layer: u32,
    /// δ of Eq. 4.6 in units of the outcome.
    delta: f32,
}

struct Outcome {
    /// Exponent of the greatest δ: in units of 2 to the power of it, neither squares nor sums leave the range of f32.
    unit: i32,
    merged: u32,
    /// How many were split: not more than were merged.
    split: u32,
}

/// Whether a cluster is evaluated: those without texels have no area, and wait to be seeded.
fn takes_part(cluster: Cluster) -> bool {
    return cluster.state == CLUSTER_ALIVE && cluster.texels > 0u;
}
