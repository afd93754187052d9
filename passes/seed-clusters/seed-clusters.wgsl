// Gives each cluster that waits to be seeded the next element of Halton's sequence that no cluster has had. [ACRSM §4.4]

#option PAST false // whether there are clusters of the frame before

#import "clusters.wgsl"
#import "dispatch.wgsl"
#import "random.wgsl"

struct Settings {
    count: u32,
    seed: u32,
}

var<uniform> settings: Settings;
#if PAST
var<storage, read> clusters: Clusters;
#endif
var<storage, read_write> seeded: Clusters;

/// The cluster with a seed in the unit square; all that it was is gone but how often it was seeded.
fn seeded_again(index: u32, generation: u32) -> Cluster {
    var cluster: Cluster;
    // Generation g of all clusters is elements k g + 1 to k g + k: each by itself is as even as the first of them, and
    // no two clusters ever share an element, whenever each is seeded again.
    cluster.uv = halton3(settings.count * generation + index + 1u, settings.seed).xy;
    cluster.texel = NO_TEXEL;
    cluster.generation = generation + 1u;
    cluster.state = CLUSTER_SEEDED;
    return cluster;
}

@compute @workgroup_size(64)
fn seed(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let index = row_index(group, groups, local, 64u);
    if index >= settings.count {
        return;
    }
    var header = ClustersHeader();
    header.count = settings.count;
    var cluster: Cluster;
#if PAST
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
