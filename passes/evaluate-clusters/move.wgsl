// Writes the clusters: those that were merged go to clusters that are split, and the rest of them back to be seeded.
// [ACRSM §4.8, §5.3.1]

#import "algorithms/scaled.wgsl"
#import "dispatch.wgsl"
#import "mean.wgsl"
#import "random.wgsl"

struct Settings {
    clusters_count: u32,
    seed: u32,
}

var<uniform> settings: Settings;
var<storage, read> clusters: Clusters;
var<storage, read> fates: array<u32>;
var<storage, read> splits: array<u32>;
var<storage, read> outcome: Outcome;
var<storage, read_write> evaluated: Clusters;

const PI: f32 = 3.14159265;

/// A cluster that was merged, and so far is nowhere.
fn freed(generation: u32) -> Cluster {
    var cluster: Cluster;
    cluster.texel = NO_TEXEL;
    cluster.generation = generation;
    cluster.state = CLUSTER_TO_SEED;
    return cluster;
}

/// A place within a cluster: uniform in the disc of as many texels as it has.
// DEVIATION(disc): the paper's offset is within the radius of the cluster, which is in metres and is that of its farthest
// texel; this one is on the map, and seldom beyond the cluster.
fn place_in(cluster: Cluster, key: u32) -> vec2<f32> {
    let distance = sqrt(f32(cluster.texels) / PI * unit_float(hash2(key, 0u)));
    let angle = 2.0 * PI * (unit_float(hash2(key, 1u)) - 0.5);
    return cluster.uv + distance * vec2(cos(angle), sin(angle));
}

@compute @workgroup_size(64)
fn move_clusters(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let index = row_index(group, groups, local, 64u);
    if index >= settings.clusters_count {
        return;
    }
    var cluster = clusters.clusters[index];
    if takes_part(cluster) {
        cluster.delta = times_power_of_two(centres[index].delta, outcome.unit);
        cluster.mean_delta = times_power_of_two(mean_delta(index), outcome.unit);
    }
    let fate = fates[index];
    if fate > 0u {
        cluster = freed(cluster.generation);
        if fate <= outcome.split {
            let taken = clusters.clusters[splits[fate - 1u]];
            cluster.uv = place_in(taken, hash2(hash2(settings.seed, clusters.header.iteration), index));
            cluster.layer = taken.layer;
            cluster.state = CLUSTER_PLACED;
        }
    }
    evaluated.clusters[index] = cluster;
    if index > 0u {
        return;
    }
    evaluated.header = clusters.header;
    evaluated.header.merged = outcome.merged;
    evaluated.header.split = outcome.split;
}
