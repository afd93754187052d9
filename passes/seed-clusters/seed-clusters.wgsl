// Gives each cluster that waits to be seeded the next element of its own in Halton's sequence. [ACRSM §4.4]

#input clusters: Clusters optional // The clusters of the frame before. Without them, and where their number is another, all
    // are new.
#output seeded: Clusters(count: settings.count) // The same, none of which waits to be seeded.

#option CLUSTERS false // whether there are clusters of the frame before
#option RESTART false // Whether every frame begins from the same seeds, as if there were no frame before.

#import "clusters.wgsl"
#import "dispatch.wgsl"
#import "random.wgsl"

struct Settings {
    /// Number k of clusters, each of which becomes a virtual area light; ACRSM has 16 to 512. More: light follows the surfaces
    /// more closely, but the time for shadows and gathering rises with k. With another number than before, all clusters are
    /// new. [default: 128, min: 1, max: 65536]
    count: u32,
    seed: u32,
}

var<uniform> settings: Settings;
#if CLUSTERS
var<storage, read> clusters: Clusters;
#endif
var<storage, read_write> seeded: Clusters;

/// Returns a cluster with a seed in the unit square, which keeps nothing but how often it was seeded.
fn seeded_again(index: u32, generation: u32) -> Cluster {
    var cluster: Cluster;
    // Generation g of all clusters is elements k g + 1 to k g + k: each by itself is as uniform as the first of
    // them, and no two clusters ever share an element, whenever each is seeded again.
    cluster.uv = halton3(settings.count * generation + index + 1u, settings.seed).xy;
    cluster.texel = NO_TEXEL;
    cluster.generation = generation + 1u;
    cluster.state = CLUSTER_SEEDED;
    return cluster;
}

@compute @workgroup_size(64)
fn seed(row: Row) {
    let index = index_in(row, 64u);
    if index >= settings.count {
        return;
    }
    var header = ClustersHeader();
    header.count = settings.count;
    var cluster: Cluster;
#if CLUSTERS && !RESTART
    // Clusters of another number have other elements, and a buffer without history has the number 0.
    if clusters.header.count == settings.count {
        header = clusters.header;
        cluster = clusters.clusters[index];
    }
#endif
    if cluster.state == CLUSTER_TO_SEED {
        cluster = seeded_again(index, cluster.generation);
    }
    seeded.clusters[index] = cluster;
    if index == 0u {
        seeded.header = header;
    }
}
